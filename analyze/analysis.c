#include "analyze/analysis.h"

#define ANALYSIS(name) &name##_analysis,
const struct analysis *const analyses[ANALYSES] = {
#include "analyze/analyses.def"
};
#undef ANALYSIS

enum status analysis_applies(const struct analysis *analysis, const struct subject *subject,
                             bool *applies) {
  *applies = true;
  return analysis->applies != NULL ? analysis->applies(subject, applies) : STATUS_OK;
}
