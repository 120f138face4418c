/* The plot of a flow net: soil, walls, water, equipotentials and streamlines. */
#include <math.h>
#include <string.h>

#include "analyze/plot.h"
#include "analyze/seepage/flow_net.h"
#include "analyze/seepage/seepage.h"
#include "common/memory.h"

#define DROPS 10     /* number of head steps between equipotentials */
#define TUBES_MAX 30 /* number of flow tubes between streamlines */
#define TUBES_MIN 2
/* Width in pixels: the text is readable if a telephone shows the plot 360 pixels wide; a page
 * enlarges it. */
#define WIDTH 560

/* Rows of contiguous cells as boxes: middle x, middle z, half width, half height. */
static void write_boxes(const struct head_field *f, const char *name, int kind, FILE *stream) {
  fprintf(stream, "$%s << EOD\n", name);
  for (size_t k = 0; k < f->nz; k++)
    for (size_t i = 0, from = 0; i <= f->nx; i++) {
      bool in = i < f->nx;
      if (in && kind == 0) in = f->soil[k * f->nx + i] != REGION_NONE;
      if (in && kind == 1) in = f->wall[k * f->nx + i] != REGION_NONE;
      if (in && kind == 2)
        in = f->soil[k * f->nx + i] == REGION_NONE && !isnan(f->head[k * f->nx + i]);
      if (in) continue;
      if (i > from)
        fprintf(stream, "%.6g %.6g %.6g %.6g\n", 0.5 * (double)(from + i) * f->dx,
                head_field_z(f, k), 0.5 * (double)(i - from) * f->dx, 0.5 * f->dz);
      from = i + 1;
    }
  fputs("EOD\n", stream);
}

/* Number of flow tubes: as wide as the head steps are long if a single soil fills the net, so that
 * its meshes are square. */
static int tubes_of(const struct seepage *s) {
  const struct head_field *f = &s->field;
  double k = NAN;
  for (size_t r = 0; r < f->region_count; r++) {
    if (strcmp(f->regions[r].type, "porous") != 0) continue;
    if (!isnan(k) && fabs(f->regions[r].permeability / k - 1) > 1e-6) return 6;
    k = f->regions[r].permeability;
  }
  const double tubes = s->flow / (k * s->drop / DROPS);
  return tubes >= TUBES_MIN && tubes <= TUBES_MAX ? (int)round(tubes) : 6;
}

static void write_lines(const struct seepage *s, int tubes, FILE *stream) {
  const struct head_field *f = &s->field;
  const size_t corners = (f->nx + 1) * (f->nz + 1);
  double *head = NULL, *psi = NULL, least = INFINITY;
  if (memory_allocate(&head, f->nx * f->nz, sizeof *head, "a picture") != STATUS_OK ||
      memory_allocate(&psi, corners, sizeof *psi, "a picture") != STATUS_OK) {
    error_clear(); /* then without lines */
    memory_free(&head);
    tubes = 0;
  }
  for (size_t c = 0; psi != NULL && c < corners; c++) psi[c] = NAN;
  for (size_t c = 0; psi != NULL && c < f->nx * f->nz; c++) {
    head[c] = f->soil[c] != REGION_NONE ? f->head[c] : NAN;
    for (size_t n = 0; n < 4 && !isnan(head[c]); n++) {
      const size_t at = (c / f->nx + n / 2) * (f->nx + 1) + c % f->nx + n % 2;
      psi[at] = s->psi[at];
      least = fmin(least, psi[at]);
    }
  }
  fputs("$equipotentials << EOD\n", stream);
  for (int d = 1; psi != NULL && d < DROPS; d++)
    flow_net_contour(head, f->nx, f->nz, f->dx, f->dz, 0.5, s->low + s->drop * d / DROPS, stream);
  fputs("EOD\n$streamlines << EOD\n", stream);
  for (int t = 1; psi != NULL && t < tubes; t++)
    flow_net_contour(psi, f->nx + 1, f->nz + 1, f->dx, f->dz, 0, least + s->flow * t / tubes,
                     stream);
  fputs("EOD\n", stream);
  memory_free(&head);
  memory_free(&psi);
}

void seepage_plot(const struct seepage *s, struct product *product) {
  const struct head_field *f = &s->field;
  FILE *stream = product->plot.stream;
  const int tubes = tubes_of(s);
  const double width = (double)f->nx * f->dx, height = (double)f->nz * f->dz;
  char title[300];
  bool surface = false;
  write_boxes(f, "soil", 0, stream);
  write_boxes(f, "walls", 1, stream);
  write_boxes(f, "water", 2, stream);
  write_lines(s, tubes, stream);
  fputs("$phreatic << EOD\n", stream);
  for (size_t i = 0; i < f->nx; i++) {
    surface = surface || !isnan(s->phreatic[i]);
    if (isnan(s->phreatic[i]))
      fputc('\n', stream);
    else
      fprintf(stream, "%.6g %.6g\n", head_field_x(f, i), s->phreatic[i]);
  }
  fputs("EOD\n", stream);
  char flow[80];
  value_with_error(flow, sizeof flow, s->flow, s->flow_error, "+-");
  if (s->sinks)
    snprintf(title, sizeof title, "head falls by %.3g m, in %d drops", s->drop, DROPS);
  else
    snprintf(title, sizeof title, "%s m^2/s in %d tubes, %.3g m in %d drops", flow, tubes, s->drop,
             DROPS);
  fputs("set title ", stream);
  plot_text(stream, title);
  fprintf(stream,
          " noenhanced\nset size ratio -1\nset xrange [0:%.6g]\nset yrange [0:%.6g]\n"
          "set xlabel 'x (m)'\nset ylabel 'z (m)'\nset key outside below horizontal samplen 2 "
          "width -2\n"
          "set style fill solid noborder\n"
          "plot $water with boxxyerror linecolor rgb '#d6eaf8' title 'water', "
          "$soil with boxxyerror linecolor rgb '#efe3c8' title 'soil', "
          "$walls with boxxyerror linecolor rgb '#555555' title 'wall', "
          "$equipotentials with lines linewidth 1.4 linecolor rgb '%s' title 'equipotentials'",
          width, height, plot_colours[0]);
  if (!s->sinks)
    fprintf(stream,
            ", $streamlines with lines linewidth 1.4 linecolor rgb '%s' title 'streamlines'",
            plot_colours[1]);
  if (surface)
    fprintf(stream, ", $phreatic with lines linewidth 2 linecolor rgb '%s' title 'phreatic line'",
            plot_colours[2]);
  fputc('\n', stream);
  product->width = WIDTH;
  product->height = (int)fmin(1.2 * WIDTH, fmax(260, WIDTH * 0.85 * height / width + 210));
}
