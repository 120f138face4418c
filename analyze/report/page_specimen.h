/* Section of the report on the specimen: the model file that a run names, if it is found. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_SPECIMEN_H
#define TOSUI_ANALYZE_REPORT_PAGE_SPECIMEN_H

#include <jansson.h>
#include <stdio.h>

#include "analyze/report/page_model.h"
#include "analyze/run_file.h"
#include "common/model_file.h"

/* Writes pictures and a table of the run's model, and sets *calibration for the page's curve (a new
 * object, or NULL if the file has no calibration). If there is no model, or its file is not found,
 * a sentence says so without a failure. */
enum status page_specimen(const struct run *run, const struct page_model *facts,
                          const struct voxel_model *model, FILE *stream, json_t **calibration);

/* Commands of gnuplot for the calibration: void ratio against threshold, and the grey histogram. */
void page_calibration_plot(const json_t *calibration, FILE *plot);

#endif
