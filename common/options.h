/* One table of options per program, from which parsing, --help and the manual page (--man) are
 * derived. */
#ifndef TOSUI_COMMON_OPTIONS_H
#define TOSUI_COMMON_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "common/units.h"

struct option_entry {
  const char *name; /* long name without dashes */
  char letter;      /* 0: none */
  /* NULL: a flag; "[...]": optional value, integers or LABEL=..., "" if omitted. */
  const char *metavar;
  unsigned commands; /* bit i: option of the i-th subcommand; OPTION_ALL: of all */
  const char *help;  /* one line */
};
#define OPTION_ALL 0xffffffffu

struct option_command {
  const char *name;               /* "build" */
  const char *synopsis;           /* "SLICES... --void-ratio E [options] -o model.hdf" */
  const char *summary;            /* one line */
  const char *example;            /* works when pasted; may hold several lines */
  int operands_min, operands_max; /* number of positional arguments; max -1: unlimited */
};

struct option_table {
  const char *program, *summary;
  const struct option_command *commands; /* ends with name == NULL */
  const struct option_entry *entries;    /* ends with name == NULL; the common options are added */
};
/* Common to all programs: --threads N --max-memory SIZE --force --json --quiet --verbose --help
 * --version --man */

struct options; /* the parsed command line */

/* Parses argv. On --help, --version or --man prints to stdout and sets *done. Applies --quiet,
 * --verbose, --threads, --max-memory and --force itself. Free with options_free. */
enum status options_parse(const struct option_table *table, int argc, char **argv,
                          struct options **options, bool *done);
void options_free(struct options *options);

/* The subcommand, the positional arguments in their order, and whether an option with the given
 * long name is present. The strings are owned by `options`. */
const char *options_command(const struct options *options);
size_t options_operand_count(const struct options *options);
const char *options_operand(const struct options *options, size_t i);

bool options_given(const struct options *options, const char *name);
/* The last value given, or NULL. */
const char *options_text(const struct options *options, const char *name);
/* The n-th value of an option that may be repeated; NULL after the last. */
const char *options_text_nth(const struct options *options, const char *name, size_t n);
/* These leave *value unchanged if the option is not given. An invalid value is a usage error that
 * names the option. */
enum status options_quantity(const struct options *options, const char *name,
                             struct dimension dimension, double *value);
enum status options_number(const struct options *options, const char *name, double *value);
enum status options_integers(const struct options *options, const char *name, char separator,
                             int count, long long *values);
/* One of `choices` (NULL-terminated); *choice is its index. */
enum status options_choice(const struct options *options, const char *name,
                           const char *const *choices, int *choice);
bool options_json(const struct options *options);
/* The command line as one string, for provenance. Owned by `options`. */
const char *options_command_line(const struct options *options);

/* The name in `names` (NULL-terminated) nearest to `word` by edit distance; NULL if none is
 * near. */
const char *nearest_name(const char *word, const char *const *names);

#endif
