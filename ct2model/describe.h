/* ct2model info: the contents of stacks and models, from their headers. */
#ifndef TOSUI_CT2MODEL_DESCRIBE_H
#define TOSUI_CT2MODEL_DESCRIBE_H

#include "common/error.h"
#include "common/options.h"
#include "ct2model/request.h"

/* Prints the contents of each operand of the command line, as text or JSON. Pixels are not read. */
enum status describe_files(const struct options *options, const struct request *request);

#endif
