/* The paragraph of methods with its references, each sentence from what the runs and their model
 * say of themselves. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_METHODS_H
#define TOSUI_ANALYZE_REPORT_PAGE_METHODS_H

#include <stdio.h>

#include "analyze/analysis.h"
#include "analyze/report/page_model.h"

/* What the page holds that the paragraph may speak of. */
struct methods_facts {
  bool permeable;    /* a k is given */
  bool fitted;       /* from several gradients */
  bool averaged;     /* from a record in time */
  bool extrapolated; /* over runs at several spacings */
  bool index;        /* its resolution error is a grid convergence index, */
  bool lattices;     /* or from those that the run itself has solved */
};

/* HTML: the paragraph, and the list of the references it has used. */
enum status page_methods(const struct subject *subject, const struct page_model *model,
                         const struct methods_facts *facts, FILE *stream);

#endif
