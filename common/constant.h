/* Numbers of a method or a program that no equation gives, each a line of its constants.def:
 *
 *   CONSTANT(NAME, value, unit, origin, sentence)      a double
 *   WHOLE(NAME, value, unit, origin, sentence)         an integer
 *
 * `unit` is "" for a plain number. `origin` begins with one of
 *   derived   from mathematics or from another number here
 *   cited     and the source
 *   fitted    on what; and judged on what, if that is known
 *   measured  on what: costs, bytes and times, which change no result
 *   chosen    a free choice: a tolerance, a bound, a number of iterations
 *   unknown   it shapes results, and its origin is not written down
 *
 * The constants.h beside it makes the names known to the code, and the table goes into the run file
 * as /run/constants. */
#ifndef TOSUI_COMMON_CONSTANT_H
#define TOSUI_COMMON_CONSTANT_H

#include "common/error.h"
#include "common/hdf5_file.h"

struct constant {
  const char *name;
  double value;
  const char *unit, *origin, *text;
};

/* A line as a value for the code, and as a row of the table of a file that includes the .def. */
#define CONSTANT_VALUE(name, value, unit, origin, text)                                            \
  static const double name __attribute__((unused)) = value;
#define CONSTANT_WHOLE(name, value, unit, origin, text) enum { name = value };
#define CONSTANT_ROW(name, value, unit, origin, text) {#name, value, unit, origin, text},

/* Writes tables, each ended by a row without a name or NULL for none, to /run/constants. */
enum status constants_write(struct h5_file *file, size_t tables,
                            const struct constant *const *table);

#endif
