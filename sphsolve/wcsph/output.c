#include "sphsolve/wcsph/run.h"

#include <math.h>

static double particle_volume(const struct lattice *lattice) {
  return lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2];
}

enum status wcsph_write_row(struct wcsph_run *run, const struct wcsph_totals *totals) {
  const struct lattice *lattice = run->lattice;
  double density = run->scene->fluid.density, mass = density * particle_volume(lattice);
  struct history_row row = {
      .time = wcsph_run_time(run), .step = run->state.step, .dt = run->state.engine.settings.dt};
  for (int a = 0; a < 3; a++) {
    row.darcy_velocity[a] = totals->flux[a] / lattice->bulk_count;
    row.momentum[a] = mass * totals->velocity[a];
  }
  row.density_max = density * totals->density_max;
  row.density_mean = density * totals->density / (double)lattice->fluid_count;
  row.kinetic_energy = 0.5 * mass * totals->square;
  row.mass = mass * (double)lattice->fluid_count;
  row.reynolds = wcsph_reynolds(run, row.darcy_velocity);
  return recorder_row(run->recorder, &row, NULL);
}

/* Fields of a snapshot are filled one at a time, to save memory. */
static enum status fill_points(const void *context, void *data) {
  const struct wcsph_run *run = context;
  const struct engine *engine = &run->state.engine;
  const struct particles *p = &engine->particles;
  double *point = data;
  for (size_t i = engine_first_slot(engine); i < engine_end_slot(engine); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    particles_position(p, run->lattice, i, point);
    point += 3;
  }
  return STATUS_OK;
}
static enum status fill_velocity(const void *context, void *data) {
  const struct engine *engine = &((const struct wcsph_run *)context)->state.engine;
  const struct particles *p = &engine->particles;
  float *velocity = data;
  for (size_t i = engine_first_slot(engine); i < engine_end_slot(engine); i++)
    for (int a = 0; a < 3 && p->id[i] != NO_PARTICLE; a++) *velocity++ = p->v[a][i];
  return STATUS_OK;
}
static enum status fill_pressure(const void *context, void *data) {
  const struct wcsph_run *run = context;
  const struct engine *engine = &run->state.engine;
  double c = engine->settings.sound_speed, unit = run->scene->fluid.density * c * c;
  float *pressure = data;
  for (size_t i = engine_first_slot(engine); i < engine_end_slot(engine); i++)
    if (engine->particles.id[i] != NO_PARTICLE)
      *pressure++ = (float)(unit * engine_pressure(engine, i));
  return STATUS_OK;
}
static enum status fill_density(const void *context, void *data) {
  const struct wcsph_run *run = context;
  const struct engine *engine = &run->state.engine;
  float *density = data;
  for (size_t i = engine_first_slot(engine); i < engine_end_slot(engine); i++)
    if (engine->particles.id[i] != NO_PARTICLE)
      *density++ = (float)(run->scene->fluid.density * engine_density(engine, i));
  return STATUS_OK;
}
static enum status fill_id(const void *context, void *data) {
  const struct engine *engine = &((const struct wcsph_run *)context)->state.engine;
  const struct particles *p = &engine->particles;
  uint32_t *id = data;
  for (size_t i = engine_first_slot(engine); i < engine_end_slot(engine); i++)
    if (p->id[i] != NO_PARTICLE) *id++ = p->id[i];
  return STATUS_OK;
}

enum status wcsph_write_snapshot(struct wcsph_run *run) {
  const struct snapshot_field points = {
      .type = H5_F64, .components = 3, .fill = fill_points, .context = run};
  const struct snapshot_field fields[] = {
      {"velocity", "m/s", "fluid velocity", H5_F32, 3, NULL, fill_velocity, run},
      {"pressure", "Pa", "pressure over that of the fluid at rest", H5_F32, 1, NULL, fill_pressure,
       run},
      {"density", "kg/m^3", "density", H5_F32, 1, NULL, fill_density, run},
      {"id", "1", "site the particle started from", H5_U32, 1, NULL, fill_id, run},
  };
  const struct engine *engine = &run->state.engine;
  size_t count = 0;
  engine_drop_lists(&run->state.engine);
  for (size_t i = engine_first_slot(engine); i < engine_end_slot(engine); i++)
    count += engine->particles.id[i] != NO_PARTICLE;
  return recorder_snapshot(run->recorder, wcsph_run_time(run), run->state.step, count, &points,
                           sizeof fields / sizeof *fields, fields);
}

enum status wcsph_write_checkpoint(struct wcsph_run *run) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  TRY(recorder_checkpoint_begin(run->recorder, &file));
  TRY(wcsph_write_state(&run->state, file));
  struct h5_file *whole = file;
  file = NULL;
  TRY(recorder_checkpoint_commit(run->recorder, whole));
cleanup:
  h5_close(file);
  return status;
}

enum status wcsph_read_checkpoint(struct wcsph_run *run, bool *resumed) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  TRY(recorder_resume(run->recorder, &file));
  *resumed = file != NULL;
  if (file != NULL) TRY(wcsph_read_state(file, &run->state));
cleanup:
  h5_close(file);
  return status;
}
