/* Quantities with units, as users write them: "5.83um", "1e-3 Pa s", "9.8 m/s^2", "10 min".
 * Everything is SI inside. A bare number is accepted only for a dimensionless quantity, and "0"
 * for any. */
#ifndef TOSUI_COMMON_UNITS_H
#define TOSUI_COMMON_UNITS_H

#include <stddef.h>

#include "common/error.h"

/* Exponents of metre, kilogram, second. */
struct dimension {
  int m, kg, s;
};

#define DIM_NONE ((struct dimension){0, 0, 0})
#define DIM_LENGTH ((struct dimension){1, 0, 0})
#define DIM_TIME ((struct dimension){0, 0, 1})
#define DIM_VELOCITY ((struct dimension){1, 0, -1})
#define DIM_ACCELERATION ((struct dimension){1, 0, -2})
#define DIM_DENSITY ((struct dimension){-3, 1, 0})
#define DIM_VISCOSITY ((struct dimension){-1, 1, -1})
#define DIM_PRESSURE ((struct dimension){-1, 1, -2})
#define DIM_PRESSURE_GRADIENT ((struct dimension){-2, 1, -2})
#define DIM_FREQUENCY ((struct dimension){0, 0, -1})

#define GRAVITY_STANDARD 9.80665 /* m/s^2, ISO 80000-3 */
#define DARCY 9.869233e-13       /* m^2 */

/* Parses `text` as a quantity of dimension `expected` into *value (SI). On failure the message says
 * what is wrong and gives a correct example, without naming a file. */
enum status quantity_parse(const char *text, struct dimension expected, double *value);

/* A dimension as a unit, such as "m/s^2"; and an example for users, such as "9.8 m/s^2". */
void dimension_format(struct dimension dimension, char *text, size_t size);
const char *dimension_example(struct dimension dimension);

/* A length or time with a readable prefix ("46.6 um", "2.5e-05 s" as "25 us"). */
void quantity_format(double value, const char *base_unit, char *text, size_t size);

/* "under 1 s", "5 s", "12 min", "3.4 h"; "unknown" for a value that is not finite. */
void duration_format(double seconds, char *text, size_t size);

/* A share in percent with two digits: 0.0123 as "1.2", 1.57 as "157". */
const char *percent_format(double share, char text[32]);

#endif
