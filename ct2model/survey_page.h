/* The page of `ct2model survey`: what a person looks at before a model is made, as in Fiji. */
#ifndef TOSUI_CT2MODEL_SURVEY_PAGE_H
#define TOSUI_CT2MODEL_SURVEY_PAGE_H

#include "common/error.h"
#include "common/options.h"
#include "ct2model/state.h"

/* Writes the page of a finished pipeline to the request's output. Its JSON is that of --json and
 * what survey_page.c adds. */
enum status survey_page_write(const struct pipeline *pipeline, const struct options *options);

#endif
