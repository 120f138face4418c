/* For readers: the files with the pixels that a header names beside it. A header may name only
 * files in its own folder and below. */
#ifndef TOSUI_CT2MODEL_READERS_IMAGE_DATA_H
#define TOSUI_CT2MODEL_READERS_IMAGE_DATA_H

#include <stdio.h>

#include "ct2model/readers/image.h"

/* Line `line` of the header names the file `name` with pixels; it is added to data_files. */
enum status image_data_beside(struct image *image, const char *name, int line);
/* Line `line` of the header is "FORMAT MIN MAX STEP", as "slice%03d.raw 1 20 1": adds a file for
 * each number. */
enum status image_data_pattern(struct image *image, const char *text, int line);
/* The rest of the header after line `line` lists names, one a line: adds them. */
enum status image_data_list(struct image *image, FILE *header, int line);

/* Reads a line of a header into line[size], without its end. *number counts the lines, *more is
 * false at the end of the file. A line that does not fit is refused. */
enum status image_header_line(const char *path, FILE *header, char *line, size_t size, int *number,
                              bool *more);

#endif
