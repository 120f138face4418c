/* Grains told apart at their contacts, and a scan without its blur and noise: the wedge between two
 * balls that touch keeps its pore, and a small grain stays. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "common/memory.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/gaussian.h"
#include "ct2model/scanner/grains.h"

enum { NX = 64, NY = 40, NZ = 40, N = NX * NY * NZ, FINER = 4 };
static const size_t SIZE[3] = {NX, NY, NZ};
static const double CUBES[3] = {1.0, 1.0, 1.0};
#define MIDDLE 32.3
#define RADIUS 13.0

static double ball(const double at[3], double x, double longer) {
  return hypot((at[0] - x) / longer, hypot(at[1] - 20.2, at[2] - 19.9)) - RADIUS;
}

static double touching(const double at[3]) {
  return fmin(ball(at, MIDDLE - RADIUS, 1.0), ball(at, MIDDLE + RADIUS, 1.0));
}

static double long_grain(const double at[3]) {
  return ball(at, MIDDLE, 2.0);
}

/* Of each voxel the part of FINER^3 points at which the distance, which changes by at most 1 a
 * voxel, is below 0: all of them or none where half a voxel's diagonal does not reach the wall. */
static void draw(double (*distance)(const double at[3]), float *share) {
  const double reach = 0.5 * sqrt(3.0);
  for (size_t i = 0; i < N; i++) {
    const double corner[3] = {(double)(i % NX), (double)(i / NX % NY), (double)(i / NX / NY)};
    const double there =
        distance((const double[3]){corner[0] + 0.5, corner[1] + 0.5, corner[2] + 0.5});
    int inside = 0;
    for (int k = 0; k < FINER * FINER * FINER && fabs(there) < reach; k++) {
      const double at[3] = {corner[0] + ((double)(k % FINER) + 0.5) / FINER,
                            corner[1] + ((double)(k / FINER % FINER) + 0.5) / FINER,
                            corner[2] + ((double)(k / FINER / FINER) + 0.5) / FINER};
      inside += distance(at) < 0.0;
    }
    share[i] = there <= -reach ? 1.0F : (float)inside / (FINER * FINER * FINER);
  }
}

static float *floats(void) {
  float *out = NULL;
  assert_int_equal(memory_allocate(&out, N, sizeof *out, "test"), STATUS_OK);
  return out;
}

static void test_grains(void **state) {
  (void)state;
  float *share = floats();
  uint8_t *contacts = NULL;
  size_t next = 0, last = 0;
  assert_int_equal(memory_allocate(&contacts, N, 1, "test"), STATUS_OK);
  draw(touching, share);
  assert_int_equal(grains_find(share, SIZE, CUBES, contacts), STATUS_OK);
  for (size_t i = 0; i < N; i++) {
    if (!contacts[i]) continue;
    assert_true(fabs((double)(i % NX) + 0.5 - MIDDLE) < 1.6);
    next += (contacts[i] & GRAINS_NEXT(0)) != 0;
    last += (contacts[i] & GRAINS_LAST(0)) != 0;
  }
  assert_true(next > 50);
  assert_int_equal(next, last);
  draw(long_grain, share); /* twice as long as wide, and one */
  assert_int_equal(grains_find(share, SIZE, CUBES, contacts), STATUS_OK);
  for (size_t i = 0; i < N; i++) assert_int_equal(contacts[i], 0);
  memset(share, 0, N * sizeof *share); /* no grain at all */
  assert_int_equal(grains_find(share, SIZE, CUBES, contacts), STATUS_OK);
  for (size_t i = 0; i < N; i++) assert_int_equal(contacts[i], 0);
  memory_free(&share);
  memory_free(&contacts);
}

/* Balls of 4 to 8 voxels at random in a cube of SIDE, many of them touching. */
enum { SIDE = 40, CUBE = SIDE * SIDE * SIDE, BALLS = 40 };

static void draw_pack(float *share) {
  uint32_t seed = 7;
  memset(share, 0, CUBE * sizeof *share);
  for (int ball = 0; ball < BALLS; ball++) {
    double drawn[4];
    for (int k = 0; k < 4; k++)
      drawn[k] = (double)(seed = seed * 1664525U + 1013904223U) / 4294967296.0;
    for (size_t i = 0; i < CUBE; i++) {
      const double dx = (double)(i % SIDE) - SIDE * drawn[0],
                   dz = (double)(i / SIDE / SIDE) - SIDE * drawn[2];
      const double dy = (double)(i / SIDE % SIDE) - SIDE * drawn[1];
      if (sqrt(dx * dx + dy * dy + dz * dz) < 4.0 + 4.0 * drawn[3]) share[i] = 1.0F;
    }
  }
}

