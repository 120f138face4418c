/* Detects a width of rows that is wrong by a few pixels, and a wrong height of slices. */
#ifndef TOSUI_CT2MODEL_READERS_ROW_ENDS_H
#define TOSUI_CT2MODEL_READERS_ROW_ENDS_H

#include <stddef.h>

/* Rows of slices that follow one another in a file. */
struct rows {
  float *pixels;
  double *step;         /* mean difference of each row and the next */
  size_t width, height; /* of a slice, as they are said to be */
  size_t first, count;  /* rows here */
  size_t of_file;       /* rows in all */
};

/* Mean difference of pixels `lag` < n apart, of some thousand spread over all. */
double row_ends_lag(const float *pixels, size_t n, size_t lag);
/* The width of the rows in the file, where it is `more`, a width at which rows are more alike than
 * at that given, or differs from that given by up to four; 0 if nothing contradicts that. In a body
 * that repeats along its rows nothing does. */
size_t row_ends_width(const struct rows *rows, size_t more);
/* The number of rows of a slice, where it is clearly another than that given: of rows that follow
 * one another, those at the ends of slices lie at opposite sides of the body, and slices of that
 * height are more alike. 0 if nothing contradicts that given, as in a body that repeats along y. */
size_t row_ends_height(const struct rows *rows);

#endif
