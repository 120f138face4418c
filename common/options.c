#include "common/options.h"

#include <ctype.h>
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/output_guard.h"
#include "common/provenance.h"
#include "common/threads.h"

#define ENTRY_MAX 64
#define VALUE_MAX 512

struct given {
  const struct option_entry *entry;
  const char *value;
};

struct options {
  const struct option_table *table;
  struct option_entry entries[ENTRY_MAX]; /* those of the program, then the common ones */
  size_t entry_count;
  const struct option_command *command;
  struct given given[VALUE_MAX];
  size_t given_count;
  char **operands;
  size_t operand_count;
  char *command_line;
};

static const struct option_entry common_entries[] = {
    {"threads", 't', "N", OPTION_ALL,
     "threads to use (default: as many cores as the work keeps busy)"},
    {"max-memory", 0, "SIZE", OPTION_ALL, "refuse to use more, e.g. 8GB"},
    {"force", 0, NULL, OPTION_ALL, "replace a file that is no product of Tosui's (an input never)"},
    {"json", 0, NULL, OPTION_ALL, "one JSON object on stdout, nothing else there"},
    {"quiet", 'q', NULL, OPTION_ALL, "errors only"},
    {"verbose", 'v', NULL, OPTION_ALL, "more detail"},
    {"help", 'h', NULL, OPTION_ALL, "this text"},
    {"version", 0, NULL, OPTION_ALL, "version"},
    {"man", 0, NULL, OPTION_ALL, "manual page in troff"},
};

static bool takes(const struct options *options, const struct option_entry *entry) {
  if (options->command == NULL) return true;
  long i = options->command - options->table->commands;
  return (entry->commands >> i & 1u) != 0;
}

static void print_entries(const struct options *options) {
  for (size_t i = 0; i < options->entry_count; i++) {
    const struct option_entry *e = &options->entries[i];
    if (!takes(options, e) || !strcmp(e->name, "man")) continue;
    char left[80], letter[8] = "    ";
    if (e->letter) snprintf(letter, sizeof letter, "-%c, ", e->letter);
    snprintf(left, sizeof left, "%s--%s%s%s", letter, e->name, e->metavar ? " " : "",
             e->metavar ? e->metavar : "");
    printf(strlen(left) > 34 ? "  %s\n  %-34s %s\n" : "  %-34s%s %s\n", left, "", e->help);
  }
}

static void print_help(const struct options *options) {
  const struct option_table *table = options->table;
  if (options->command != NULL) {
    const struct option_command *c = options->command;
    printf("%s %s: %s\n\nUsage: %s %s %s\n\nOptions:\n", table->program, c->name, c->summary,
           table->program, c->name, c->synopsis);
    print_entries(options);
    printf("\nExample:\n  %s\n", c->example);
    return;
  }
  printf("%s: %s\n\nUsage: %s COMMAND ...\n\nCommands:\n", table->program, table->summary,
         table->program);
  for (const struct option_command *c = table->commands; c->name; c++)
    printf("  %-10s %s\n", c->name, c->summary);
  printf("\n'%s COMMAND --help' shows its options and an example.\n", table->program);
}

static void print_man(const struct options *options) {
  const struct option_table *table = options->table;
  printf(".TH %s 1 \"\" \"Tosui %s\" \"Tosui\"\n.SH NAME\n%s \\- %s\n.SH SYNOPSIS\n",
         table->program, TOSUI_VERSION, table->program, table->summary);
  for (const struct option_command *c = table->commands; c->name; c++)
    printf(".B %s %s\n%s\n.br\n", table->program, c->name, c->synopsis);
  printf(".SH COMMANDS\n");
  for (const struct option_command *c = table->commands; c->name; c++)
    printf(".TP\n.B %s\n%s\n", c->name, c->summary);
  printf(".SH OPTIONS\n");
  for (size_t i = 0; i < options->entry_count; i++) {
    const struct option_entry *e = &options->entries[i];
    printf(".TP\n.B ");
    if (e->letter) printf("\\-%c, ", e->letter);
    printf("\\-\\-%s%s%s\n%s", e->name, e->metavar ? " " : "", e->metavar ? e->metavar : "",
           e->help);
    if (e->commands != OPTION_ALL) {
      const char *separator = " (";
      for (size_t c = 0; table->commands[c].name; c++)
        if (e->commands >> c & 1u) {
          printf("%s%s", separator, table->commands[c].name);
          separator = ", ";
        }
      printf(")");
    }
    printf("\n");
  }
  printf(".SH EXAMPLES\n.nf\n");
  for (const struct option_command *c = table->commands; c->name; c++) printf("%s\n", c->example);
  printf(".fi\n.SH \"EXIT STATUS\"\n0 ok; 1 run failed; 2 wrong usage; 3 bad input; 4 numerical "
         "failure; 130 sphsolve run was interrupted by SIGINT or SIGTERM, and goes on with "
         "\\-\\-resume\n");
}

