/* Standard error of a blur that is fitted to few surfaces. Where windows overlap, as in a small
 * scan or crop, the scatter of their own fits underestimates it. */
#ifndef TOSUI_CT2MODEL_SCANNER_FEW_SURFACES_H
#define TOSUI_CT2MODEL_SCANNER_FEW_SURFACES_H

struct windows;

/* Relative standard error of the blur; 0 where there are enough windows that do not overlap. The
 * surfaces of `windows` are already found; `reach`: range of the edge fit, in voxels. */
double few_surfaces_error(const struct windows *windows, double reach);

#endif
