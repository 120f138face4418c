/* Flows in time of method wcsph against their series solutions, with the settings a scene gets by
 * default.
 *   verify_wcsph [FILE.json]
 * writes a list of case, status, reference, measured, bound, seconds. */
#define _GNU_SOURCE
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/wcsph/plan.h"
#include "tests/verify/rows.h"
#include "sphsolve/scene/scene_read.h"

/* The error is taken over `scale`. */
static void report_over(const char *name, double reference, double measured, double scale,
                        double bound, double seconds) {
  const double error = (measured - reference) / scale;
  rows_write(name, fabs(error) <= bound ? "pass" : "fail", reference, measured, error, bound,
             seconds);
}

struct flow {
  struct scene scene;
  struct lattice lattice;
  struct plan plan;
  struct engine engine;
  double (*region_velocity)[3];
  double time;
};

static void flow_end(struct flow *flow) {
  engine_free(&flow->engine);
  memory_free(&flow->region_velocity);
  lattice_free(&flow->lattice);
  scene_free(&flow->scene);
}

/* A scene's engine, ready to step; the text is freed. */
static enum status flow_start(char *text, struct flow *flow) {
  enum status status = STATUS_OK;
  char path[] = "/tmp/verify_wcsph_XXXXXX";
  const int descriptor = mkstemp(path);
  FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
  memset(flow, 0, sizeof *flow);
  if (!file || !text || fputs(text, file) < 0 || fclose(file) != 0)
    TRY_FAIL(STATUS_RUN, "%s: cannot be written", path);
  TRY(scene_read(path, NULL, 0, &flow->scene));
  TRY(lattice_build(&flow->scene, plan_wall_layers(&flow->scene), &flow->lattice));
  TRY(plan_make(&flow->scene, &flow->lattice, &method_wcsph, "verification", 1, &flow->plan));
  TRY(memory_allocate(&flow->region_velocity, flow->scene.region_count + 1,
                      sizeof *flow->region_velocity, "region velocities"));
  struct engine_settings settings;
  TRY(wcsph_settings(&flow->scene, &flow->plan, flow->region_velocity, &settings));
  TRY(engine_make(&flow->lattice, &settings, &flow->engine));
cleanup:
  if (status != STATUS_OK) {
    log_pending_error();
    error_clear();
    flow_end(flow);
  }
  unlink(path);
  free(text);
  return status;
}

static enum status flow_to(struct flow *flow, double end) {
  while (flow->time < end - 0.5 * flow->plan.dt) {
    const enum status status = engine_step(&flow->engine);
    if (status != STATUS_OK) return status;
    flow->time += flow->plan.dt;
  }
  return STATUS_OK;
}