static size_t edit_distance(const char *a, const char *b) {
  size_t n = strlen(a), m = strlen(b), row[64];
  if (n > 60 || m > 60) return 100;
  for (size_t j = 0; j <= m; j++) row[j] = j;
  for (size_t i = 1; i <= n; i++) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= m; j++) {
      size_t best =
          diagonal + (tolower((unsigned char)a[i - 1]) != tolower((unsigned char)b[j - 1]));
      diagonal = row[j];
      if (row[j] + 1 < best) best = row[j] + 1;
      if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
      row[j] = best;
    }
  }
  return row[m];
}

const char *nearest_name(const char *word, const char *const *names) {
  const char *best = NULL;
  size_t least = strlen(word) / 3 + 1;
  for (; *names; names++) {
    size_t distance = edit_distance(word, *names);
    /* A word that is the beginning of the other counts as near ("visc" for "viscosity"). */
    size_t n = strlen(word);
    if (n >= 3 && !strncmp(word, *names, n)) distance = 1;
    if (distance <= least && (best == NULL || distance < least)) {
      best = *names;
      least = distance;
    }
  }
  return best;
}

static enum status refuse_command(const struct option_table *table, const char *word) {
  const char *names[32];
  size_t n = 0;
  char list[256] = "";
  for (const struct option_command *c = table->commands; c->name && n < 31; c++) {
    size_t used = strlen(list);
    snprintf(list + used, sizeof list - used, "%s%s", n ? ", " : "", c->name);
    names[n++] = c->name;
  }
  names[n] = NULL;
  if (word == NULL)
    return FAIL(STATUS_USAGE, "a command is missing; first comes one of %s (see %s --help)", list,
                table->program);
  const char *near = nearest_name(word, names);
  return FAIL(STATUS_USAGE, "unknown command '%s'%s%s%s; there are %s", word,
              near ? ", did you mean '" : "", near ? near : "", near ? "'" : "", list);
}

static enum status refuse_option(const struct options *options, const char *word) {
  const char *names[ENTRY_MAX + 1];
  size_t n = 0;
  char name[64];
  snprintf(name, sizeof name, "%s", word + strspn(word, "-"));
  name[strcspn(name, "=")] = '\0';
  for (size_t i = 0; i < options->entry_count; i++)
    if (takes(options, &options->entries[i])) names[n++] = options->entries[i].name;
  names[n] = NULL;
  for (size_t i = 0; i < options->entry_count && options->command != NULL; i++)
    for (const struct option_command *c = options->table->commands; c->name; c++)
      if (strcmp(options->entries[i].name, name) == 0 &&
          options->entries[i].commands >> (c - options->table->commands) & 1u)
        return FAIL(STATUS_USAGE, "--%s is an option of %s, not of %s (see %s %s --help)", name,
                    c->name, options->command->name, options->table->program,
                    options->command->name);
  const char *near = nearest_name(name, names);
  return FAIL(STATUS_USAGE, "unknown option '%s'%s%s%s (see %s%s%s --help)", word,
              near ? ", did you mean '--" : "", near ? near : "", near ? "'?" : "",
              options->table->program, options->command ? " " : "",
              options->command ? options->command->name : "");
}

