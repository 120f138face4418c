/* Standard error of the blur that is fitted to the surfaces of all windows, which may overlap. */
#ifndef TOSUI_CT2MODEL_SCANNER_FEW_SURFACES_H
#define TOSUI_CT2MODEL_SCANNER_FEW_SURFACES_H

struct windows;

/* Relative standard error of the blur. The surfaces of `windows` are already found; `reach`: range
 * of the edge fit, in voxels. */
double few_surfaces_error(const struct windows *windows, double reach);

#endif
