/* How uncertain the blur is that few surfaces tell: where the windows overlap, as in a small scan
 * or crop, their own blurs scatter by less than chance does. */
#ifndef TOSUI_CT2MODEL_SCANNER_FEW_SURFACES_H
#define TOSUI_CT2MODEL_SCANNER_FEW_SURFACES_H

struct windows;

/* Standard deviation of the blur over the blur itself; 0 where there are windows enough that do not
 * overlap. `windows` with their surfaces found, and the reach of the response. */
double few_surfaces_error(const struct windows *windows, double reach);

#endif
