#include "sphsolve/scene/scene_compare.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"

static void put(FILE *stream, const char *name, const double *values, int count) {
  fprintf(stream, "%s =", name);
  for (int i = 0; i < count; i++) fprintf(stream, " %.12g", values[i]);
  fputc('\n', stream);
}

static void put_number(FILE *stream, const char *name, double value) {
  put(stream, name, &value, 1);
}

/* `part`: index among the boxes of a polygon or body. */
static void put_region(FILE *stream, const struct region *r, size_t part) {
  fprintf(stream, "regions[%zu]", r->number);
  if (part > 0) fprintf(stream, ".part[%zu]", part);
  fprintf(stream, " = type %d,", (int)r->type);
  const double values[] = {r->porosity,
                           r->grain_size,
                           r->alpha,
                           r->beta,
                           r->soil_velocity[0],
                           r->soil_velocity[1],
                           r->soil_velocity[2],
                           r->velocity[0],
                           r->velocity[1],
                           r->velocity[2],
                           r->head,
                           r->flux,
                           r->rate};
  for (int i = 0; i < 6; i++) fprintf(stream, " %.12g", r->box[i]);
  for (size_t i = 0; i < sizeof values / sizeof *values; i++) fprintf(stream, " %.12g", values[i]);
  for (int i = 0; i < 6 && r->anisotropic; i++) fprintf(stream, " %.12g", r->anisotropy[i]);
  const struct retention_curve *v = &r->retention;
  if (v->given)
    fprintf(stream, " %.12g %.12g %.12g %.12g %.12g %d %.12g", r->permeability, v->alpha, v->n,
            v->theta_r, v->l, (int)v->starts_by, v->start);
  if (v->k_n > 0) fprintf(stream, " %.12g %.12g", v->k_alpha, v->k_n);
  if (v->exponential) fprintf(stream, " gardner");
  if (r->radiates) fprintf(stream, " radiates");
  if (r->ponding > 0) fprintf(stream, " ponding %.12g", r->ponding);
  fprintf(stream, " %d %d %d %s", r->saturated - r->dry, r->slip, (int)r->boundary, r->name);
  for (size_t i = 0; i < r->table.count; i++)
    fprintf(stream, " %.12g: %.12g %.12g %.12g,", r->table.time[i], r->table.value[i][0],
            r->table.value[i][1], r->table.value[i][2]);
  fputc('\n', stream);
}

static void put_solute(FILE *stream, const struct scene *s) {
  put_number(stream, "solute.diffusion (m^2/s)", s->solute.diffusion);
  put_number(stream, "solute.length (m)", s->solute.length);
  put_number(stream, "--error", s->solute.error);
  fprintf(stream, "solute.way = %s\nsolute.peclet =", solute_way_names[s->solute.way]);
  for (int i = 0; i < s->solute.peclet_count; i++) fprintf(stream, " %.12g", s->solute.peclet[i]);
  fputc('\n', stream);
}