static unsigned turned_bits(unsigned bits) { /* x to y, y to z, z to x */
  unsigned out = 0;
  for (int d = 0; d < 3; d++) {
    out |= bits & GRAINS_NEXT(d) ? GRAINS_NEXT((d + 1) % 3) : 0;
    out |= bits & GRAINS_LAST(d) ? GRAINS_LAST((d + 1) % 3) : 0;
  }
  return out;
}

static unsigned mirrored_bits(unsigned bits) { /* along x */
  return (bits & ~(GRAINS_NEXT(0) | GRAINS_LAST(0))) |
         (bits & GRAINS_NEXT(0) ? GRAINS_LAST(0) : 0) |
         (bits & GRAINS_LAST(0) ? GRAINS_NEXT(0) : 0);
}

/* The grains of a scan that lies another way are the same. */
static void test_turned(void **state) {
  (void)state;
  static const size_t cube[3] = {SIDE, SIDE, SIDE};
  float *share = floats(), *other = floats();
  uint8_t *contacts = NULL, *its = NULL;
  assert_int_equal(memory_allocate(&contacts, CUBE, 1, "test"), STATUS_OK);
  assert_int_equal(memory_allocate(&its, CUBE, 1, "test"), STATUS_OK);
  draw_pack(share);
  assert_int_equal(grains_find(share, cube, CUBES, contacts), STATUS_OK);
  for (int mirror = 0; mirror < 2; mirror++) {
    size_t found = 0, wrong = 0;
    for (int fill = 1; fill >= 0; fill--) {
      for (size_t i = 0; i < CUBE; i++) {
        const size_t x = i % SIDE, y = i / SIDE % SIDE, z = i / SIDE / SIDE;
        const size_t there = mirror ? i - x + (SIDE - 1 - x) : (y * SIDE + x) * SIDE + z;
        if (fill) {
          other[there] = share[i];
          continue;
        }
        found += contacts[i] != 0;
        wrong += its[there] != (mirror ? mirrored_bits(contacts[i]) : turned_bits(contacts[i]));
      }
      if (fill) assert_int_equal(grains_find(other, cube, CUBES, its), STATUS_OK);
    }
    print_message("%zu voxels at contacts, %zu of them elsewhere in the %s scan\n", found, wrong,
                  mirror ? "mirrored" : "turned");
    assert_true(found > 500);
    assert_int_equal(wrong, 0);
  }
  memory_free(&share);
  memory_free(&other);
  memory_free(&contacts);
  memory_free(&its);
}

/* A drawing as the scanner sees it, at work in `deblur`; returns what was drawn. Both to be freed.
 */
static float *scan(double (*distance)(const double at[3]), const struct deblur_scanner *scanner,
                   struct deblur *deblur) {
  float *truth = floats(), *work = floats();
  double weight[3];
  for (int d = 0; d < 3; d++) weight[d] = scanner->fringe * scanner->blur[d] * scanner->blur[d];
  assert_int_equal(deblur_start(N, scanner, deblur), STATUS_OK);
  memcpy(deblur->size, SIZE, sizeof SIZE);
  draw(distance, truth);
  gaussian_filter(truth, SIZE, scanner->blur, work, deblur->share);
  laplacian_subtract(deblur->share, SIZE, weight, deblur->grey);
  memory_free(&work);
  return truth;
}

/* Pore within `radius` of the axis and two voxels of the contact, voxels. */
static double wedge(const float *share, double radius) {
  double sum = 0.0;
  for (size_t i = 0; i < N; i++)
    if (fabs((double)(i % NX) + 0.5 - MIDDLE) < 2.0 &&
        hypot((double)(i / NX % NY) + 0.5 - 20.2, (double)(i / NX / NY) + 0.5 - 19.9) < radius)
      sum += share[i] < 0.5F;
  return sum;
}

