/* Names of slices: their order and their numbers. */
#ifndef TOSUI_CT2MODEL_READERS_SLICE_NAMES_H
#define TOSUI_CT2MODEL_READERS_SLICE_NAMES_H

#include <stdbool.h>
#include <stddef.h>

/* How the numbers of a list of names are read: whole ones without a sign unless the names show that
 * "z-7" is below zero ("z6" stands beside it), or that "z0.25" is a fraction. */
struct name_order {
  bool is_signed, fractions;
  size_t digits; /* most digits of a fraction */
};

/* The order that the names ask for. */
struct name_order name_order_find(char *const *names, size_t count);
/* Compares names, numbers by value ("slice_9" before "slice_10"); returns a value like strcmp. */
int name_compare(const char *a, const char *b, const struct name_order *order);
/* Compares names whose numbers are whole and have no sign. */
int natural_compare(const char *a, const char *b);
/* The last number of a name, in units of the last digit of fractions; false if there is none, or a
 * too long one. */
bool name_number(const char *path, const struct name_order *order, long long *number);
/* The name without its folders. */
const char *base_name(const char *path);

#endif
