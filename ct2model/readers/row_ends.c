#include "ct2model/readers/row_ends.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "ct2model/readers/constants.h"

/* Widths that are compared: that given, up to ASIDE less or more, and one further width. */
enum { ASIDE = 4, GIVEN = ASIDE, MORE = 2 * ASIDE + 1, WIDTHS, ENDS_LEAST = 3 };

double row_ends_lag(const float *pixels, size_t n, size_t lag) {
  enum { SAMPLES = 4096 };
  double sum = 0.0;
  for (size_t k = 0; k < SAMPLES; k++) {
    const size_t i = (size_t)(k * UINT64_C(2654435761) % (n - lag));
    sum += fabs((double)pixels[i + lag] - (double)pixels[i]);
  }
  return sum / SAMPLES;
}

/* If the width is wrong by a few pixels, each row is shifted against the previous one and the image
 * is sheared, which real layers may be, too. But the last pixel of a row and the first one of the
 * next row lie on opposite sides of the body. With the correct width these pairs differ more than
 * neighbours do; with a wrong one they are neighbours. A width is significant if its row ends
 * differ by five standard errors; for the given width by three. */
size_t row_ends_width(const struct rows *rows, size_t more) {
  const size_t n = rows->width * rows->count;
  double mean[WIDTHS] = {0.0}, deviation[WIDTHS] = {0.0}, below[WIDTHS] = {0.0}, usual = 0.0;
  size_t width[WIDTHS], best = 0;
  if (rows->width <= 2 * ASIDE || rows->count <= 2 * ASIDE) return 0;
  for (size_t i = 0; i + 1 < n; i++)
    usual += fabs((double)rows->pixels[i + 1] - (double)rows->pixels[i]) / (double)(n - 1);
  for (size_t k = 0; k < WIDTHS; k++) {
    double ends = 0.0, square = 0.0;
    const size_t w = width[k] = k < MORE ? rows->width - ASIDE + k : more > 0 ? more : rows->width;
    for (size_t i = w - 1 - rows->first * rows->width % w; i + 1 < n; i += w, ends++) {
      const double step = fabs((double)rows->pixels[i + 1] - (double)rows->pixels[i]);
      mean[k] += step;
      square += step * step;
    }
    mean[k] /= ends;
    deviation[k] = sqrt(fmax(0.0, square / ends - mean[k] * mean[k]) / ends);
    for (size_t i = 0; k < MORE && i + rows->width + ASIDE < n; i++)
      below[k] += fabs((double)rows->pixels[i + w] - (double)rows->pixels[i]);
  }
  const double given = mean[GIVEN] - 3.0 * deviation[GIVEN];
  double most = 1.2 * usual;
  if (more > 0) return given > fmax(usual, mean[MORE]) ? 0 : more;
  if (!(given < usual)) return 0;
  for (size_t k = 0; k < MORE; k++) {
    if (k == GIVEN || !(mean[k] > most) || !(mean[k] - 5.0 * deviation[k] > usual) ||
        !(below[k] < below[GIVEN]))
      continue;
    most = mean[k];
    best = width[k];
  }
  return best;
}

/* What ends of slices of `height` rows explain of the variance of the steps from row to row, and
 * whether they are clearly larger than others; steps at every skip-th row are left out, 0: none. */
static double explain_steps(const struct rows *rows, size_t height, size_t skip, bool *clearly) {
  double count = 0.0, sum = 0.0, square = 0.0, ends = 0.0, at_ends = 0.0;
  for (size_t y = 0; y + 1 < rows->count; y++) {
    const size_t next = rows->first + y + 1;
    if (skip > 0 && next % skip == 0) continue;
    count++;
    sum += rows->step[y];
    square += rows->step[y] * rows->step[y];
    if (next % height != 0) continue;
    ends++;
    at_ends += rows->step[y];
  }
  const double mean = sum / count, other = (sum - at_ends) / (count - ends);
  *clearly = false;
  if (ends < 1.0 || !(at_ends > ends * mean)) return 0.0;
  const double explained = pow(at_ends - ends * mean, 2.0) * count / (ends * (count - ends));
  const double error = sqrt((square - count * mean * mean - explained) / count / ends);
  *clearly = ends >= ENDS_LEAST && at_ends > ends * ROW_STEP_LEAST * other &&
             at_ends / ends - other > ROW_STEP_ERRORS * error;
  return explained;
}

/* Of rows that follow one another those at the ends of slices are far apart. Where the height given
 * is right others explain less, and are not clear without its own ends. */
size_t row_ends_height(const struct rows *rows) {
  const size_t width = rows->width, given = rows->height, n = width * rows->count;
  bool clearly;
  size_t best = 0;
  if (rows->count < 2 * given) return 0;
  double most = explain_steps(rows, given, 0, &clearly);
  for (size_t h = 2; 2 * h <= rows->count; h++) {
    if (rows->of_file % h != 0 || h == given) continue;
    const double explained = explain_steps(rows, h, 0, &clearly);
    if (!(explained > most)) continue;
    most = explained;
    if (h % given != 0) (void)explain_steps(rows, h, given, &clearly);
    clearly &= row_ends_lag(rows->pixels, n, width * h) <
               SLICES_RATIO * row_ends_lag(rows->pixels, n, width * given);
    best = clearly ? h : 0;
  }
  return best;
}
