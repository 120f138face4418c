/* A function of time given as a table: linear between its times, constant before and after. */
#ifndef TOSUI_SPHSOLVE_SCENE_TIME_TABLE_H
#define TOSUI_SPHSOLVE_SCENE_TIME_TABLE_H

#include <stddef.h>

struct time_table {
  size_t count;       /* 0: no table */
  double *time;       /* s, rising */
  double (*value)[3]; /* one number, or a vector */
};

/* Value at a time (s); `component` is 0 for scalars. */
double time_table_at(const struct time_table *table, double time, int component);
/* Exact integral from one time to a later one. */
double time_table_integral(const struct time_table *table, double from, double to, int component);
/* The value of largest magnitude. */
double time_table_extreme(const struct time_table *table, int component);

#endif
