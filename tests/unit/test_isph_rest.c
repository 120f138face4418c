/* Water at rest over soils of any permeability stays at rest, from the first step on, and returns
 * to rest. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/isph/output.h"
#include "sphsolve/isph/step.h"
#include "sphsolve/isph/time_step.h"
#include "tests/unit/isph_scene.h"

#include "sphsolve/isph/energy.h"

#define SOIL(x0, z0, x1, z1, porosity, k)                                                          \
  "{ type = \"porous\"; box = [\"" x0 " m\", \"" z0 " m\", \"" x1 " m\", \"" z1                    \
  " m\"]; porosity = " porosity "; permeability = \"" k " m/s\"; },\n"

#define SLOPE(corners, porosity, k)                                                                \
  "{ type = \"porous\"; corners = [" corners "]; porosity = " porosity "; permeability = \"" k     \
  " m/s\"; },\n"

static const struct {
  const char *name, *soils;
  bool sealed; /* coarse soil that only clay joins to the surface */
} grounds[] = {
    {"core of clay",
     SOIL("0.3", "0", "0.7", "0.56", "0.4", "1e-2")
         SOIL("0.44", "0", "0.56", "0.56", "0.4", "1e-9"),
     false},
    {"gravel beside clay",
     SOIL("0", "0", "0.5", "0.56", "0.4", "1e-1") SOIL("0.5", "0", "1", "0.56", "0.4", "1e-7"),
     false},
    {"a ratio of 1e12",
     SOIL("0", "0", "0.5", "0.56", "0.4", "1") SOIL("0.5", "0", "1", "0.56", "0.4", "1e-12"),
     false},
    {"clay over gravel",
     SOIL("0", "0", "1", "0.25", "0.4", "1e-1") SOIL("0", "0.25", "1", "0.56", "0.4", "1e-9"),
     true},
    {"five soils",
     SOIL("0", "0", "0.2", "0.56", "0.4", "1e-1") SOIL("0.2", "0", "0.4", "0.56", "0.35", "1e-9")
         SOIL("0.4", "0", "0.6", "0.3", "0.4", "1e-3")
             SOIL("0.4", "0.3", "0.6", "0.56", "0.3", "1e-6")
                 SOIL("0.6", "0", "1", "0.56", "0.45", "1e-2"),
     false},
    {"a bed under open water", SOIL("0", "0", "1", "0.2", "0.4", "1e-3"), false},
    {"two rows of the upper of two soils",
     SOIL("0", "0", "1", "0.46", "0.37", "1e-6") SOIL("0", "0.46", "1", "0.56", "0.54", "1e-4"),
     false},
    {"a block of tight soil in open water", SOIL("0.3", "0.1", "0.7", "0.32", "0.26", "1e-3"),
     false},
    {"open water beside tight soil", SOIL("0", "0", "0.46", "0.38", "0.25", "1e-3"), false},
    {"a row of open water over two soils",
     SOIL("0", "0", "1", "0.2", "0.26", "1e-9") SOIL("0", "0.2", "1", "0.472", "0.337", "6e-4"),
     false},
    {"a slope of tight soil",
     SLOPE("\"0\", \"0\", \"0.73 m\", \"0\", \"0.5 m\", \"0.56 m\", \"0\", \"0.56 m\"", "0.151",
           "1e-3"),
     false},
    {"a bank of tight soil",
     SLOPE("\"0\", \"0\", \"0.8 m\", \"0\", \"0.3 m\", \"0.44 m\", \"0\", \"0.44 m\"", "0.25",
           "1e-3"),
     false},
};

static void begin(struct run *run, size_t k) {
  char text[2400];
  snprintf(text, sizeof text,
           "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
           "domain = { size = [\"1 m\", \"0.6 m\"]; spacing = \"2 cm\"; periodic = [false, false]; "
           "};\nregions = (\n%s{ type = \"water\"; box = [\"0\", \"0\", \"1 m\", \"0.5 m\"]; } );\n"
           "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
           grounds[k].soils);
  start(run, text);
}

/* Largest velocity, m/s, and largest error of the pressure over that at the foot. */
static void find_worst(const struct isph *s, double worst[2]) {
  for (size_t i = 0; i < s->count; i++) {
    const double *v = s->velocity[i];
    const double off = s->pressure[i] - s->density * 9.81 * (.5 - s->position[i][2]);
    worst[0] = fmax(worst[0], sqrt(v[0] * v[0] + v[2] * v[2]));
    worst[1] = fmax(worst[1], fabs(off) / (s->density * 9.81 * .5));
  }
}

/* Beside the edges of soil, in corners and on surfaces over soils of different size the sums over
 * neighbours are not those of even water: taken for a lack of it, that moved still water by 6 mm/s.
 * Gauges are right from the first step on. */
static void water_over_soils_is_still(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof grounds / sizeof *grounds; k++) {
    struct run run;
    const char *limit;
    double worst[2] = {0};
    begin(&run, k);
    assert_true(fabs(pressure_at(&run.s, (double[3]){.1, 0, 0}) / 4905 - 1) < 1e-3);
    for (int step = 0; step < 20; step++) {
      assert_int_equal(isph_advance(&run.s, isph_stable_dt(&run.s, &limit)), STATUS_OK);
      find_worst(&run.s, worst);
    }
    print_message("%s: %.2g m/s, pressure within %.2g\n", grounds[k].name, worst[0], worst[1]);
    assert_true(worst[0] < 1e-6);
    assert_true(worst[1] < 1e-3);
    finish(&run);
  }
}