static void test_wedge(void **state) {
  (void)state;
  const struct deblur_scanner scanner = {.blur = {1.6, 1.6, 1.6},
                                         .fringe = 0.4,
                                         .power = 0.02,
                                         .stretch = {1.0, 1.0, 1.0},
                                         .surface = 1.0};
  struct deblur deblur;
  float *truth = scan(touching, &scanner, &deblur);
  const double seen = wedge(deblur.grey, 5.0), wanted = wedge(truth, 5.0);
  assert_int_equal(deblur_run(&deblur), STATUS_OK);
  double off = 0.0;
  for (size_t i = 0; i < N; i++) {
    assert_true(deblur.share[i] > -1e-3F && deblur.share[i] < 1.001F);
    off += (double)(deblur.share[i] - truth[i]);
  }
  const double found = wedge(deblur.share, 5.0), area = 8.0 * 3.14159 * RADIUS * RADIUS;
  print_message("wedge: %g seen, %g without blur, %g true; walls %.3f voxels off\n", seen, found,
                wanted, off / area);
  assert_true(seen < 0.5 * wanted);
  assert_true(fabs(found / wanted - 1.0) < 0.1);
  assert_true(fabs(off / area) < 0.02);
  deblur_end(&deblur);
  memory_free(&truth);
}

static double fine(const double at[3]) {
  return hypot(at[0] - MIDDLE, hypot(at[1] - 20.2, at[2] - 19.9)) - 3.0;
}

/* Noise of contrast 5 that is correlated over a voxel has hardly any relief as fine as a sharp
 * scanner sees, so that taking it for white noise of its power smooths fines away. */
static void test_fine(void **state) {
  (void)state;
  const struct deblur_scanner scanner = {.blur = {0.75, 0.75, 0.75},
                                         .fringe = 0.7,
                                         .power = 1.6,
                                         .correlation = 1.0,
                                         .stretch = {1.0, 1.0, 1.0},
                                         .surface = 1.0};
  double seen = 0.0, wanted = 0.0;
  struct deblur deblur;
  float *truth = scan(fine, &scanner, &deblur);
  assert_int_equal(deblur_run(&deblur), STATUS_OK);
  for (size_t i = 0; i < N; i++) {
    seen += deblur.share[i] > 0.5F;
    wanted += truth[i] > 0.5F;
  }
  print_message("a grain of %g voxels: %g are left\n", wanted, seen);
  assert_true(seen > 0.6 * wanted);
  deblur_end(&deblur);
  memory_free(&truth);
}

/* Root mean square of what a voxel's share of grain is off. */
static double rough(const struct deblur *deblur, const float *truth) {
  const size_t n = deblur->size[0] * deblur->size[1] * deblur->size[2];
  double square = 0.0;
  for (size_t i = 0; i < n; i++) square += pow((double)(deblur->share[i] - truth[i]), 2.0);
  return sqrt(square / (double)n);
}

/* The iterations suffice: what more of them change of the shares of grain is less than a tenth of
 * what is off in them, with one phase or two. */
static void test_converged(void **state) {
  (void)state;
  static const double more[2] = {4.0, 2.0};
  for (int two = 0; two < 2; two++) {
    const struct deblur_scanner scanner = {.blur = {1.6, 1.6, 1.6},
                                           .fringe = 0.3,
                                           .power = 0.02,
                                           .stretch = {1.0, 1.0, 1.0},
                                           .surface = 1.0,
                                           .two_phases = two};
    float *usual = NULL;
    double off = 0.0;
    for (int run = 0; run < 2; run++) {
      struct deblur deblur;
      float *truth = scan(touching, &scanner, &deblur);
      deblur.size[2] = NZ / 2; /* one half of the two balls is as the other */
      if (run == 1) deblur.iterations = (int)(more[two] * deblur.iterations);
      deblur.beyond[2][0] = 1;
      assert_int_equal(deblur_run(&deblur), STATUS_OK);
      if (run == 0) {
        off = rough(&deblur, truth);
        usual = deblur.share, deblur.share = NULL;
      } else {
        const double changed = rough(&deblur, usual);
        print_message("%d phases: shares are %.4f off, of which iterations %.4f\n", two + 1, off,
                      changed);
        assert_true(changed < 0.1 * off);
      }
      deblur_end(&deblur);
      memory_free(&truth);
    }
    memory_free(&usual);
  }
}

