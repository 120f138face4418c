/* One table of options per program: parsing, --help and the manual page (--man) come from it. */
#ifndef TOSUI_COMMON_OPTIONS_H
#define TOSUI_COMMON_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "common/units.h"

struct option_entry {
  const char *name;    /* long name without dashes */
  char letter;         /* 0: none */
  const char *metavar; /* NULL: a flag; "[...]": whole numbers or LABEL=..., may be left out ("") */
  unsigned commands;   /* bit i: the i-th subcommand takes it; OPTION_ALL */
  const char *help;    /* one line */
};
#define OPTION_ALL 0xffffffffu

struct option_command {
  const char *name;               /* "build" */
  const char *synopsis;           /* "SLICES... --void-ratio E [options] -o model.hdf" */
  const char *summary;            /* one line */
  const char *example;            /* works when pasted; may hold several lines */
  int operands_min, operands_max; /* of free arguments; max -1: any */
};

struct option_table {
  const char *program, *summary;
  const struct option_command *commands; /* ends with name == NULL */
  const struct option_entry *entries;    /* ends with name == NULL; the common ones are added */
};
/* Common to all programs: --threads N --max-memory SIZE --force --json --quiet --verbose --help
 * --version --man */

struct options; /* the parsed command line */

/* Parses argv. On --help, --version or --man prints to stdout and sets *done. Applies --quiet,
 * --verbose, --threads, --max-memory and --force itself. Free with options_free. */
enum status options_parse(const struct option_table *table, int argc, char **argv,
                          struct options **options, bool *done);
void options_free(struct options *options);

/* The subcommand, the free arguments in their order, and whether an option was given, by its long
 * name. Texts are owned by `options`. */
const char *options_command(const struct options *options);
size_t options_operand_count(const struct options *options);
const char *options_operand(const struct options *options, size_t i);

bool options_given(const struct options *options, const char *name);
/* The last value given, or NULL. */
const char *options_text(const struct options *options, const char *name);
/* All values of an option that may be repeated; NULL beyond the last. */
const char *options_text_nth(const struct options *options, const char *name, size_t n);
/* These leave *value alone when the option is not given. Errors are usage errors naming it. */
enum status options_quantity(const struct options *options, const char *name,
                             struct dimension dimension, double *value);
enum status options_number(const struct options *options, const char *name, double *value);
enum status options_integers(const struct options *options, const char *name, char separator,
                             int count, long long *values);
/* One of `choices` (NULL-terminated): its index into *choice. */
enum status options_choice(const struct options *options, const char *name,
                           const char *const *choices, int *choice);
bool options_json(const struct options *options);
/* The command line as one string, for provenance. Owned by `options`. */
const char *options_command_line(const struct options *options);

/* The name in `names` (NULL-terminated) nearest to `word` by edit distance, NULL if none is near.
 */
const char *nearest_name(const char *word, const char *const *names);

#endif
