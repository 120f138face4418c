#include "sphsolve/wcsph/modes.h"

#include <math.h>
#include <string.h>

#include "common/kernel.h"
#include "sphsolve/wcsph/constants.h"

/* Largest eigenvalue of a symmetric 3 x 3 matrix (Smith 1961). */
static double largest_eigenvalue(double m[3][3]) {
  double off = m[0][1] * m[0][1] + m[0][2] * m[0][2] + m[1][2] * m[1][2];
  double mean = (m[0][0] + m[1][1] + m[2][2]) / 3, square = 2 * off;
  for (int a = 0; a < 3; a++) square += (m[a][a] - mean) * (m[a][a] - mean);
  double p = sqrt(square / 6);
  if (!(p > 0)) return mean;
  double b[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) b[i][j] = (m[i][j] - (i == j ? mean : 0)) / p;
  double det = b[0][0] * (b[1][1] * b[2][2] - b[1][2] * b[2][1]) -
               b[0][1] * (b[1][0] * b[2][2] - b[1][2] * b[2][0]) +
               b[0][2] * (b[1][0] * b[2][1] - b[1][1] * b[2][0]);
  double r = fmax(-1, fmin(1, det / 2));
  return mean + 2 * p * cos(acos(r) / 3);
}

struct lattice_modes lattice_modes_find(enum kernel kernel, int dimensions, const double spacing[3],
                                        double h) {
  const double support = kernel_support_ratio(kernel) * h, small = 1e-4 * h;
  struct lattice_modes modes = {0};
  double weights = 0;
  double moment = 0;
  int neighbours = 0;
  double volume = 1;
  int reach[3];
  for (int a = 0; a < 3; a++) {
    bool flat = dimensions == 2 && a == 1;
    reach[a] = flat ? 0 : (int)(support / spacing[a]);
    volume *= flat ? 1 : spacing[a];
  }
  for (int w = 0; w < MODE_WAVES * MODE_WAVES * MODE_WAVES; w++) {
    int index[3] = {w % MODE_WAVES, w / MODE_WAVES % MODE_WAVES, w / (MODE_WAVES * MODE_WAVES)};
    if (dimensions == 2 && index[1] > 0) continue;
    double gradient[3] = {0}, laplacian = 0, stiffness[3][3] = {{0}}, sum = 0;
    for (int k = -reach[2]; k <= reach[2]; k++)
      for (int j = -reach[1]; j <= reach[1]; j++)
        for (int i = -reach[0]; i <= reach[0]; i++) {
          double r[3] = {i * spacing[0], j * spacing[1], k * spacing[2]};
          double length = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
          sum += volume * kernel_w(kernel, dimensions, length, h);
          if (length == 0 || length >= support) continue;
          double phase =
              M_PI * (i * index[0] + j * index[1] + k * index[2]) / (double)(MODE_WAVES - 1);
          double slope = kernel_dw(kernel, dimensions, length, h);
          double curve = (kernel_dw(kernel, dimensions, length + small, h) -
                          kernel_dw(kernel, dimensions, length - small, h)) /
                         (2 * small);
          moment -= w == 0 ? volume * slope * length / dimensions : 0;
          double still = 1 - cos(phase);
          neighbours += w == 0;
          weights += w == 0 ? 2 * volume * (-slope / length) : 0;
          laplacian += 2 * volume * (-slope / length) * still;
          for (int a = 0; a < 3; a++) {
            gradient[a] += volume * slope * r[a] / length * sin(phase);
            for (int b = 0; b < 3; b++)
              stiffness[a][b] += 2 * volume * still *
                                 ((a == b ? slope / length : 0) +
                                  (curve - slope / length) * r[a] * r[b] / (length * length));
          }
        }
    modes.shifting_stiffness = fmax(modes.shifting_stiffness, 0.5 * largest_eigenvalue(stiffness));
    double square = 0;
    for (int a = 0; a < 3; a++) {
      square += gradient[a] * gradient[a];
      for (int b = 0; b < 3; b++) stiffness[a][b] -= gradient[a] * gradient[b];
    }
    modes.sum = sum;
    modes.gradient = fmax(modes.gradient, sqrt(square));
    modes.laplacian = fmax(modes.laplacian, laplacian);
    const double absolute = sqrt(fmax(0, largest_eigenvalue(stiffness)));
    modes.absolute = fmax(modes.absolute, absolute);
    modes.wave[modes.count][0] = sqrt(square);
    modes.wave[modes.count][1] = absolute;
    modes.wave[modes.count++][2] = laplacian;
  }
  modes.neighbours = neighbours;
  modes.moment = moment;
  modes.weights = weights;
  return modes;
}

double lattice_modes_dt(const struct lattice_modes *modes, bool absolute, double c, double nu,
                        double diffusion) {
  double low = 0, high = INFINITY;
  for (int w = 0; w < modes->count; w++) {
    const double sound = 0.5 * c * modes->wave[w][absolute], viscous = 0.5 * nu * modes->wave[w][2];
    if (viscous > 0) high = fmin(high, 1 / viscous);
    /* Stable steps without diffusion; `high` is the limit of viscosity alone. */
    const double root = viscous + sqrt(viscous * viscous + 4 * sound * sound);
    if (root > 0) low = low > 0 ? fmin(low, 2 / root) : 2 / root;
  }
  if (!(diffusion > 0)) return low > 0 ? low : INFINITY;
  for (high = fmin(high, 8 * low); high > MODES_ROUNDING * low;) {
    const double dt = sqrt(low * high), q = 1 / (1 + dt * diffusion * modes->weights);
    bool stable = true;
    for (int w = 0; w < modes->count && stable; w++) {
      const double s = dt * c * modes->wave[w][absolute], l = modes->wave[w][2];
      stable = q * s * s < (2 - dt * nu * l) * (2 - q * dt * diffusion * l);
    }
    if (stable)
      low = dt;
    else
      high = dt;
  }
  return low;
}
