#include "analyze/analysis.h"

#define ANALYSIS(name) &name##_analysis,
const struct analysis *const analyses[ANALYSES] = {
#include "analyze/analyses.def"
};
#undef ANALYSIS
