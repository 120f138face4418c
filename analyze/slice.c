/* Velocity vectors and grains in a slab perpendicular to an axis. */
#include <math.h>

#include <string.h>

#include "analyze/analysis.h"
#include "analyze/compatible_runs.h"
#include "analyze/plot.h"
#include "common/memory.h"
#include "common/statistics.h"

struct slice_request {
  int axis;         /* normal of the plane: 0 x, 1 y, 2 z; -1: x, or y in two dimensions */
  double position;  /* m, middle of the slab; NAN: middle of the run */
  double thickness; /* m; NAN: one spacing */
  double vectors;   /* most vectors along the longer side */
  bool zoomed;
  double zoom[4]; /* m: lower and upper corner in the other two axes, (y, z), (x, z) or (x, y) */
};

struct window {
  int axis, across, up;     /* normal; horizontal; vertical */
  double middle, thickness; /* of the slab, m */
  double low[2], high[2];   /* across, up; m */
  double cell;              /* edge of the cells over which velocities are averaged, m */
  size_t cells[2];
};

/* Factor from m to the unit of the axes: mm for grains, m for tanks and soil. */
static double unit_of(const struct window *w) {
  return fmax(w->high[0] - w->low[0], w->high[1] - w->low[1]) < 1.0 ? 1e3 : 1.0;
}

/* Extent of the run: half a spacing beyond the outermost sites. */
static double extent_low(const struct run *run, int d) {
  return run->origin[d] - 0.5 * run->spacing[d];
}
static double extent_high(const struct run *run, int d) {
  return run->origin[d] + ((double)run->size[d] - 0.5) * run->spacing[d];
}

static enum status choose_window(const struct run *run, const struct slice_request *request,
                                 struct window *w) {
  static const char axes[] = "xyz";
  w->axis = request->axis >= 0 ? request->axis : run->dimensions == 2 ? 1 : 0;
  w->across = w->axis == 0 ? 1 : 0;
  w->up = w->axis == 2 ? 1 : 2;
  double low = extent_low(run, w->axis), high = extent_high(run, w->axis);
  /* By default the middle layer of sites: a plane between two layers would show the grains of one
   * layer and the particles of the other. */
  const size_t layer = run->size[w->axis] / 2;
  w->middle = isfinite(request->position)
                  ? request->position
                  : run->origin[w->axis] + (double)layer * run->spacing[w->axis];
  w->thickness = isfinite(request->thickness) ? request->thickness : run->spacing[w->axis];
  if (w->middle < low || w->middle > high)
    return FAIL(STATUS_USAGE, "--plane: %c = %g m lies outside the run, which spans %g to %g m",
                axes[w->axis], w->middle, low, high);
  if (!(w->thickness > 0.0)) return FAIL(STATUS_USAGE, "--thickness: must be positive");
  for (int i = 0; i < 2; i++) {
    int d = i == 0 ? w->across : w->up;
    w->low[i] = request->zoomed ? request->zoom[i] : extent_low(run, d);
    w->high[i] = request->zoomed ? request->zoom[2 + i] : extent_high(run, d);
    if (!(w->high[i] > w->low[i]))
      return FAIL(STATUS_USAGE, "--zoom: the high corner must lie beyond the low one (in %c)",
                  axes[d]);
    if (w->high[i] <= extent_low(run, d) || w->low[i] >= extent_high(run, d))
      return FAIL(STATUS_USAGE, "--zoom: the window lies outside the run in %c (%g to %g m)",
                  axes[d], extent_low(run, d), extent_high(run, d));
  }
  double longest = fmax(w->high[0] - w->low[0], w->high[1] - w->low[1]);
  w->cell = fmax(fmax(run->spacing[w->across], run->spacing[w->up]), longest / request->vectors);
  for (int i = 0; i < 2; i++) w->cells[i] = (size_t)ceil((w->high[i] - w->low[i]) / w->cell - 1e-9);
  return STATUS_OK;
}

/* Sums over a cell: count, position (2), velocity (2). The speed is that of the mean velocity in
 * the plane. */
struct cell {
  double count, at[2], velocity[2];
};