static enum status join_command_line(struct options *options, int argc, char **argv) {
  size_t length = 1;
  for (int i = 0; i < argc; i++) length += strlen(argv[i]) + 3;
  enum status status = memory_allocate(&options->command_line, length, 1, "the command line");
  if (status != STATUS_OK) return status;
  char *end = options->command_line;
  for (int i = 0; i < argc; i++) {
    const char *word = argv[i];
    if (i == 0 && strrchr(word, '/')) word = strrchr(word, '/') + 1;
    const char *quote = word[strcspn(word, " \t'\"$*")] ? "'" : "";
    end += sprintf(end, "%s%s%s%s", i ? " " : "", quote, word, quote);
  }
  return STATUS_OK;
}

static enum status apply_common(const struct options *options) {
  enum status status = STATUS_OK;
  enum log_level level = options_given(options, "quiet")     ? LOG_QUIET
                         : options_given(options, "verbose") ? LOG_VERBOSE
                                                             : LOG_NORMAL;
  log_start(options->table->program, level);
  output_start(options_given(options, "force"));
  double threads = 0;
  TRY(options_number(options, "threads", &threads));
  if (options_given(options, "threads") &&
      !(threads >= 1 && threads <= 4096 && threads == floor(threads)))
    TRY_FAIL(STATUS_USAGE, "--threads %s: a whole number from 1 to 4096 is wanted",
             options_text(options, "threads"));
  if (threads >= 1) threads_use((int)threads);
  TRY(threads_check());
  const char *size = options_text(options, "max-memory");
  if (size != NULL) {
    char *unit;
    double bytes = strtod(size, &unit);
    while (*unit == ' ') unit++;
    if (!strcasecmp(unit, "GB") || !strcasecmp(unit, "G"))
      bytes *= 1e9;
    else if (!strcasecmp(unit, "MB") || !strcasecmp(unit, "M"))
      bytes *= 1e6;
    else if (!strcasecmp(unit, "GiB"))
      bytes *= 1073741824.0;
    else if (!strcasecmp(unit, "MiB"))
      bytes *= 1048576.0;
    else
      bytes = -1;
    if (!(bytes > 0 && bytes < 1e18))
      TRY_FAIL(STATUS_USAGE,
               "--max-memory %s: a size in MB, GB, MiB or GiB is wanted, like 8GB or 500MB", size);
    memory_set_limit((size_t)bytes);
  }
cleanup:
  return status;
}

/* "0", "255" or "0=pore,1=grain" */
static bool is_optional_value(const char *word) {
  const size_t digits = strspn(word, "0123456789");
  return digits > 0 && (word[digits] == '\0' || word[digits] == '=');
}

/* Lists the program's options and the common ones, also in the form that getopt_long takes. */
static enum status list_entries(struct options *options, struct option longs[ENTRY_MAX + 1],
                                char shorts[2 * ENTRY_MAX + 3]) {
  const size_t common = sizeof common_entries / sizeof *common_entries;
  size_t own = 0, used = strlen(shorts);
  while (options->table->entries[own].name != NULL) own++;
  if (own + common > ENTRY_MAX)
    return FAIL(STATUS_RUN, "%s has over %zu options: enlarge ENTRY_MAX", options->table->program,
                ENTRY_MAX - common);
  options->entry_count = own + common;
  for (size_t i = 0; i < options->entry_count; i++) {
    const struct option_entry *e = &options->entries[i];
    options->entries[i] = i < own ? options->table->entries[i] : common_entries[i - own];
    const int argument = e->metavar == NULL     ? no_argument
                         : e->metavar[0] == '[' ? optional_argument
                                                : required_argument;
    longs[i] = (struct option){e->name, argument, NULL, 256 + (int)i};
    if (e->letter) used += (size_t)sprintf(shorts + used, "%c%s", e->letter, e->metavar ? ":" : "");
  }
  return STATUS_OK;
}

/* Whether two options set the same value. An option PATH=VALUE may be repeated for different
 * paths. */
