/* Smoothing kernels W(r, h) in 1, 2 and 3 dimensions, in double precision; the vector loops have
 * their own forms and are tested against these.
 *   quintic (Schoenberg 1946; Morris, Fox, Zhu 1997), support 3h, s = r/h:
 *     W = alpha [ (3-s)^5 - 6 (2-s)^5 + 15 (1-s)^5 ],  each term only while positive
 *     alpha = 1/(120 h), 7/(478 pi h^2), 1/(120 pi h^3)
 *   cubic (Monaghan, Lattanzio 1985), support 2h:
 *     W = alpha [ (2-s)^3 - 4 (1-s)^3 ] / 4,  alpha = 2/(3 h), 10/(7 pi h^2), 1/(pi h^3)
 *   wendland (Wendland 1995, C2; Dehnen, Aly 2012), support 2h, 2 and 3 dimensions:
 *     W = alpha (1 - s/2)^4 (1 + 2 s),  alpha = 7/(4 pi h^2), 21/(16 pi h^3) */
#ifndef TOSUI_COMMON_KERNEL_H
#define TOSUI_COMMON_KERNEL_H

enum kernel { KERNEL_QUINTIC, KERNEL_CUBIC, KERNEL_WENDLAND, KERNELS };

/* "quintic", ...; ends with NULL. */
extern const char *const kernel_names[KERNELS + 1];
/* The kernel in words, such as "quintic spline"; the name itself if it is unknown. */
const char *kernel_in_words(const char *name);
/* Support radius over smoothing length: 3 or 2. */
double kernel_support_ratio(enum kernel kernel);
/* W(r, h), in m^-dimensions for r and h in m. */
double kernel_w(enum kernel kernel, int dimensions, double r, double h);
/* dW/dr, never positive. */
double kernel_dw(enum kernel kernel, int dimensions, double r, double h);

#endif
