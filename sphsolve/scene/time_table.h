/* What a scene gives as a table of time: linear between its times, constant before and after. */
#ifndef TOSUI_SPHSOLVE_SCENE_TIME_TABLE_H
#define TOSUI_SPHSOLVE_SCENE_TIME_TABLE_H

#include <stddef.h>

struct time_table {
  size_t count;       /* 0: no table */
  double *time;       /* s, rising */
  double (*value)[3]; /* one number, or a vector */
};

/* The value at a time (s); `component` 0 where the values are single numbers. */
double time_table_at(const struct time_table *table, double time, int component);
/* Integral from a time to a later one: exact. */
double time_table_integral(const struct time_table *table, double from, double to, int component);
/* The value of largest size. */
double time_table_extreme(const struct time_table *table, int component);

#endif