/* Noise on the wall of a ball: less of it is left where walls are known to be smooth. */
static void test_smooth_walls(void **state) {
  (void)state;
  struct deblur_scanner scanner = {
      .blur = {1.2, 1.2, 1.2}, .power = 0.12, .correlation = 0.7, .stretch = {1.0, 1.0, 1.0}};
  double left[2];
  for (int smooth = 0; smooth < 2; smooth++) {
    struct deblur deblur;
    scanner.surface = smooth ? 8.0 : 1.0;
    float *truth = scan(long_grain, &scanner, &deblur), *noise = floats(), *work = floats();
    uint32_t n = 1;
    for (size_t i = 0; i < N; i++) { /* Knuth, Lewis: the linear congruential generator */
      n = 1664525U * n + 1013904223U;
      noise[i] = (float)n / 4294967296.0F - 0.5F;
    }
    gaussian_filter(noise, SIZE, (const double[3]){0.7, 0.7, 0.7}, work, noise);
    for (size_t i = 0; i < N; i++) deblur.grey[i] += 2.0F * noise[i];
    assert_int_equal(deblur_run(&deblur), STATUS_OK);
    left[smooth] = rough(&deblur, truth);
    deblur_end(&deblur);
    memory_free(&truth);
    memory_free(&noise);
    memory_free(&work);
  }
  print_message("shares of grain are %.4f off, %.4f where walls are smooth\n", left[0], left[1]);
  assert_true(left[1] < 0.75 * left[0]);
}

/* Root mean square of what the two slices at the face of a ball's cap, cut off where its wall is
 * oblique, are off; the scan is reflected at the face, and so many slices of that are no scan. */
static double off_at_face(size_t beyond) {
  enum { CUT = 28, AT = 2 * NX * NY };
  const struct deblur_scanner scanner = {
      .blur = {2.5, 2.5, 2.5}, .power = 0.001, .stretch = {1.0, 1.0, 1.0}, .surface = 1.0};
  struct deblur deblur;
  double square = 0.0;
  float *truth = scan(long_grain, &scanner, &deblur);
  const size_t plane = (size_t)NX * NY, shown = NZ - CUT;
  memmove(deblur.grey + beyond * plane, deblur.grey + CUT * plane,
          shown * plane * sizeof *deblur.grey);
  for (size_t z = 0; z < beyond; z++)
    memcpy(deblur.grey + z * plane, deblur.grey + (2 * beyond - 1 - z) * plane,
           plane * sizeof *deblur.grey);
  deblur.size[2] = shown + beyond;
  deblur.beyond[2][0] = beyond;
  assert_int_equal(deblur_run(&deblur), STATUS_OK);
  for (size_t i = 0; i < AT; i++)
    square += pow((double)(deblur.share[beyond * plane + i] - truth[CUT * plane + i]), 2.0);
  deblur_end(&deblur);
  memory_free(&truth);
  return sqrt(square / AT);
}

static void test_face(void **state) {
  (void)state;
  const double reflected = off_at_face(0), sought = off_at_face(5);
  print_message("shares at a face are %.4f off, %.4f where grains beyond it are sought\n",
                reflected, sought);
  assert_true(sought < 0.7 * reflected);
}

/* Balls of five voxels' radius, face-centred cubic: the blur hides all pores between them. */
static double dense(const double at[3]) {
  static const int sites[4][3] = {{0, 0, 0}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}};
  const double edge = 10.0 * sqrt(2.0);
  double nearest = INFINITY;
  for (int site = 0; site < 4; site++) {
    double square = 0.0;
    for (int d = 0; d < 3; d++)
      square += pow(remainder(at[d] - 0.5 * edge * sites[site][d], edge), 2.0);
    nearest = fmin(nearest, sqrt(square));
  }
  return nearest - 5.0;
}

/* Hidden pores are no darker grain: they are found, where grains beyond a face are sought, as in
 * all scans. */
static void test_hidden_pores(void **state) {
  (void)state;
  const struct deblur_scanner scanner = {
      .blur = {2.0, 2.0, 2.0}, .power = 0.001, .stretch = {1.0, 1.0, 1.0}, .surface = 1.0};
  double seen = 0.0, found = 0.0, wanted = 0.0;
  struct deblur deblur;
  float *truth = scan(dense, &scanner, &deblur);
  for (size_t i = 0; i < N; i++) seen += deblur.grey[i] < 0.5F;
  deblur.beyond[2][0] = 1;
  assert_int_equal(deblur_run(&deblur), STATUS_OK);
  for (size_t i = 0; i < N; i++) {
    found += deblur.share[i] < 0.5F;
    wanted += truth[i] < 0.5F;
  }
  print_message("%g voxels of pore: %g seen, %g found\n", wanted, seen, found);
  assert_true(seen < 0.01 * wanted);
  assert_true(fabs(found / wanted - 1.0) < 0.2);
  deblur_end(&deblur);
  memory_free(&truth);
}

/* (1 + A cos)/2, `period` voxels long along x. A scanner whose spot is a Gaussian, with a fringe,
 * and whose voxels are averages shows (1 + T A cos)/2, T = exp(-b^2 q^2/2) (1 + f b^2 q^2)
 * sin(q/2)/(q/2). */
