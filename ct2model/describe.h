/* ct2model info: what stacks and models hold, from their headers. */
#ifndef TOSUI_CT2MODEL_DESCRIBE_H
#define TOSUI_CT2MODEL_DESCRIBE_H

#include "common/error.h"
#include "common/options.h"
#include "ct2model/request.h"

/* Prints what each operand of the command line holds, as text or JSON. Pixels are not read. */
enum status describe_files(const struct options *options, const struct request *request);

#endif