static void put_all(FILE *stream, const struct scene *s) {
  put_number(stream, "~scene.end_time", s->end_time);
  put_number(stream, "~scene.steady_tolerance", s->steady_tolerance);
  put_number(stream, "~output.interval", s->output_interval);
  put_number(stream, "~output.history_interval", s->history_interval);
  put_number(stream, "~checkpoint.interval", s->checkpoint_interval);
  put_number(stream, "~wcsph.dt", s->wcsph.dt);
  put_number(stream, "~isph.dt", s->isph.dt);
  put_number(stream, "~isph.tolerance", s->isph.tolerance);
  put_number(stream, "~stokes.tolerance", s->stokes.tolerance);
  put(stream, "domain.size (m)", s->domain_size, 3);
  put_number(stream, "domain.spacing (m)", s->spacing);
  put_number(stream, "lattice.spacing (m)", s->lattice_spacing);
  fprintf(stream, "domain.periodic = %d %d %d\n", s->periodic[0], s->periodic[1], s->periodic[2]);
  put_number(stream, "fluids.density (kg/m^3)", s->fluid.density);
  put_number(stream, "fluids.viscosity (Pa s)", s->fluid.viscosity);
  put_number(stream, "fluids.surface_tension (N/m)", s->fluid.surface_tension);
  for (size_t i = 0, part = 0; i < s->region_count; i++) {
    part = i > 0 && s->regions[i].number == s->regions[i - 1].number ? part + 1 : 0;
    put_region(stream, &s->regions[i], part);
  }
  put(stream, "force.gravity (m/s^2)", s->gravity, 3);
  put(stream, "force.body_acceleration (m/s^2)", s->body_acceleration, 3);
  put(stream, "force.pressure_gradient (Pa/m)", s->pressure_gradient, 3);
  put_number(stream, "force.hydraulic_gradient", s->hydraulic_gradient);
  for (size_t i = 0; i < s->gauge_count; i++)
    fprintf(stream, "gauges[%zu] = %s %.12g %.12g %.12g\n", i, s->gauges[i].name,
            s->gauges[i].at[0], s->gauges[i].at[1], s->gauges[i].at[2]);
  for (size_t i = 0; i < s->plane_count; i++)
    fprintf(stream, "planes[%zu] = %s %c %.12g\n", i, s->planes[i].name, 'x' + s->planes[i].axis,
            s->planes[i].position);
  put_number(stream, "wcsph.sound_speed (m/s)", s->wcsph.sound_speed);
  put_number(stream, "wcsph.support (m)", s->wcsph.support);
  fprintf(stream, "wcsph.equation_of_state = %d\nwcsph.kernel = %d\nwcsph.wall = %s\n",
          (int)s->wcsph.equation_of_state, (int)s->wcsph.kernel, wall_scheme_names[s->wcsph.wall]);
  put_number(stream, "stokes.support (m)", s->stokes.support);
  fprintf(stream, "stokes.kernel = %d\nstokes.wall = %s\n", (int)s->stokes.kernel,
          wall_scheme_names[s->stokes.wall]);
  put_number(stream, "isph.support_ratio", s->isph.support_ratio);
  put_number(stream, "isph.tau (s)", s->isph.relaxation_time);
  put_number(stream, "isph.alpha", s->isph.alpha);
  put_number(stream, "isph.smagorinsky", s->isph.smagorinsky);
  fprintf(stream, "isph.form = %d\nisph.kernel = %d\nisph.wall.slip = %d\nisph.porosity = %d\n",
          (int)s->isph.form, (int)s->isph.kernel, s->isph.slip, s->isph.porosity_paper);
  fprintf(stream, "effects.turbulence = %d\neffects.shifting = %d\n", (int)s->turbulence,
          (int)s->shifting);
}

enum status scene_describe(const struct scene *scene, char **text) {
  size_t size = 0;
  FILE *stream = open_memstream(text, &size);
  if (stream == NULL) return FAIL(STATUS_RUN, "out of memory for the scene's settings");
  if (*scene->flow_path)
    put_solute(stream, scene);
  else
    put_all(stream, scene);
  if (fclose(stream) != 0) return FAIL(STATUS_RUN, "out of memory for the scene's settings");
  return STATUS_OK;
}

/* Value in the line of `text` with the same name as `line`, i.e. the same text up to " = "; NULL if
 * there is none. */
static const char *value_in(const char *text, const char *line, size_t *length) {
  const char *equals = strstr(line, " = ");
  const size_t name = equals != NULL ? (size_t)(equals - line) + 3 : strcspn(line, "\n");
  for (const char *at = text; *at; at += strcspn(at, "\n"), at += *at == '\n')
    if (strncmp(at, line, name) == 0) {
      *length = strcspn(at + name, "\n");
      return at + name;
    }
  *length = 0;
  return NULL;
}

static enum status compare_line(const char *line, const char *other, const char *path,
                                bool swapped) {
  size_t length, before;
  const bool may = *line == '~';
  const char *value = value_in(line, line, &length), *was = value_in(other, line, &before);
  if (was != NULL &&
      (swapped || (value != NULL && length == before && strncmp(value, was, length) == 0)))
    return STATUS_OK;
  const int name = (int)strcspn(line + may, "=") - 1;
  const char *then = swapped ? value : was != NULL ? was : "not there";
  const char *now = swapped ? "not there" : value;
  const int then_length = swapped ? (int)length : was != NULL ? (int)before : 9;
  const int now_length = swapped ? 9 : (int)length;
  if (may) {
    log_info("--resume: goes on with %.*s = %.*s (%.*s before)", name, line + may, now_length, now,
             then_length, then);
    return STATUS_OK;
  }
  return FAIL(
      STATUS_INPUT,
      "%s: the scene has changed since: %.*s was %.*s and is %.*s; take that back, or leave "
      "out --resume to start anew",
      path, name, line, then_length, then, now_length, now);
}

enum status scene_compare(const char *then, const char *now, const char *path) {
  enum status status = STATUS_OK;
  for (const char *at = now; *at; at += strcspn(at, "\n"), at += *at == '\n')
    TRY(compare_line(at, then, path, false));
  for (const char *at = then; *at; at += strcspn(at, "\n"), at += *at == '\n')
    TRY(compare_line(at, now, path, true));
cleanup:
  return status;
}
