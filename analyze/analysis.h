/* An analysis: a command of `analyze`, a section of the report, or both, told by one descriptor in
 * its own file. analyses.def lists them. */
#ifndef TOSUI_ANALYZE_ANALYSIS_H
#define TOSUI_ANALYZE_ANALYSIS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"
#include "analyze/run_file.h"
#include "common/options.h"

/* What is analysed, and what is known of it before. A command fills in the runs or the files of a
 * solute alone; what stands below them is known where the report asks. */
struct subject {
  const struct run *runs;
  size_t n;
  const char *const *solutes; /* files that hold what a solute did */
  size_t solute_count;
  size_t permeable; /* the first so many have a permeability, which no longer drifts; no other */
  size_t flowing;   /* the first so many one above 0; the water of the permeable others rests */
  bool snapshots; /* every run has a snapshot */
  bool maps;      /* the report shows maps of speed and pressure in a plane */
};

/* How a section stands on the page: not at all, behind a fold at the end, or open. */
enum showing { SHOW_NOT, SHOW_FOLDED, SHOW_OPEN };

#define ANALYSIS_OPTIONS 4

struct analysis {
  const char *name; /* of its command, its files, its section and its member of the page's data */

  /* The command. `name` NULL: none of its own. */
  struct option_command command;
  struct option_entry options[ANALYSIS_OPTIONS]; /* those it takes alone; `commands` is not read */
  bool of_solutes;                               /* its operands are files of a solute, not runs */
  bool several_models; /* its runs may be of several models, one for each spacing */
  /* Another whose command delivers this one as well, where it applies. */
  const char *delivered_with;

  /* The section of the page; no heading: none. */
  const char *heading, *contents, *caption; /* HTML; `contents` stands in the list of sections */
  /* Which of its runs: all, those that have a k, those whose water flows, or, where none has a k,
   * the first. */
  enum { OF_ALL, OF_PERMEABLE, OF_FLOWING, OF_FIRST } page_runs;
  bool charts;   /* page.js draws its data, the plot stands in for them */
  bool may_fail; /* the page warns and goes without */

  /* Decided by what the subject holds, not by trying. NULL: to every run. */
  enum status (*applies)(const struct subject *subject, bool *applies);
  /* From the subject to JSON, CSV, plot and summary. `options` NULL: as the page shows it. */
  enum status (*analyze)(const struct subject *subject, const struct options *options,
                         struct product *product);
  /* NULL: open. */
  enum showing (*showing)(const struct subject *subject, const json_t *json);
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

/* What its `applies` says. */
enum status analysis_applies(const struct analysis *analysis, const struct subject *subject,
                             bool *applies);

#endif