static enum status fill_cells(const struct particles *particles, const struct window *w,
                              struct cell **cells) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(cells, w->cells[0] * w->cells[1], sizeof **cells, "cells of the slice"));
  for (size_t i = 0; i < particles->count; i++) {
    const double *x = &particles->points[3 * i], *v = &particles->velocity[3 * i];
    if (fabs(x[w->axis] - w->middle) > 0.5 * w->thickness * (1.0 + 1e-9)) continue;
    double a = (x[w->across] - w->low[0]) / w->cell, b = (x[w->up] - w->low[1]) / w->cell;
    if (a < 0 || b < 0 || a >= (double)w->cells[0] || b >= (double)w->cells[1]) continue;
    struct cell *cell = &(*cells)[(size_t)b * w->cells[0] + (size_t)a];
    cell->count += 1.0;
    cell->at[0] += x[w->across];
    cell->at[1] += x[w->up];
    cell->velocity[0] += v[w->across];
    cell->velocity[1] += v[w->up];
  }
cleanup:
  return status;
}

/* Share of grain in the layers of the slab (at least the layer nearest to the plane), as (across,
 * up, share) for `with rgbimage`. */
static void write_grains(const struct run *run, const struct window *w, FILE *stream) {
  const size_t stride[3] = {1, run->size[0], run->size[0] * run->size[1]};
  const double last = (double)run->size[w->axis] - 1.0, spacing = run->spacing[w->axis];
  double at = (w->middle - run->origin[w->axis]) / spacing, half = 0.5 * w->thickness / spacing;
  const double unit = unit_of(w);
  size_t first = (size_t)fmin(fmax(ceil(at - half), 0.0), last);
  size_t end = (size_t)fmin(fmax(floor(at + half), 0.0), last);
  if (end < first) first = end = (size_t)fmin(fmax(round(at), 0.0), last);
  fputs("$grains << EOD\n", stream);
  for (size_t j = 0; j < run->size[w->up]; j++) {
    for (size_t i = 0; i < run->size[w->across]; i++) {
      size_t site = j * stride[w->up] + i * stride[w->across], solid = 0;
      for (size_t k = first; run->solid != NULL && k <= end; k++)
        solid += run->solid[site + k * stride[w->axis]] != 0;
      fprintf(stream, "%.7g %.7g %.3g\n",
              unit * (run->origin[w->across] + (double)i * run->spacing[w->across]),
              unit * (run->origin[w->up] + (double)j * run->spacing[w->up]),
              (double)solid / (double)(end - first + 1));
    }
  }
  fputs("EOD\n", stream);
}