/* The same, disturbed: the first pressure is 0, and nothing is known of the arrangement, so that it
 * moves the water by some mm/s. Beside clay the divergence counted the velocities of gravel, which
 * no link carries: the water of a ratio of 1e4 and more left the tank at 28 m/s. In coarse soil
 * sealed by clay the correction of the density finds no outlet; that is not judged here. */
static void disturbed_water_returns_to_rest(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof grounds / sizeof *grounds; k++) {
    struct run run;
    const char *limit;
    double worst[2] = {0};
    if (grounds[k].sealed) continue;
    begin(&run, k);
    memset(run.s.packing, 0, run.s.count * sizeof *run.s.packing);
    memset(run.s.submerged, 0, run.s.count * sizeof *run.s.submerged);
    memset(run.s.pressure, 0, run.s.count * sizeof *run.s.pressure);
    for (int step = 0; step < 40; step++)
      assert_int_equal(isph_advance(&run.s, isph_stable_dt(&run.s, &limit)), STATUS_OK);
    find_worst(&run.s, worst);
    print_message("%s: %.2g m/s, pressure within %.2g\n", grounds[k].name, worst[0], worst[1]);
    assert_true(worst[0] < .01);
    assert_true(worst[1] < .02);
    finish(&run);
  }
}

/* Begins shallow water 17 spacings long beside a side whose head is `rows` spacings, with `more`
 * rows and at a velocity, m/s. */
static void begin_beside_level(struct run *run, int rows, int more, double velocity) {
  char text[1024];
  snprintf(text, sizeof text,
           "scene = { method = \"isph\"; end_time = \"60 s\"; };\n"
           "domain = { size = [\"17 cm\", \"9 cm\"]; spacing = \"1 cm\"; periodic = [false, "
           "false]; };\n"
           "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"17 cm\", \"%d cm\"]; velocity = "
           "[\"%g m/s\", \"0\"]; },\n"
           "{ type = \"inflow\"; box = [\"16 cm\", \"0\", \"17 cm\", \"8 cm\"]; head = \"%d "
           "cm\"; } );\n"
           "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
           rows + more, velocity, rows);
  start(run, text);
}

/* The largest velocity of that water in the mean of its energy, m/s, over ten seconds from `from`.
 */
static double moves_beside_level(int rows, int more, double velocity, double from) {
  struct run run;
  const char *limit;
  double most = 0;
  begin_beside_level(&run, rows, more, velocity);
  while (run.s.time < from + 10) {
    double mass = 0;
    assert_int_equal(isph_advance(&run.s, isph_stable_dt(&run.s, &limit)), STATUS_OK);
    for (size_t i = 0; i < run.s.count; i++) mass += run.s.mass[i];
    if (run.s.time > from) most = fmax(most, sqrt(2 * isph_kinetic_energy(&run.s) / mass));
  }
  finish(&run);
  return most;
}

/* A row too high, it went on sloshing at .2 of a fall through its depth: shifting lifted it, and
 * the side gave it the energy of what comes in. The relaxation of its density made small waves on
 * three rows grow. */
static void shallow_water_beside_a_level_comes_to_rest(void **state) {
  (void)state;
  for (int rows = 2; rows <= 4; rows++) {
    const double fall = sqrt(2 * 9.81 * .01 * rows);
    const double sloshes = moves_beside_level(rows, 1, 0, 20) / fall;
    const double small = moves_beside_level(rows, 0, .01, 10);
    print_message("%d rows: sloshes at %.2g of a fall, small waves of .01 m/s at %.2g\n", rows,
                  sloshes, small);
    assert_true(sloshes < .1);
    assert_true(small < .01);
  }
}

/* What comes in past a side of given head was at rest before. What leaves meets the whole head. */
static void a_level_gives_no_kinetic_energy(void **state) {
  (void)state;
  for (int way = -1; way <= 1; way += 2) {
    struct run run;
    const double speed = .2;
    double worst = 0;
    begin_beside_level(&run, 4, 0, way * speed); /* the side is at the high end: -1 is inwards */
    assert_int_equal(isph_advance(&run.s, 1e-6), STATUS_OK);
    for (size_t j = 0; j < run.s.boundary_count; j++) {
      if (run.s.boundary_kind[j] != BOUNDARY_OPEN_HEAD) continue;
      const double still = 9810 * (.04 - run.s.boundary_position[j][2]);
      const double exact = still - fmin(still, way < 0 ? 500 * speed * speed : 0);
      worst = fmax(worst, fabs(run.s.boundary_pressure[j] - exact));
    }
    print_message("pressure on the side within %.2g Pa\n", worst);
    assert_true(worst < .1);
    finish(&run);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(water_over_soils_is_still),
                                     cmocka_unit_test(disturbed_water_returns_to_rest),
                                     cmocka_unit_test(shallow_water_beside_a_level_comes_to_rest),
                                     cmocka_unit_test(a_level_gives_no_kinetic_energy)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
