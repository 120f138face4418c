/* The budget of momentum and energy, where the balance is known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "sphsolve/isph/budget.h"
#include "sphsolve/wcsph/budget.h"
#include "sphsolve/isph/step.h"
#include "tests/unit/engine_march.h"
#include "tests/unit/isph_scene.h"

static void assert_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    print_message("%g is not %g +- %g\n", value, expected, tolerance);
  assert_true(fabs(value - expected) <= tolerance);
}

/* A number of the budget is a product of some ten factors, added up over its chunk, over the
 * chunks and over the steps: each of these roundings is at most 2^-53 of the sum. */
static double rounding(const struct run *run, double steps) {
  return (10 + CHUNK + (double)run->s.count / CHUNK + steps) * 0x1p-53;
}

/* The budget is an identity, particle by particle: each of its terms rounds as above, and is no
 * larger than the largest. */
static void assert_closes(struct run *run, double steps) {
  double open, vector[3];
  const double bound = (1 + __builtin_popcount(run->s.budget.on)) * rounding(run, steps);
  isph_budget_end(&run->s);
  assert_near(budget_energy_open(&run->s.budget, &open), 0, bound);
  assert_near(budget_momentum_open(&run->s.budget, vector), 0, bound);
}

static double impulse(const struct run *run, enum budget_term term, int axis) {
  return run->s.budget.sums.impulse[term][axis];
}

/* Of mass and momentum that grow evenly the integrals are exact, over uneven steps too. */
static void the_history_is_integrated(void **state) {
  (void)state;
  const double acceleration[3] = {0.5, 0, -2}, at[] = {0, 0.1, 0.4, 2};
  struct conservation_row row[4] = {{0}};
  struct conservation found = {0};
  for (int i = 0; i < 4; i++)
    row[i] = (struct conservation_row){.time = at[i],
                                       .mass = 3 + at[i],
                                       .momentum = {at[i], 7, 2 * at[i]},
                                       .kinetic_energy = 5 - at[i]};
  conservation_integrate(&found, 4, row, acceleration);
  for (int a = 0; a < 3; a++) assert_near(found.impulse[a], (3 * 2 + 2) * acceleration[a], 1e-14);
  assert_near(found.work, 2 * 0.5 - 4 * 2, 1e-14);
  assert_near(found.mass[1] - found.mass[0], 2, 1e-14);
  assert_near(found.kinetic_energy[1] - found.kinetic_energy[0], -2, 1e-14);
  assert_near(found.momentum[1][2], 4, 1e-14);
}

#define GRAVITY "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n"
#define TANK                                                                                       \
  "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"                                          \
  "domain = { size = [\"0.2 m\", \"0.3 m\"]; spacing = \"1 cm\"; };\n" GRAVITY

/* The floor carries the weight; the sides push as hard from left as from right, each half as hard
 * as the floor, as far as the pressure is solved. It is known to half a spacing of depth, of
 * twenty. */
static void floor_carries_the_weight(void **state) {
  (void)state;
  struct run run;
  start(&run,
        TANK "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.2 m\", \"0.2 m\"]; } );");
  const double steps = advance(&run, 0.1);
  const double weight = 1000 * 0.2 * 0.2 * 0.01 * 9.81 * 0.1;
  assert_near(impulse(&run, BUDGET_FORCE, 2), -weight, rounding(&run, steps) * weight);
  assert_near(impulse(&run, BUDGET_WALL_PRESSURE, 2), weight, 0.5 / 20 * weight);
  assert_near(impulse(&run, BUDGET_WALL_PRESSURE, 0), 0, run.scene.isph.tolerance * weight / 2);
  assert_closes(&run, steps);
  finish(&run);
}

/* A drop in free fall has momentum M g t to rounding. Each of n steps dt moves it by the velocity
 * at its end, so that it falls g t (t + dt)/2: the time steps take m g^2 t dt/2. */