static void write_plot(const struct run *run, const struct window *w, const struct cell *cells,
                       struct product *product) {
  static const char axes[] = "xyz";
  FILE *stream = product->plot.stream;
  size_t n = w->cells[0] * w->cells[1];
  double *speeds = NULL;
  double fast = 0.0;
  size_t count = 0;
  /* Arrows are scaled by the 98th percentile, so that a single jet does not shrink all others. */
  if (memory_allocate(&speeds, n, sizeof *speeds, "speeds") == STATUS_OK) {
    for (size_t i = 0; i < n; i++)
      if (cells[i].count > 0)
        speeds[count++] = hypot(cells[i].velocity[0], cells[i].velocity[1]) / cells[i].count;
    fast = count > 0 ? quantile(speeds, count, 0.98) : 0.0;
  } else
    error_clear();
  memory_free(&speeds);
  double scale = fast > 0 ? 1.3 * w->cell / fast : 0.0;
  const double unit = unit_of(w), pace = fast >= 1.0 ? 1.0 : 1e3; /* m or mm, m/s or mm/s */

  write_grains(run, w, stream);
  fputs("$vectors << EOD\n", stream); /* x y dx dy, speed */
  for (size_t i = 0; i < n; i++) {
    const struct cell *c = &cells[i];
    if (c->count == 0) continue;
    double v[2] = {c->velocity[0] / c->count, c->velocity[1] / c->count};
    double speed = hypot(v[0], v[1]), longest = fmax(speed / fmax(fast, 1e-300), 1.0);
    double d[2] = {v[0] * scale / longest, v[1] * scale / longest};
    fprintf(stream, "%.6g %.6g %.5g %.5g %.5g\n", unit * (c->at[0] / c->count - 0.5 * d[0]),
            unit * (c->at[1] / c->count - 0.5 * d[1]), unit * d[0], unit * d[1], pace * speed);
  }
  fputs("EOD\n", stream);
  double width = w->high[0] - w->low[0], height = w->high[1] - w->low[1];
  double pixels = 440.0 / fmax(width, height);
  /* Space for axis labels (90, 75 pixels) and the colour bar (130). */
  double across = width * pixels, up = height * pixels;
  product->width = (int)fmax(across, 160.0) + 240;
  product->height = (int)fmax(up, 160.0) + 95;
  double x = 90.0 / product->width, y = 75.0 / product->height;
  double dx = across / product->width, dy = up / product->height;
  fprintf(stream,
          "set xlabel '{/:Italic %c} (%s)'\nset ylabel '{/:Italic %c} (%s)'\n"
          "set size ratio %.8g\nset xrange [%.8g:%.8g]\nset yrange [%.8g:%.8g]\n",
          axes[w->across], unit < 2 ? "m" : "mm", axes[w->up], unit < 2 ? "m" : "mm",
          height / width, unit * w->low[0], unit * w->high[0], unit * w->low[1], unit * w->high[1]);
  if (across < 300.0)
    fprintf(stream, "set xtics %.1g\n", 0.5 * unit * width); /* few, so that they do not overlap */
  if (up < 200.0) fprintf(stream, "set ytics %.1g\n", 0.5 * unit * height);
  fprintf(stream,
          "unset grid\nunset key\nset tics out nomirror\n"
          "set lmargin at screen %.4f\nset rmargin at screen %.4f\n"
          "set bmargin at screen %.4f\nset tmargin at screen %.4f\n"
          "set palette defined (0 '#fdb42f', 0.25 '#ed7953', 0.5 '#cc4778', 0.75 '#9c179e', "
          "1 '#0d0887')\n"
          "set cblabel 'Speed in the plane (%s)' offset 1.6,0\nset cbrange [0:%.5g]\n"
          "set colorbox user origin screen %.4f, screen %.4f size screen %.4f, screen %.4f\n"
          "grain(v) = int(255 - 60*v)*65536 + int(255 - 66*v)*256 + int(255 - 77*v)\n"
          "plot $grains using 1:2:(grain($3)) with rgbimage, \\\n"
          "  $vectors using 1:2:3:4:5 with vectors head noborder size screen %.4f,18 "
          "linewidth 1.2 linecolor palette\n",
          x, x + dx, y, y + dy, pace < 2 ? "m/s" : "mm/s", fast > 0 ? pace * fast : 1.0,
          x + dx + 20.0 / product->width, y, 20.0 / product->width, dy,
          0.45 * w->cell * pixels / product->width);
}

static enum status parse_plane(const struct options *options, struct slice_request *request) {
  const char *plane = options_text(options, "plane");
  if (plane == NULL) return STATUS_OK;
  if (plane[0] < 'x' || plane[0] > 'z' || plane[1] != '=')
    return FAIL(STATUS_USAGE, "--plane %s: give an axis and a place, such as x=1.4mm", plane);
  request->axis = plane[0] - 'x';
  enum status status = quantity_parse(plane + 2, DIM_LENGTH, &request->position);
  if (status != STATUS_OK) error_context(STATUS_USAGE, "--plane");
  return status == STATUS_OK ? STATUS_OK : STATUS_USAGE;
}

static enum status parse_zoom(const struct options *options, struct slice_request *request) {
  const char *zoom = options_text(options, "zoom");
  if (zoom == NULL) return STATUS_OK;
  for (int i = 0; i < 4; i++) {
    char part[64];
    size_t length = strcspn(zoom, ",");
    if (length >= sizeof part || (i < 3) != (zoom[length] == ','))
      return FAIL(STATUS_USAGE, "--zoom: give four lengths, such as 0.5mm,0.5mm,1mm,1mm");
    memcpy(part, zoom, length);
    part[length] = '\0';
    if (quantity_parse(part, DIM_LENGTH, &request->zoom[i]) != STATUS_OK)
      return error_context(STATUS_USAGE, "--zoom");
    zoom += length + (i < 3);
  }
  request->zoomed = true;
  return STATUS_OK;
}

/* Velocities are averaged over cells, so that at most `vectors` are along an axis. The report draws
 * maps of its own. */
