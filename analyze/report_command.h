/* The report as a command: described here, as an analysis is (analysis.h), and defined in report/.
 */
#ifndef TOSUI_ANALYZE_REPORT_COMMAND_H
#define TOSUI_ANALYZE_REPORT_COMMAND_H

#include <jansson.h>
#include <stddef.h>

#include "analyze/run_file.h"
#include "common/options.h"

struct report_command {
  struct option_command command;
  /* Writes the page of n runs to the file that --output names. */
  enum status (*write)(const struct options *options, const struct run *runs, size_t n);
  /* Prints the assessment of k and the advice of the page's head, from the JSON of analysis darcy.
   */
  void (*print_verdict)(const struct run *runs, size_t n, const json_t *darcy);
};
extern const struct report_command report_command;

#endif