static bool sets_same_value(const struct given *a, const struct given *b) {
  const char *metavar = a->entry->metavar;
  if (a->entry != b->entry || metavar == NULL) return false;
  if (metavar[0] == '[' || strchr(metavar, '=') == NULL) return true;
  return strncmp(a->value, b->value, strcspn(a->value, "=") + 1) == 0;
}

/* If an option is repeated its last value is used, and a warning says so. */
static void warn_of_repeats(const struct options *options) {
  const struct given *given = options->given;
  for (size_t i = 0; i < options->given_count; i++) {
    size_t before = 0, last = i;
    bool other = false;
    while (before < i && !sets_same_value(&given[before], &given[i])) before++;
    if (before < i) continue; /* already reported */
    for (size_t j = i + 1; j < options->given_count; j++)
      if (sets_same_value(&given[i], &given[j])) {
        other |= strcmp(given[i].value, given[j].value) != 0;
        last = j;
      }
    if (other)
      log_warning("--%s is given more than once: %s counts, the last, not %s", given[i].entry->name,
                  given[last].value, given[i].value);
  }
}

static enum status check_operands(const struct options *options) {
  const struct option_command *command = options->command;
  const char *program = options->table->program;
  const size_t n = options->operand_count;
  if (n < (size_t)command->operands_min) // NOLINT: the command is known here
    return FAIL(STATUS_USAGE, "%s: too few arguments; usage: %s %s %s", command->name, program,
                command->name, command->synopsis);
  if (command->operands_max >= 0 && n > (size_t)command->operands_max)
    return FAIL(STATUS_USAGE, "%s: '%s' is one argument too many; usage: %s %s %s", command->name,
                options->operands[command->operands_max], program, command->name,
                command->synopsis);
  return STATUS_OK;
}

enum status options_parse(const struct option_table *table, int argc, char **argv,
                          struct options **result, bool *done) {
  enum status status = STATUS_OK;
  struct options *options;
  struct option longs[ENTRY_MAX + 1] = {{0}};
  char shorts[2 * ENTRY_MAX + 3] = ":";
  *result = NULL;
  *done = false;
  log_start(table->program, LOG_NORMAL);
  TRY(memory_allocate(&options, 1, sizeof *options, "options"));
  *result = options;
  options->table = table;
  TRY(list_entries(options, longs, shorts));
  TRY(join_command_line(options, argc, argv));

  /* The subcommand is the first word that is not an option. */
  int first = 1;
  if (argc > 1 && argv[1][0] != '-') {
    for (const struct option_command *c = table->commands; c->name; c++)
      if (!strcmp(c->name, argv[1])) options->command = c;
    if (options->command == NULL) TRY(refuse_command(table, argv[1]));
    first = 2;
  }
  optind = 0; /* GNU extension: restart the scan */
  opterr = 0;
  int count = argc - first + 1;
  char **words = argv + first - 1;
  int c;
  while ((c = getopt_long(count, words, shorts, longs, NULL)) != -1) {
    const char *word = words[optind - 1];
    if (c == ':')
      TRY_FAIL(STATUS_USAGE, "option '%s' needs a value (see %s%s%s --help)", word, table->program,
               options->command ? " " : "", options->command ? options->command->name : "");
    if (c == '?') {
      char letter[3] = {'-', (char)optopt, 0};
      TRY(refuse_option(options, optopt > 0 && optopt < 256 ? letter : word));
    }
    const struct option_entry *entry = NULL;
    if (c >= 256)
      entry = &options->entries[c - 256];
    else
      for (size_t i = 0; i < options->entry_count; i++)
        if (options->entries[i].letter == c) entry = &options->entries[i];
    if (entry == NULL || !takes(options, entry))
      TRY(refuse_option(options, entry != NULL ? entry->name : word));
    if (options->given_count == VALUE_MAX)
      TRY_FAIL(STATUS_USAGE, "more than %d options", VALUE_MAX);
    /* An optional value may also follow as a separate word, if that cannot be a file name. */
    // NOLINTNEXTLINE: no entry is refused above
    if (entry->metavar != NULL && entry->metavar[0] == '[' && optarg == NULL)
      optarg = optind < count && is_optional_value(words[optind]) ? words[optind++] : "";
    if (strcmp(entry->name, "output") == 0 && optarg != NULL && strcmp(optarg, "-") == 0)
      TRY_FAIL(STATUS_USAGE, "-o -: files are written, not standard output; give a name");
    options->given[options->given_count++] = (struct given){entry, optarg};
  }
  options->operands = words + optind;
  options->operand_count = (size_t)(count - optind);

  if (options_given(options, "help"))
    print_help(options);
  else if (options_given(options, "version"))
    printf("%s %s\n", table->program, TOSUI_VERSION);
  else if (options_given(options, "man"))
    print_man(options);
  *done = options_given(options, "help") || options_given(options, "version") ||
          options_given(options, "man");
  if (*done) return STATUS_OK;
  if (options->command == NULL) {
    if (argc < 2) print_help(options);
    TRY(refuse_command(table, NULL));
  }
  TRY(apply_common(options));
  warn_of_repeats(options);
  TRY(check_operands(options));
cleanup:
  return status;
}

