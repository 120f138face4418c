/* A channel half of whose width is soil, along which both methods that know soil carry water:
 * stokes on its lattice (soil with pores below the sites) and isph by particles (a porous region),
 * against the exact flow and against each other. Usage: verify_brinkman RESULTS.json [CASE...] */
#include "common/memory.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/stokes/step.h"
#include "tests/verify/isph_rig.h"

#define POROSITY 0.5

/* Water 2 h wide, soil 2 s, along them under F / nu = 1: (Beavers, Joseph 1967; Neale, Nader 1974),
 * viscosity nu / n in soil. */
static double exact(double h, double s, double k) {
  const double slip = sqrt(k * POROSITY) / tanh(s / sqrt(k / POROSITY));
  return (h * h * h / 3 + h * k + slip * h * h + k * s + k * h) / (h + s);
}

/* Permeability in spacing^2, of `sites` of water and as many of soil. */
static double by_stokes(size_t sites, double k) {
  struct lattice l = {.dimensions = 3, .size = {2 * sites, 2, 2}, .spacing = {1, 1, 1}};
  static struct scene scene;
  struct stokes_solver s;
  const double driving[3] = {0, 0, 1};
  l.fluid_count = l.count = 8 * sites;
  l.bulk_count = (double)l.count;
  scene.stokes.kernel = KERNEL_CUBIC;
  if (memory_allocate(&l.kind, l.count, 1, "kind") ||
      memory_allocate(&l.wall_distance, l.count, sizeof(float), "distance") ||
      lattice_soil_allocate(&l))
    give_up();
  for (size_t i = 0; i < l.count; i++) {
    l.kind[i] = SITE_FLUID;
    l.wall_distance[i] = 100;
    if (i % l.size[0] < sites) continue;
    l.micro_porosity[i] = POROSITY;
    l.micro_permeability[i] = (float)k;
  }
  if (stokes_solver_build(&l, &scene, 1.8, WALL_SUBVOXEL, 1, driving, &s) ||
      stokes_solver_run(&s, &(struct stokes_goal){.residual = 1e-6}))
    give_up();
  const double found = s.mean[2];
  stokes_solver_free(&s);
  lattice_free(&l);
  return found;
}

/* What the method's equation says with the soil as the method has it, its edge smeared over 1.7
 * spacings each way: F = a v - (nu v'/eps)' by finite differences between the middles of water and
 * soil, where v' is 0. m^2. */
#define CELLS 4000
static double smeared(const struct isph *s, double width, double force) {
  const double nu = s->kinematic_viscosity, step = width / CELLS;
  static double upper[CELLS], v[CELLS];
  double below = 0, sum = 0; /* nu / eps of a cell's lower face, over step^2 */
  for (int i = 0; i < CELLS; i++) {
    const double middle[3] = {0, 0, 0.5 * width + (i + 0.5) * step};
    const double face[3] = {0, 0, 0.5 * width + (i + 1) * step};
    struct soil_point soil, edge;
    isph_soil_at(s, middle, 0, &soil);
    isph_soil_at(s, face, 0, &edge);
    const double above = i + 1 < CELLS ? nu / edge.porosity / (step * step) : 0;
    double pivot = soil.a + below + above, right = force;
    if (i > 0) pivot -= below * upper[i - 1], right += below * v[i - 1];
    upper[i] = above / pivot, v[i] = right / pivot;
    below = above;
  }
  for (int i = CELLS - 2; i >= 0; i--) v[i] += upper[i] * v[i + 1];
  for (int i = 0; i < CELLS; i++) sum += v[i] * nu / (force * CELLS);
  return sum;
}

/* The same with particles; the water has been at rest, and the flow has come to within 1e-4. */
static double by_isph(int sites, double k, double *error, double *own) {
  struct run run = {0};
  const double width = 0.8e-3, dx = width / sites, force = 0.1, alpha = 1000;
  const double solid = 1 - POROSITY;
  const double grain = sqrt(k * dx * dx * alpha * solid * solid / (POROSITY * POROSITY * POROSITY));
  double v[3];
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"%.9g m\", \"%.9g m\"]; spacing = \"%.9g m\"; periodic = [true, true]; "
      "};\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"%.9g m\", \"%.9g m\"]; },\n"
      "{ type = \"porous\"; box = [\"0\", \"%.9g m\", \"%.9g m\", \"%.9g m\"]; porosity = %g; "
      "grain_size = \"%.9g m\"; alpha = %g; beta = 0.0; } );\n"
      "force = { body_acceleration = [\"%g m/s^2\", \"0\"]; };\n",
      8 * dx, 2 * width, dx, 8 * dx, 2 * width, width, 8 * dx, 2 * width, POROSITY, grain, alpha,
      force);
  advance(&run, 0.8);
  isph_darcy_velocity(&run.s, v);
  *error = run.plan.expected.error;
  *own = smeared(&run.s, width, force) / (dx * dx);
  finish(&run);
  return v[0] * 1e-6 / force / (dx * dx);
}

static void channels(void) {
  static const double k[] = {0.25, 4};
  for (size_t i = 0; i < 4; i++) {
    char name[96];
    double started = clock_seconds(), error, smeared_edge;
    const size_t sites = i < 2 ? 8 : 16;
    /* The same soil on both spacings. */
    const double own = k[i % 2] * (sites == 16 ? 4 : 1), h = 0.5 * (double)sites;
    const double reference = exact(h, h, own), stokes = by_stokes(sites, own);
    snprintf(name, sizeof name, "half-porous channel: stokes, %zu wide, k_micro %g", sites, own);
    const double bound = sites == 16 ? 0.003 : 0.01;
    report(name, reference, stokes, bound * reference, started);
    const double isph = by_isph((int)sites, own, &error, &smeared_edge);
    snprintf(name, sizeof name, "half-porous channel: isph over stokes, %zu wide, k_micro %g",
             sites, own);
    /* Most of what is missing is the soil's edge, smeared over more than the layer that the water
     * drags along (docs/notes/2026-11-23-micropores.md). 8 wide is shown, for the order. */
    if (sites == 16)
      report(name, stokes, isph, hypot(error, bound) * stokes, started);
    else
      show(name, stokes, isph, started);
    snprintf(name, sizeof name, "half-porous channel: isph over its smeared edge, %zu wide, k %g",
             sites, own);
    if (sites == 16)
      report(name, smeared_edge, isph, 0.02 * smeared_edge, started);
    else
      show(name, smeared_edge, isph, started);
  }
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {{"channel", channels}};
  return run_cases(argc, argv, cases, 1);
}
