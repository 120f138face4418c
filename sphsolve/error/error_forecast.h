/* Expected error of k from the geometry alone, before anything is solved. */
#ifndef TOSUI_SPHSOLVE_ERROR_ERROR_FORECAST_H
#define TOSUI_SPHSOLVE_ERROR_ERROR_FORECAST_H

#include "sphsolve/plan/plan.h"

/* Sets plan->shape, and the expected parts of the error by the scan and by the threshold. */
enum status error_expect(struct plan *plan);
/* The sum of these two parts, which no lattice reduces. */
double error_expected_rest(const struct plan *plan);

/* Forecast for the spacing divided by `refined`. */
struct error_forecast error_forecast_of(const struct pore_shape *shape, const struct method *method,
                                        enum wall_scheme wall, double refined);

#endif