static void a_falling_drop_keeps_its_energy(void **state) {
  (void)state;
  struct run run;
  start(&run, TANK "regions = ( { type = \"water\"; box = [\"0.1 m\", \"0.26 m\", \"0.11 m\", "
                   "\"0.27 m\"]; } );");
  for (int k = 0; k < 100; k++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  const double m = 1000 * 0.01 * 0.01 * 0.01, g = 9.81, t = 0.1, dt = 1e-3;
  const double error = rounding(&run, 100) * m * g * g * t * t;
  const struct budget *budget = &run.s.budget;
  assert_closes(&run, 100);
  assert_near(budget->momentum[1][2], -m * g * t, rounding(&run, 100) * m * g * t);
  assert_near(budget->energy[1], 0.5 * m * g * g * t * t, error);
  assert_near(budget->sums.work[BUDGET_FORCE], 0.5 * m * g * g * t * (t + dt), error);
  assert_near(budget->sums.work[BUDGET_TIME_STEP], -0.5 * m * g * g * t * dt, error);
  assert_near(budget->sums.work[BUDGET_PROJECTION], 0, error);
  finish(&run);
}

/* Seepage round a periodic box of soil: the drag carries the head, and heats by what it gives. At
 * the end the water has the momentum of a v + b v^2 = g, and that much less went into drag, as far
 * as the pressure is solved. Of the energy it has half that share; and the way on which gravity
 * works is known to that of a step. */
static void drag_carries_the_head(void **state) {
  (void)state;
  struct run run;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"4 cm\", \"4 cm\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"4 cm\", \"4 cm\"]; porosity = "
        "0.3; grain_size = \"1 mm\"; alpha = 1000.0; beta = 1.1; } );\n" GRAVITY
        "isph = { dt = \"1 ms\"; };\n");
  for (int k = 0; k < 200; k++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  const struct budget_sums *sums = &run.s.budget.sums;
  const double a = run.s.drag_a[0], b = run.s.drag_b[0], g = 9.81, t = 0.2, dt = 1e-3;
  const double v = 2 * g / (a + sqrt(a * a + 4 * b * g)), kept = run.s.inertia[0] * v / (g * t);
  const double force = impulse(&run, BUDGET_FORCE, 2), work = sums->work[BUDGET_FORCE];
  assert_closes(&run, 200);
  assert_near(impulse(&run, BUDGET_DRAG_LINEAR, 2) + impulse(&run, BUDGET_DRAG_FORCHHEIMER, 2),
              -(1 - kept) * force, -run.scene.isph.tolerance * force);
  assert_near(sums->work[BUDGET_DRAG_LINEAR] + sums->work[BUDGET_DRAG_FORCHHEIMER], -work,
              (kept / 2 + dt / t) * work);
  finish(&run);
}

/* A wall drives water up through gravel beside clay: the flux is all in the gravel, which takes the
 * work rho g L q^2/k a second and area, and the wall gives that and lifts the water. The gravel is
 * known to half a particle at each end, of 15, and one at the clay, of 8; the water's way to one
 * of 37. The clay has water of the gravel for neighbours, which is faster by 1e6. */
static void gravel_beside_clay_takes_what_the_wall_gives(void **state) {
  (void)state;
  struct run run;
  start(&run, "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
              "domain = { size = [\"0.16 m\", \"0.5 m\"]; spacing = \"1 cm\"; };\n" GRAVITY
              "isph = { wall = { slip = true; }; };\n"
              "regions = ( { type = \"porous\"; box = [\"0\", \"0.15 m\", \"0.08 m\", \"0.3 m\"]; "
              "porosity = 0.4; permeability = \"1e-2 m/s\"; },\n"
              "{ type = \"porous\"; box = [\"0.08 m\", \"0.15 m\", \"0.16 m\", \"0.3 m\"]; "
              "porosity = 0.4; permeability = \"1e-8 m/s\"; },\n"
              "{ type = \"water\"; box = [\"0\", \"3 cm\", \"0.16 m\", \"0.4 m\"]; },\n"
              "{ type = \"wall\"; box = [\"0\", \"0\", \"0.16 m\", \"3 cm\"]; slip = true; "
              "velocity = [\"0\", \"1 cm/s\"]; } );\n");
  const double steps = advance(&run, 1);
  const double *work = run.s.budget.sums.work, rate = 1000 * 9.81 * 0.01 * 0.16 * run.s.thickness;
  const double lifts = rate * 0.37, takes = rate * 2 * 0.01 / 1e-2 * 0.15;
  const double way = 1. / 37, gravel = 1. / 15 + 1. / 8;
  assert_closes(&run, steps);
  assert_near(work[BUDGET_WALL_PRESSURE], lifts + takes, way * (lifts + takes));
  assert_near(-work[BUDGET_DRAG_LINEAR], takes, (gravel + way) * takes);
  assert_near(work[BUDGET_PROJECTION], 0, (gravel + way) * (lifts + takes));
  finish(&run);
}

/* Water that falls into soil in a tank, a piston, moving soil, open sides, eddies: whatever a step
 * does is in the budget. */
static void the_budget_closes_with_everything(void **state) {
  (void)state;
  static const char *const scenes[] = {
      TANK
      "regions = ( { type = \"porous\"; box = [\"0.1 m\", \"0\", \"0.2 m\", \"0.1 m\"]; porosity "
      "= 0.4; grain_size = \"1 cm\"; }, { type = \"water\"; box = [\"0\", \"0\", \"0.1 m\", "
      "\"0.2 m\"]; } );",
      TANK
      "regions = ( { type = \"water\"; box = [\"0.03 m\", \"0\", \"0.2 m\", \"0.1 m\"]; }, { type "
      "= \"wall\"; box = [\"0\", \"0\", \"0.03 m\", \"0.1 m\"]; velocity = [\"0.1 m/s\", \"0\"]; "
      "} );",
      "scene = { method = \"isph\"; end_time = \"9 s\"; };\n"
      "domain = { size = [\"0.3 m\", \"0.05 m\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.3 m\", \"0.05 m\"]; },\n"
      "{ type = \"porous\"; box = [\"0\", \"0\", \"0.1 m\", \"0.05 m\"]; porosity = 0.4; "
      "grain_size = \"2 mm\"; velocity = [\"0.1 m/s\", \"0\"]; } );\n"
      "force = { gravity = [\"0\", \"0\"]; };\n",
      TANK
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.2 m\", \"0.3 m\"]; },\n"
      "{ type = \"porous\"; box = [\"0.05 m\", \"0\", \"0.15 m\", \"0.3 m\"]; porosity = 0.4; "
      "grain_size = \"5 mm\"; },\n"
      "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.3 m\"]; head = \"0.5 m\"; },\n"
      "{ type = \"inflow\"; box = [\"0.19 m\", \"0\", \"0.2 m\", \"0.3 m\"]; head = \"0.4 m\"; } "
      ");"};
  for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
    struct run run;
    start(&run, scenes[k]);
    assert_closes(&run, advance(&run, 0.2));
    finish(&run);
  }
}

