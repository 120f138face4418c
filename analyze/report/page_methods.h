/* The paragraph on methods with its references, written from the properties of the runs and their
 * model. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_METHODS_H
#define TOSUI_ANALYZE_REPORT_PAGE_METHODS_H

#include <jansson.h>
#include <stdbool.h>

#include "analyze/analysis.h"
#include "analyze/report/page_model.h"

/* Results on the page to which the paragraph may refer. */
struct methods_facts {
  bool permeable;    /* a k is given */
  bool fitted;       /* k is fitted to several gradients */
  bool averaged;     /* k is the mean of a record in time */
  bool extrapolated; /* k is extrapolated over runs at several spacings */
  bool index;        /* its resolution error is a grid convergence index */
  bool lattices;     /* or is estimated from the lattices of a single run */
};

/* {"text": the paragraph, in which [n] cites the n-th of "references"}; a new object. */
enum status page_methods(const struct subject *subject, const struct page_model *model,
                         const struct methods_facts *facts, json_t **methods);

#endif