void options_free(struct options *options) {
  if (options == NULL) return;
  MEMORY_FREE(&options->command_line, &options);
}

const char *options_command(const struct options *options) {
  return options->command->name;
}
size_t options_operand_count(const struct options *options) {
  return options->operand_count;
}
const char *options_operand(const struct options *options, size_t i) {
  return i < options->operand_count ? options->operands[i] : NULL;
}
const char *options_command_line(const struct options *options) {
  return options->command_line;
}
bool options_json(const struct options *options) {
  return options_given(options, "json");
}

bool options_given(const struct options *options, const char *name) {
  for (size_t i = 0; i < options->given_count; i++)
    if (!strcmp(options->given[i].entry->name, name)) return true;
  return false;
}

const char *options_text(const struct options *options, const char *name) {
  for (size_t i = options->given_count; i-- > 0;)
    if (!strcmp(options->given[i].entry->name, name)) return options->given[i].value;
  return NULL;
}

const char *options_text_nth(const struct options *options, const char *name, size_t n) {
  for (size_t i = 0; i < options->given_count; i++)
    if (!strcmp(options->given[i].entry->name, name) && n-- == 0) return options->given[i].value;
  return NULL;
}

enum status options_quantity(const struct options *options, const char *name,
                             struct dimension dimension, double *value) {
  const char *text = options_text(options, name);
  if (text == NULL) return STATUS_OK;
  if (quantity_parse(text, dimension, value) == STATUS_OK) return STATUS_OK;
  return error_context(STATUS_USAGE, "--%s", name);
}

enum status options_number(const struct options *options, const char *name, double *value) {
  return options_quantity(options, name, DIM_NONE, value);
}

enum status options_integers(const struct options *options, const char *name, char separator,
                             int count, long long *values) {
  const char *text = options_text(options, name), *at = text;
  if (text == NULL) return STATUS_OK;
  for (int i = 0; i < count; i++) {
    char *end;
    errno = 0;
    values[i] = strtoll(at, &end, 10);
    bool last = i + 1 == count;
    if (end == at || errno != 0 || (last ? *end != '\0' : *end != separator))
      return count == 1 ? FAIL(STATUS_USAGE, "--%s %s: a whole number is wanted", name, text)
                        : FAIL(STATUS_USAGE, "--%s %s: %d whole numbers parted by '%c' are wanted",
                               name, text, count, separator);
    at = end + 1;
  }
  return STATUS_OK;
}

enum status options_choice(const struct options *options, const char *name,
                           const char *const *choices, int *choice) {
  const char *text = options_text(options, name);
  if (text == NULL) return STATUS_OK;
  char list[256] = "";
  for (int i = 0; choices[i]; i++) {
    if (!strcmp(text, choices[i])) {
      *choice = i;
      return STATUS_OK;
    }
    size_t used = strlen(list);
    snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", choices[i]);
  }
  return FAIL(STATUS_USAGE, "--%s %s: one of %s is wanted", name, text, list);
}