static void threads_keep_one_budget(void **state) {
  (void)state;
#ifdef _OPENMP
  struct run run[2];
  int before = omp_get_max_threads();
  for (int k = 0; k < 2; k++) {
    threads_use(1 + 2 * k);
    start(&run[k],
          TANK "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.1 m\", \"0.2 m\"]; "
               "} );");
    advance(&run[k], 0.1);
    isph_budget_end(&run[k].s);
  }
  threads_use(0);
  omp_set_num_threads(before);
  assert_memory_equal(&run[0].s.budget, &run[1].s.budget, sizeof run[0].s.budget);
  for (int k = 0; k < 2; k++) finish(&run[k]);
#endif
}

/* A slit of water, each wall scheme: friction takes what the force gives, but for what the flow
 * still gains, as the next step tells. That difference of two sums of velocities of 24 bits is
 * known to 2^-24 w^2 f/(8 nu) over a step; and the pairs of a particle, pi 2.9^2 of fluid and as
 * many of walls, are added with 24 bits, each side w/(2 dx) times the force. Weighted with
 * velocities, half as much again. Of the start-up 8/pi^2 exp(-pi^2 nu t/w^2) is left, w known to
 * half a spacing. */
static void walls_take_the_force_of_a_slit(void **state) {
  (void)state;
  const double dx = 1e-4, nu = 1e-6, f = 1e-3;
  const enum pass_wall walls[] = {PASS_FROZEN, PASS_ADAMI, PASS_SUBVOXEL, PASS_EULERIAN};
  for (int k = 0; k < 4; k++) {
    struct lattice lattice = test_slit(4, 0.5, dx);
    const double wide = (walls[k] == PASS_FROZEN ? 5 : 4) * dx;
    struct march march = {.wall = walls[k], .nu = nu, .force = {f}};
    struct engine_settings settings = test_march_settings(&lattice, &march);
    struct engine engine;
    struct pass_budget now, next;
    assert_int_equal(engine_make(&lattice, &settings, &engine), STATUS_OK);
    for (double t = 0; t < 1.1 * wide * wide / nu; t += settings.dt)
      assert_int_equal(engine_step(&engine), STATUS_OK);
    assert_int_equal(engine_budget(&engine, &now), STATUS_OK);
    assert_int_equal(engine_step(&engine), STATUS_OK);
    assert_int_equal(engine_budget(&engine, &next), STATUS_OK);
    const double force = f * (double)lattice.fluid_count, dt = settings.dt;
    const double gain = (next.momentum[0] - now.momentum[0]) / dt / force;
    const double energy_gain = (next.kinetic - now.kinetic) / dt / now.force_work;
    const double stored = 0x1p-24 * wide * wide / (8 * nu) / dt;
    const double bound = stored + 2 * M_PI * 2.9 * 2.9 * 0x1p-24 * wide / (2 * dx);
    assert_near(gain, 0,
                8 / (M_PI * M_PI) * exp(-1.1 * M_PI * M_PI * pow(wide / (wide + dx / 2), 2)));
    assert_near((now.friction[0] + now.wall_pressure[0] + now.shift[0]) / force, gain - 1, bound);
    assert_near((now.friction_work + now.viscous_work + now.pressure_work + now.shift_work) /
                    now.force_work,
                energy_gain - 1, 1.5 * bound);
    engine_free(&engine);
    test_lattice_free(&lattice);
  }
}