static void wave(const struct deblur_scanner *scanner, double period, double amplitude,
                 struct deblur *deblur, double *transfer) {
  const size_t size[3] = {32, 4, 4}, n = 32 * 4 * 4;
  const double q = 2.0 * M_PI / period, x = pow(scanner->blur[0] * q, 2.0);
  *transfer = exp(-0.5 * x) * (1.0 + scanner->fringe * x) * sin(0.5 * q) / (0.5 * q);
  assert_int_equal(deblur_start(n, scanner, deblur), STATUS_OK);
  memcpy(deblur->size, size, sizeof size);
  for (size_t i = 0; i < n; i++) {
    const double at = 0.5 * amplitude * cos(q * ((double)(i % size[0]) + 0.5));
    deblur->grain[i] = 1.0F;
    deblur->u[i] = (float)(0.5 + at);
    deblur->grey[i] = (float)(0.5 + *transfer * at);
  }
}

/* Rows of any length are filtered to the same bits along x, many voxels at a time, as along y,
 * three at a time. */
static void test_rows(void **state) {
  (void)state;
  enum { LONGEST = 70, ROWS = 3 };
  float along[ROWS * LONGEST], across[ROWS * LONGEST], work[ROWS * LONGEST];
  for (size_t n = 2; n <= LONGEST; n++) {
    for (size_t i = 0; i < ROWS * n; i++) {
      along[i] = (float)((i * 2654435761U) % 1000U) / 1000.0F;
      across[i % n * ROWS + i / n] = along[i];
    }
    gaussian_filter(along, (const size_t[3]){n, ROWS, 1}, (const double[3]){2.0, 0.0, 0.0}, work,
                    along);
    gaussian_filter(across, (const size_t[3]){ROWS, n, 1}, (const double[3]){0.0, 2.0, 0.0}, work,
                    across);
    for (size_t i = 0; i < ROWS * n; i++)
      assert_memory_equal(&along[i], &across[i % n * ROWS + i / n], sizeof *along);
  }
}

/* The transfer that the misfit is of, to a hundredth of what a voxel and the fringe take and give.
 */
static void test_transfer(void **state) {
  (void)state;
  for (int fringe = 0; fringe < 2; fringe++) {
    const struct deblur_scanner scanner = {.blur = {1.2, 1.2, 1.2},
                                           .fringe = 0.4 * fringe,
                                           .power = 0.01,
                                           .stretch = {1.0, 1.0, 1.0},
                                           .surface = 1.0};
    struct deblur deblur;
    double transfer;
    wave(&scanner, 16.0, 1.0, &deblur, &transfer);
    const double n = (double)(deblur.size[0] * deblur.size[1] * deblur.size[2]);
    const double off = sqrt(8.0 * deblur_misfit(&deblur, deblur.grey) / n) / transfer;
    print_message("fringe %g: transfer %.4f, off by %.5f of it\n", scanner.fringe, transfer, off);
    assert_true(off < 0.002);
    deblur_end(&deblur);
  }
}

/* Relief that a fringe amplifies the most is found, and not overshot at every step. */
static void test_strong_fringe(void **state) {
  (void)state;
  const struct deblur_scanner scanner = {.blur = {1.2, 1.2, 1.2},
                                         .fringe = 1.5,
                                         .power = 1e-6,
                                         .stretch = {1.0, 1.0, 1.0},
                                         .surface = 1.0};
  enum { COUNT = 32 * 4 * 4 };
  struct deblur deblur;
  float grey[COUNT];
  double transfer;
  wave(&scanner, 8.0, 0.4, &deblur, &transfer);
  memcpy(grey, deblur.grey, sizeof grey);
  deblur.compared = true;
  assert_int_equal(deblur_run(&deblur), STATUS_OK);
  const double off = sqrt(8.0 * deblur_misfit(&deblur, grey) / COUNT) / 0.4;
  print_message("amplified by %.2f, found but for %.4f\n", transfer, off);
  assert_true(transfer > 1.3 && off < 0.05);
  deblur_end(&deblur);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_rows),     cmocka_unit_test(test_grains),
      cmocka_unit_test(test_turned),   cmocka_unit_test(test_wedge),
      cmocka_unit_test(test_fine),     cmocka_unit_test(test_smooth_walls),
      cmocka_unit_test(test_face),     cmocka_unit_test(test_hidden_pores),
      cmocka_unit_test(test_transfer), cmocka_unit_test(test_strong_fringe),
      cmocka_unit_test(test_converged)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
