/* Edges of soil. A channel half of whose width is soil, along which both methods that know soil
 * carry water: stokes on its lattice (soil with pores below the sites) and isph by particles (a
 * porous region), against the exact flow and against each other. And by isph through thin layers.
 * Usage: verify_brinkman RESULTS.json [CASE...] */
#include "common/memory.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/stokes/solver/step.h"
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

/* The same with particles; the water has been at rest, and the flow has come to within 1e-4. */
static double by_isph(int sites, double k) {
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
  finish(&run);
  return v[0] * 1e-6 / force / (dx * dx);
}

static void channels(void) {
  static const double k[] = {0.25, 4};
  for (size_t i = 0; i < 4; i++) {
    char name[96];
    const double started = clock_seconds();
    const size_t sites = i < 2 ? 8 : 16;
    /* The same soil on both spacings. */
    const double own = k[i % 2] * (sites == 16 ? 4 : 1), h = 0.5 * (double)sites;
    const double reference = exact(h, h, own), stokes = by_stokes(sites, own);
    snprintf(name, sizeof name, "half-porous channel: stokes, %zu wide, k_micro %g", sites, own);
    const double bound = sites == 16 ? 0.003 : 0.01;
    report(name, reference, stokes, bound * reference, started);
    const double isph = by_isph((int)sites, own);
    snprintf(name, sizeof name, "half-porous channel: isph over stokes, %zu wide, k_micro %g",
             sites, own);
    if (sites == 16)
      report(name, stokes, isph, 0.01 * stokes, started);
    else
      show(name, stokes, isph, started); /* for the order */
  }
}

/* A layer of soil, porosity .3 and grains of 5 mm, `thick` spacings of dx across the flow of a
 * periodic box whose rest is water: the force acts on all of the box, length L, and drag on the
 * layer, g L = (a v + b v^2) T. While three rows of particles enter it. */
static double through_layer(int thick, double dx, double length) {
  struct run run = {0};
  const double depth = thick * dx, low = dx * floor(0.5 * (length - depth) / dx + 1e-9), f = 9.81,
               eps = 0.3, grain = 5e-3;
  const double a = 1e-3 * pow(1 - eps, 2) / (pow(eps, 3) * grain * grain);
  const double b = 1.1 * (1 - eps) / (pow(eps, 3) * grain), drive = f * length / depth;
  const double exact = 2 * drive / (a + sqrt(a * a + 4 * b * drive));
  double v[3], sum = 0, time = 0;
  start(
      &run,
      "scene = { method = \"isph\"; end_time = \"10 s\"; };\n"
      "domain = { size = [\"%.9g m\", \"%.9g m\"]; spacing = \"%.9g m\"; periodic = [true, true]; "
      "};\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"%.9g m\", \"%.9g m\"]; },\n"
      "{ type = \"porous\"; box = [\"0\", \"%.9g m\", \"%.9g m\", \"%.9g m\"]; porosity = %g; "
      "grain_size = \"%.9g m\"; } );\n"
      "force = { gravity = [\"0\", \"-%g m/s^2\"]; };\n",
      8 * dx, length, dx, 8 * dx, length, low, 8 * dx, low + depth, eps, grain, f);
  advance(&run, 0.5 + dx / exact);
  for (int part = 1; part <= 200; part++) {
    const double before = run.s.time;
    advance(&run, 0.5 + (1 + 0.01 * part) * dx / exact);
    isph_darcy_velocity(&run.s, v);
    sum -= v[2] * (run.s.time - before), time += run.s.time - before;
  }
  finish(&run);
  return sum / time / exact;
}

static void layers(void) {
  static const struct {
    int thick;
    double dx;
  } table[] = {{1, .01}, {2, .01}, {3, .01}, {4, .01}, {6, .01}, {5, .01}, {10, .005}};
  for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
    const double started = clock_seconds();
    const double found = through_layer(table[i].thick, table[i].dx, .1);
    char name[96];
    snprintf(name, sizeof name, "layer of soil across the flow, %d spacings of %g mm",
             table[i].thick, 1e3 * table[i].dx);
    if (table[i].thick >= 5)
      report(name, 1, found, .02, started);
    else
      show(name, 1, found, started);
  }
}

int main(int argc, char **argv) {
  static const struct verify_case cases[] = {{"channel", channels}, {"layers", layers}};
  return run_cases(argc, argv, cases, 2);
}