/* As a plan's effects have them. */
static uint32_t terms_of(const struct engine_settings *s) {
  const double *f = s->force;
  return (f[0] != 0 || f[1] != 0 || f[2] != 0 ? 1u << BUDGET_FORCE : 0) |
         (s->viscous ? 1u << BUDGET_VISCOSITY : 0) | (s->shift ? 1u << BUDGET_SHIFTING : 0) |
         (s->wall == PASS_EULERIAN ? 1u << BUDGET_ADVECTION : 0);
}

/* Flow among balls from rest: what the budget of a step says is what the step does to momentum
 * (with walls' pressure in place of the fluid's: on the undisturbed lattice they are the same, and
 * frozen walls' always) and to energy. Velocities are stored with 24 bits: each of n steps rounds
 * each of N velocities by 2^-24 of the fastest at most. What walls and fluid are told the same are
 * sums with 24 bits over the 4/3 pi 2.9^3 neighbours of a particle, 2 P V |grad W| each, of which
 * the quintic spline's sum V |grad W| is 2 <1/r> = 2.28/h. */
static void a_step_does_what_its_budget_says(void **state) {
  (void)state;
  const double parameter[4] = {16, 4.5, 8, 7};
  const enum pass_wall walls[] = {PASS_FROZEN, PASS_ADAMI, PASS_SUBVOXEL, PASS_EULERIAN};
  for (int k = 0; k < 4; k++) {
    struct lattice lattice =
        test_geometry(3, (const size_t[3]){16, 16, 16}, 5e-5, test_balls, parameter);
    struct march march = {.wall = walls[k], .nu = 1e-5, .force = {0, 0, -1}, .sound = 1.2};
    struct engine_settings settings = test_march_settings(&lattice, &march);
    struct engine engine;
    struct wcsph_budget budget;
    const int steps = 10;
    double open[3], energy;
    assert_int_equal(engine_make(&lattice, &settings, &engine), STATUS_OK);
    wcsph_budget_begin(&engine, terms_of(&settings), &budget);
    for (int n = 0; n <= steps; n++) {
      assert_int_equal(wcsph_budget_sample(&engine, 1, n * settings.dt, &budget), STATUS_OK);
      assert_int_equal(engine_step(&engine), STATUS_OK);
    }
    const double n = (double)lattice.fluid_count;
    const double rounding = steps * n * engine.speed_max * 0x1p-24;
    double pressure = 0; /* over density, of all; largest at the end */
    for (size_t i = 0; i < particles_slots(&engine.particles); i++)
      if (engine.particles.id[i] != NO_PARTICLE)
        pressure += fabs(engine_pressure(&engine, i)) * settings.sound_speed * settings.sound_speed;
    const double sums = 4 / 3.0 * M_PI * pow(2.9, 3) * 0x1p-24 * 2 * pressure * 2.28 /
                        settings.smoothing_length * steps * settings.dt;
    budget_momentum_open(&budget.total, open);
    budget_energy_open(&budget.total, &energy);
    for (int a = 0; a < 3; a++) {
      assert_near(open[a], 0, rounding);
      assert_near(budget.total.sums.impulse[BUDGET_PROJECTION][a], 0, rounding + sums);
    }
    assert_near(energy, 0, rounding * engine.speed_max);
    engine_free(&engine);
    test_lattice_free(&lattice);
  }
}