/* Solves the 3 x 3 system of normal equations by Cramer's rule, first unknown only. */
static double first_unknown(const double s[5], const double r[3]) {
  const double det = s[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (s[1] * s[4] - s[3] * s[2]) +
                     s[2] * (s[1] * s[3] - s[2] * s[2]);
  return (r[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (r[1] * s[4] - s[3] * r[2]) +
          s[2] * (r[1] * s[3] - s[2] * r[2])) /
         det;
}

/* Velocity along x at height z: a parabola through the particles within 2.2 spacings. */
static double velocity_at(const struct flow *flow, double z) {
  const struct particles *p = &flow->engine.particles;
  double s[5] = {0.0}, r[3] = {0.0};
  for (size_t i = 0; i < particles_slots(p); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    double at[3];
    particles_position(p, &flow->lattice, i, at);
    const double y = (at[2] - z) / flow->scene.spacing, v = (double)p->v[0][i];
    if (fabs(y) > 2.2) continue;
    for (int k = 0; k < 5; k++) s[k] += pow(y, k);
    for (int k = 0; k < 3; k++) r[k] += pow(y, k) * v;
  }
  return first_unknown(s, r);
}

static double energy(const struct flow *flow) {
  const struct particles *p = &flow->engine.particles;
  double sum = 0.0;
  for (size_t i = 0; i < particles_slots(p); i++)
    for (int a = 0; a < 3 && p->id[i] != NO_PARTICLE; a++)
      sum += 0.5 * (double)p->v[a][i] * (double)p->v[a][i];
  return sum;
}

#define WIDTH 1e-3
#define NU 1e-6
#define FORCE 1e-4
#define SPEED 1.25e-5
static const char fluid[] =
    "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );\n";

/* Morris, Fox, Zhu 1997: series at z of Poiseuille and Couette flow from rest. */
static double poiseuille(double z, double t) {
  double v = FORCE * z * (WIDTH - z) / (2.0 * NU);
  for (int n = 0; n < 200; n++) {
    const double k = (2 * n + 1) * M_PI / WIDTH;
    v -= 4.0 * FORCE / (NU * WIDTH * k * k * k) * sin(k * z) * exp(-NU * k * k * t);
  }
  return v;
}
static double couette(double z, double t) {
  double v = SPEED * z / WIDTH;
  for (int n = 1; n < 200; n++) {
    const double k = n * M_PI / WIDTH;
    v += 2.0 * SPEED / (n * M_PI) * (n % 2 ? -1.0 : 1.0) * sin(k * z) * exp(-NU * k * k * t);
  }
  return v;
}

/* Flow per depth through a section, m^2/s. */
static double flow_rate(const struct flow *flow) {
  const struct particles *p = &flow->engine.particles;
  const double dx = flow->scene.spacing;
  double sum = 0.0;
  for (size_t i = 0; i < particles_slots(p); i++)
    if (p->id[i] != NO_PARTICLE) sum += (double)p->v[0][i];
  return sum * dx / (double)flow->lattice.size[0];
}

/* Start-up at n particles across. Centre velocities are judged over the steady one. Returns the
 * error that the order is seen in: of the steady flow rate (Poiseuille), where the centre velocity
 * has none left, or the rms of the centre velocities. */
static double start_up(bool wall_moves, enum kernel kernel, int n) {
  static const double times[] = {0.0225, 0.045, 0.1125, 0.225, 1.0};
  const double dx = WIDTH / n, started = clock_seconds();
  struct flow flow;
  char *text = NULL;
  const char *name = wall_moves                  ? "Couette"
                     : kernel == KERNEL_WENDLAND ? "Poiseuille, Wendland,"
                                                 : "Poiseuille";
  const int length =
      wall_moves
          ? asprintf(
                &text,
                "scene = { name = \"couette\"; method = \"wcsph\"; end_time = \"1 s\"; };\n"
                "domain = { size = [\"%.17g m\", \"%.17g m\"]; spacing = \"%.17g m\"; periodic "
                "= [true, false]; };\n%s"
                "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"%.17g m\", \"%.17g m\"]; "
                "}, { type = \"wall\"; box = [\"0\", \"%.17g m\", \"%.17g m\", \"%.17g m\"]; "
                "velocity = [\"%.17g m/s\", \"0\"]; } );\n"
                "output = { history_interval = \"0.0225 s\"; };\n",
                6 * dx, WIDTH + 4 * dx, dx, fluid, 6 * dx, WIDTH, WIDTH, 6 * dx, WIDTH + 4 * dx,
                SPEED)
          : asprintf(
                &text,
                "scene = { name = \"poiseuille\"; method = \"wcsph\"; end_time = \"1 s\"; };\n"
                "domain = { size = [\"%.17g m\", \"%.17g m\"]; spacing = \"%.17g m\"; periodic "
                "= [true, false]; };\n%s"
                "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"%.17g m\", \"%.17g m\"]; "
                "} );\n"
                "force = { body_acceleration = [\"%.17g m/s^2\", \"0\"]; };\n"
                "output = { history_interval = \"0.0225 s\"; };\n"
                "wcsph = { kernel = \"%s\"; };\n",
                6 * dx, WIDTH, dx, fluid, 6 * dx, WIDTH, FORCE, kernel_names[kernel]);
  if (length < 0 || flow_start(text, &flow) != STATUS_OK) return NAN;
  const double height = 0.5 * WIDTH;
  double square = 0.0, last = 1.0;
  for (int i = 0; i < 5; i++) {
    if (flow_to(&flow, times[i]) != STATUS_OK) {
      log_pending_error();
      error_clear();
      square = NAN;
      break;
    }
    const double exact = wall_moves ? couette(height, flow.time) : poiseuille(height, flow.time);
    const double measured = velocity_at(&flow, height);
    char title[96];
    snprintf(title, sizeof title, "%s start-up, t = %g s, %d across", name, times[i], n);
    const double steady = wall_moves ? couette(height, 100.0) : poiseuille(height, 100.0);
    if (n == 16) report_over(title, exact, measured, steady, 0.01, clock_seconds() - started);
    square += (measured - exact) * (measured - exact) / 5.0;
    last = exact;
  }
  const double rate = flow_rate(&flow) / (FORCE * WIDTH * WIDTH * WIDTH / (12.0 * NU)) - 1.0;
  flow_end(&flow);
  return wall_moves ? sqrt(square) / last : fabs(rate);
}

static void start_ups(bool wall_moves, enum kernel kernel) {
  const double started = clock_seconds(),
               error[3] = {start_up(wall_moves, kernel, 8), start_up(wall_moves, kernel, 16),
                           start_up(wall_moves, kernel, 32)};
  char title[96];
  const double order = 0.5 * log2(error[0] / error[2]);
  printf("  errors at 8, 16, 32 across: %.3g, %.3g, %.3g %%; order %.2f\n", 100 * error[0],
         100 * error[1], 100 * error[2], order);
  snprintf(title, sizeof title, "%s start-up, observed order (8 to 32)",
           wall_moves                  ? "Couette"
           : kernel == KERNEL_WENDLAND ? "Poiseuille, Wendland,"
                                       : "Poiseuille");
  report(title, 2.0, order, 0.25, clock_seconds() - started);
}

/* Taylor-Green vortices of speed 1 in the unit box: every site its own region of water. */
static double vortices(int n, double reynolds, double end) {
  char *text = NULL;
  size_t size;
  struct flow flow;
  FILE *stream = open_memstream(&text, &size);
  if (!stream) return NAN;
  fprintf(
      stream,
      "scene = { name = \"vortices\"; method = \"wcsph\"; end_time = \"%g s\"; };\n"
      "domain = { size = [\"1 m\", \"1 m\"]; spacing = \"%.17g m\"; periodic = [true, true]; };\n"
      "fluids = ( { density = \"1 kg/m^3\"; viscosity = \"%.17g Pa s\"; } );\nregions = (",
      end, 1.0 / n, 1.0 / reynolds);
  for (int k = 0; k < n; k++)
    for (int i = 0; i < n; i++) {
      const double x = 2 * M_PI * (i + 0.5) / n, z = 2 * M_PI * (k + 0.5) / n;
      fprintf(stream,
              "%s { type = \"water\"; box = [\"%.17g m\", \"%.17g m\", \"%.17g m\", \"%.17g m\"]; "
              "velocity = [\"%.9g m/s\", \"%.9g m/s\"]; }",
              i + k ? "," : "", (double)i / n, (double)k / n, (i + 1.0) / n, (k + 1.0) / n,
              -cos(x) * sin(z), sin(x) * cos(z));
    }
  fputs(" );\n", stream);
  fclose(stream);
  if (flow_start(text, &flow) != STATUS_OK) return NAN;
  /* The pressure that goes with the velocities, or sound would ring. */
  struct particles *p = &flow.engine.particles;
  const double c = flow.engine.settings.sound_speed;
  for (size_t i = 0; i < particles_slots(p); i++) {
    double at[3];
    if (p->id[i] == NO_PARTICLE) continue;
    particles_position(p, &flow.lattice, i, at);
    p->state[i] = (float)(-0.25 * (cos(4 * M_PI * at[0]) + cos(4 * M_PI * at[2])) / (c * c));
  }
  flow.engine.speed_max = 1.0;
  const double start = energy(&flow);
  double ratio = NAN;
  if (flow_to(&flow, end) == STATUS_OK)
    ratio = energy(&flow) / start / exp(-16 * M_PI * M_PI / reynolds * flow.time);
  flow_end(&flow);
  return ratio;
}

static void taylor_green(void) {
  static const double reynolds[] = {100.0, 1000.0};
  for (int r = 0; r < 2; r++) {
    char title[96];
    double started = clock_seconds();
    const double coarse = vortices(25, reynolds[r], 1.0), middle = clock_seconds();
    const double fine = vortices(50, reynolds[r], 1.0);
    snprintf(title, sizeof title, "Taylor-Green, Re %g, energy at t = 1, 50 x 50", reynolds[r]);
    report(title, 1.0, fine, 0.02, clock_seconds() - middle);
    const double order = log2(fabs(coarse - 1.0) / fabs(fine - 1.0));
    printf("  energy over the exact one %.4f (25), %.4f (50); order %.2f\n", coarse, fine, order);
    snprintf(title, sizeof title, "Taylor-Green, Re %g, order (at least 1)", reynolds[r]);
    rows_write(title, order >= 1.0 ? "pass" : "fail", 1.0, order, order - 1.0, 0.0,
               clock_seconds() - started);
  }
}

int main(int argc, char **argv) {
  omp_set_num_threads(1);
  rows_open(argc > 1 ? argv[1] : "wcsph.json");
  start_ups(false, KERNEL_QUINTIC);
  start_ups(false, KERNEL_WENDLAND);
  start_ups(true, KERNEL_QUINTIC);
  taylor_green();
  return rows_close();
}