static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  enum status status = STATUS_OK;
  const struct run *run = &subject->runs[0];
  struct slice_request request = {.axis = -1, .position = NAN, .thickness = NAN, .vectors = 60.0};
  static const char axes[] = "xyz";
  struct particles particles = {0};
  struct cell *cells = NULL;
  struct window w = {0};
  size_t vectors = 0;
  double fastest = 0.0, mean = 0.0;
  if (options != NULL) {
    TRY(parse_plane(options, &request));
    TRY(parse_zoom(options, &request));
    TRY(options_quantity(options, "thickness", DIM_LENGTH, &request.thickness));
  }
  TRY(choose_window(run, &request, &w));
  TRY(run_last_snapshot(run, &particles));
  TRY(fill_cells(&particles, &w, &cells));
  fprintf(product->csv.stream, "%c_m,%c_m,velocity_%c_m_per_s,velocity_%c_m_per_s,particles\n",
          axes[w.across], axes[w.up], axes[w.across], axes[w.up]);
  for (size_t i = 0; i < w.cells[0] * w.cells[1]; i++) {
    const struct cell *c = &cells[i];
    if (c->count == 0) continue;
    double v[2] = {c->velocity[0] / c->count, c->velocity[1] / c->count};
    fprintf(product->csv.stream, "%.8g,%.8g,%.8g,%.8g,%.0f\n", c->at[0] / c->count,
            c->at[1] / c->count, v[0], v[1], c->count);
    vectors++;
    fastest = fmax(fastest, hypot(v[0], v[1]));
    mean += hypot(v[0], v[1]);
  }
  if (vectors == 0)
    TRY_FAIL(STATUS_INPUT,
             "%s: no particle lies in the slab %c = %g m +- %g m; choose another --plane or a "
             "larger --thickness (the spacing is %g m)",
             run->path, axes[w.axis], w.middle, 0.5 * w.thickness, run->spacing[w.axis]);
  mean /= (double)vectors;
  json_object_set_new(product->json, "path", json_text(run->path));
  json_object_set_new(product->json, "name", json_text(run->name));
  json_object_set_new(product->json, "time_s", json_number(particles.time));
  json_object_set_new(product->json, "axis", json_stringn(&axes[w.axis], 1));
  json_object_set_new(product->json, "position_m", json_number(w.middle));
  json_object_set_new(product->json, "thickness_m", json_number(w.thickness));
  json_object_set_new(product->json, "cell_m", json_number(w.cell));
  json_object_set_new(product->json, "vectors", json_integer((json_int_t)vectors));
  json_object_set_new(product->json, "speed_mean_m_per_s", json_number(mean));
  json_object_set_new(product->json, "speed_max_m_per_s", json_number(fastest));
  fprintf(product->summary.stream,
          "%s: slab %c = %.6g m, %.4g m thick, at t = %.5g s\n  %zu vectors (means over cells of "
          "%.3g m), speed in the plane: mean %.4g, largest %.4g m/s\n",
          run->name, axes[w.axis], w.middle, w.thickness, particles.time, vectors, w.cell, mean,
          fastest);
  json_object_set_new(product->json, "k_of_velocities_m_per_s", json_number(lattice_note_k(run)));
  lattice_note_write(run, "  ", "\n", product->summary.stream);
  write_plot(run, &w, cells, product);
cleanup:
  particles_free(&particles);
  memory_free(&cells);
  return status;
}

static enum status applies(const struct subject *subject, bool *applies) {
  *applies = subject->snapshots && (subject->flowing > 0 || subject->permeable == 0);
  return STATUS_OK;
}

const struct analysis slice_analysis = {
    .name = "slice",
    .command = {"slice", "RUN [--plane x=Q] [--thickness Q] [--zoom Y0,Z0,Y1,Z1] [-o DIR]",
                "velocity vectors over the grains in a slab",
                "analyze slice dense-1G.hdf --plane x=1.4mm --thickness 0.2mm -o results", 1, 1},
    .options = {{"plane", 0, "AXIS=Q", 0, "where: x=1.4mm, y=0.2mm, ... (the middle, across x)"},
                {"thickness", 0, "Q", 0, "of the slab (one spacing)"},
                {"zoom", 0, "Y0,Z0,Y1,Z1", 0,
                 "corners of the window in the plane's two axes, e.g. 0.5mm,0.5mm,1mm,1mm"}},
    .applies = applies,
    .analyze = analyze};
