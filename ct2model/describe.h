/* ct2model info: what stacks and models hold, from their headers. */
#ifndef TOSUI_CT2MODEL_DESCRIBE_H
#define TOSUI_CT2MODEL_DESCRIBE_H

#include "common/error.h"
#include "common/options.h"
#include "ct2model/request.h"

enum status describe_files(const struct options *options, const struct request *request);

#endif
