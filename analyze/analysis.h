/* An analysis is a command of `analyze`, a section of the report, or both. It is described by one
 * struct in its own file; analyses.def lists them. */
#ifndef TOSUI_ANALYZE_ANALYSIS_H
#define TOSUI_ANALYZE_ANALYSIS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"
#include "analyze/run_file.h"
#include "common/options.h"

/* What is analysed. For a command only the runs, or the files of a solute, are set; the report also
 * sets the members below. */
struct subject {
  const struct run *runs;
  size_t n;
  const char *const *solutes; /* files of runs of method solute */
  size_t solute_count;
  /* Number of runs, at the beginning, with a permeability (0 included) that does not drift. */
  size_t permeable;
  size_t flowing; /* number of them with a permeability above 0 */
  bool snapshots; /* every run has a snapshot */
};

#define ANALYSIS_OPTIONS 4

struct analysis {
  const char *name; /* of its command, its files, its section and its member of the page's JSON */

  /* The command; without a `name` there is none. */
  struct option_command command;
  struct option_entry options[ANALYSIS_OPTIONS]; /* its own options; `commands` is not used */
  bool of_solutes;                               /* its operands are files of a solute, not runs */
  bool several_models; /* its runs may be of several models, one for each spacing */
  /* Name of another analysis whose command also outputs this one, if it applies. */
  const char *delivered_with;

  /* The section of the page; without a heading there is none. */
  /* Plain text; `contents` is the entry in the list of sections, NULL: the heading. */
  const char *heading, *contents, *caption;
  /* Runs in the section: all, those with a permeability, those with a permeability above 0, or, if
   * none has a permeability, the first. */
  enum { OF_ALL, OF_PERMEABLE, OF_FLOWING, OF_FIRST } page_runs;
  bool may_fail; /* on failure the page gives a warning and omits the section */

  /* Decides by the contents of the subject whether the analysis applies, without running it. NULL:
   * always. */
  enum status (*applies)(const struct subject *subject, bool *applies);
  /* Computes JSON, CSV, plot and summary. `options` is NULL for the page. */
  enum status (*analyze)(const struct subject *subject, const struct options *options,
                         struct product *product);
  /* Whether the section says anything; NULL: always. */
  bool (*shown)(const struct subject *subject, const json_t *json);
};

#define ANALYSIS(name) extern const struct analysis name##_analysis;
#include "analyze/analyses.def"
#undef ANALYSIS

enum {
#define ANALYSIS(name) ANALYSIS_##name,
#include "analyze/analyses.def"
#undef ANALYSIS
  ANALYSES
};
extern const struct analysis *const analyses[ANALYSES];

/* The result of its `applies`. */
enum status analysis_applies(const struct analysis *analysis, const struct subject *subject,
                             bool *applies);

#endif
