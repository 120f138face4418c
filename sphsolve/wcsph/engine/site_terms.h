/* Effect of the surrounding sites on the equations of a particle that stays on its site, packed in
 * 20 bytes; and vectors packed in 8 bytes. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_SITE_TERMS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_SITE_TERMS_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "sphsolve/wcsph/engine/particles.h"

struct site_terms {
  double correction[3][3]; /* B, see moment.h; precision 2e-4 */
  double kept;             /* 1 - beta, see wall_subvoxel.h */
  double weight;           /* weight of -v_a in the viscous sum */
};

/* Largest whole number of 18 bits and a sign. */
enum { WORD_MOST = (1 << 18) - 1 };
/* B's entries are at most 1/MOMENT_FLOOR. */
#define CORRECTION_UNIT (1.0 / 3200)

static inline void site_terms_store(struct particles *p, size_t i, const struct site_terms *terms) {
  const double(*b)[3] = terms->correction;
  const double entry[6] = {b[0][0], b[1][1], b[2][2], b[0][1], b[0][2], b[1][2]};
  for (int k = 0; k < 3; k++) {
    const uint32_t pair = (uint32_t)(lrint(entry[2 * k] / CORRECTION_UNIT) & 0xffff) << 16 |
                          (uint32_t)(lrint(entry[2 * k + 1] / CORRECTION_UNIT) & 0xffff);
    memcpy(&p->site_terms[k][i], &pair, sizeof pair);
  }
  p->site_terms[3][i] = (float)terms->kept;
  p->site_terms[4][i] = (float)terms->weight;
}

static inline void site_terms_load(const struct particles *p, size_t i, struct site_terms *terms) {
  double entry[6];
  for (int k = 0; k < 3; k++) {
    uint32_t pair;
    memcpy(&pair, &p->site_terms[k][i], sizeof pair);
    entry[2 * k] = CORRECTION_UNIT * (int16_t)(pair >> 16);
    entry[2 * k + 1] = CORRECTION_UNIT * (int16_t)(pair & 0xffff);
  }
  for (int a = 0; a < 3; a++) terms->correction[a][a] = entry[a];
  terms->correction[0][1] = terms->correction[1][0] = entry[3];
  terms->correction[0][2] = terms->correction[2][0] = entry[4];
  terms->correction[1][2] = terms->correction[2][1] = entry[5];
  terms->kept = (double)p->site_terms[3][i];
  terms->weight = (double)p->site_terms[4][i];
}

/* 2^-n, n from 0 to 1000. */
static inline double power_down(int n) {
  const uint64_t bits = (uint64_t)(1023 - n) << 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return power;
}

/* Packs a vector with a precision of 4e-6 of its largest component, which is limited to `unit`; a
 * vector below 2^-126 of `unit` becomes 0. */
static inline void vector_pack(const double v[3], double unit, uint32_t words[2]) {
  const double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
  int down = 0;
  words[0] = words[1] = 0;
  if (!(most > unit * power_down(126))) return;
  frexp(unit / most, &down); /* unit / most = f 2^down, f from .5 to 1 */
  down = down < 1 ? 0 : down - 1;
  const double scale = WORD_MOST / (unit * power_down(down));
  uint64_t bits = (uint64_t)down << 57;
  for (int a = 0; a < 3; a++) {
    const double q = fmax(-WORD_MOST, fmin(v[a] * scale, WORD_MOST));
    bits |= (uint64_t)(lrint(q) + 262144) << (19 * a);
  }
  words[0] = (uint32_t)bits, words[1] = (uint32_t)(bits >> 32);
}
static inline void vector_unpack(const uint32_t words[2], double unit, double v[3]) {
  const uint64_t bits = (uint64_t)words[1] << 32 | words[0];
  const double scale = unit * power_down((int)(bits >> 57)) / WORD_MOST;
  for (int a = 0; a < 3; a++)
    v[a] = bits == 0 ? 0.0 : ((int)(bits >> (19 * a) & 524287u) - 262144) * scale;
}

#endif