/* Samples change no bit of the run, and on any number of threads are the same. */
static void samples_change_nothing(void **state) {
  (void)state;
#ifdef _OPENMP
  const double parameter[4] = {16, 4.5, 8, 7};
  struct lattice lattice =
      test_geometry(3, (const size_t[3]){16, 16, 16}, 5e-5, test_balls, parameter);
  const int before = omp_get_max_threads();
  for (int wall = 0; wall < 4; wall++) {
    const enum pass_wall walls[] = {PASS_FROZEN, PASS_ADAMI, PASS_SUBVOXEL, PASS_EULERIAN};
    struct march march = {.wall = walls[wall], .nu = 1e-5, .force = {0, 0, -100}, .sound = 1.2};
    struct engine_settings settings = test_march_settings(&lattice, &march);
    struct wcsph_budget budget[3] = {0};
    struct engine engine[3];
    for (int k = 0; k < 3; k++) {
      threads_use(1 + 2 * (k > 1));
      assert_int_equal(engine_make(&lattice, &settings, &engine[k]), STATUS_OK);
      if (k > 0) wcsph_budget_begin(&engine[k], terms_of(&settings), &budget[k]);
      for (int n = 0; n < 6; n++) {
        if (k > 0)
          assert_int_equal(wcsph_budget_sample(&engine[k], 1, n * settings.dt, &budget[k]),
                           STATUS_OK);
        assert_int_equal(engine_step(&engine[k]), STATUS_OK);
      }
    }
    threads_use(0);
    omp_set_num_threads(before);
    const size_t bytes = particles_slots(&engine[0].particles) * sizeof(float);
    for (int k = 1; k < 3; k++) {
      assert_memory_equal(engine[0].particles.v[2], engine[k].particles.v[2], bytes);
      assert_memory_equal(engine[0].particles.x[2], engine[k].particles.x[2], bytes);
      assert_memory_equal(engine[0].particles.state, engine[k].particles.state, bytes);
    }
    assert_memory_equal(&budget[1], &budget[2], sizeof budget[1]);
    for (int k = 0; k < 3; k++) engine_free(&engine[k]);
  }
  test_lattice_free(&lattice);
#endif
}

/* Work that no equation contains is told where it is more than a share of the rest: what shifting
 * gives and the time step takes again is none. */
static void work_of_no_equation_is_told(void **state) {
  (void)state;
  struct budget budget = {.on = 1u << BUDGET_WALL_PRESSURE | 1u << BUDGET_SHIFTING |
                                1u << BUDGET_TIME_STEP};
  budget.sums.work[BUDGET_WALL_PRESSURE] = 10;
  budget.sums.work[BUDGET_SHIFTING] = 2;
  assert_true(budget_warn(&budget, .05, 0));
  assert_false(budget_warn(&budget, .05, 100)); /* little beside what counts at least */
  budget.sums.work[BUDGET_TIME_STEP] = -1.6;
  assert_false(budget_warn(&budget, .05, 0));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_history_is_integrated),
      cmocka_unit_test(floor_carries_the_weight),
      cmocka_unit_test(a_falling_drop_keeps_its_energy),
      cmocka_unit_test(drag_carries_the_head),
      cmocka_unit_test(gravel_beside_clay_takes_what_the_wall_gives),
      cmocka_unit_test(the_budget_closes_with_everything),
      cmocka_unit_test(threads_keep_one_budget),
      cmocka_unit_test(walls_take_the_force_of_a_slit),
      cmocka_unit_test(a_step_does_what_its_budget_says),
      cmocka_unit_test(samples_change_nothing),
      cmocka_unit_test(work_of_no_equation_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
