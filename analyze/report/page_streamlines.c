/* Evenly spaced streamlines in a plane (Jobard, Lefer 1997): a line ends where it would come too
 * close to another one. */
#include <math.h>

#include "analyze/report/page_map.h"
#include "common/memory.h"

#define LINE_DISTANCE 13.0 /* pixels between two lines */
#define STEP 2.0           /* pixels per step */
#define POINTS_MAX 400

struct lines {
  const struct plane *plane;
  double scale;
  size_t cells[2]; /* number of cells, each half of the distance between lines */
  int *owner;      /* [cells] number of the line through the cell, 0 for none */
};

/* Direction of the flow at a position in spacings; false in grains and where the flow is at
 * rest. */
static bool direction_at(const struct lines *lines, double x, double y, double v[2]) {
  const struct plane *plane = lines->plane;
  if (x < 0 || y < 0 || x > (double)plane->size[0] - 1 || y > (double)plane->size[1] - 1)
    return false;
  if (plane_cubic(plane, plane->distance, x, y) < 0.1) return false;
  for (int c = 0; c < 2; c++) v[c] = plane_linear(plane, plane->velocity, 2, c, x, y);
  const double speed = hypot(v[0], v[1]);
  if (!(speed > 0.01 * plane->speed_high)) return false;
  v[0] /= speed;
  v[1] /= speed;
  return true;
}

static int *owner_at(const struct lines *lines, double x, double y) {
  const double cell = 0.5 * LINE_DISTANCE / lines->scale;
  const size_t i = (size_t)fmin(x / cell, (double)lines->cells[0] - 1);
  const size_t j = (size_t)fmin(y / cell, (double)lines->cells[1] - 1);
  return &lines->owner[j * lines->cells[0] + i];
}

/* Whether another line passes within one cell of the position. */
static bool crowded(const struct lines *lines, double x, double y, int line) {
  const double cell = 0.5 * LINE_DISTANCE / lines->scale;
  for (int k = 0; k < 9; k++) {
    const int beside = k % 3 - 1, above = k / 3 - 1;
    const double a = fmax(x + beside * cell, 0.0), b = fmax(y + above * cell, 0.0);
    const int owner = *owner_at(lines, a, b);
    if (owner != 0 && owner != line) return true;
  }
  return false;
}

/* Traces a line from (x, y) by the midpoint method, against the flow for sign -1. Returns the
 * number of points. */
static size_t trace(const struct lines *lines, int line, double sign, double x, double y,
                    double points[POINTS_MAX][2]) {
  const double step = sign * STEP / lines->scale;
  size_t n = 0;
  double v[2];
  while (n < POINTS_MAX && direction_at(lines, x, y, v) && !crowded(lines, x, y, line)) {
    points[n][0] = x;
    points[n++][1] = y;
    if (!direction_at(lines, x + 0.5 * step * v[0], y + 0.5 * step * v[1], v)) break;
    x += step * v[0];
    y += step * v[1];
  }
  return n;
}

static void write_line(const struct lines *lines, double height, size_t n, double (*points)[2],
                       FILE *stream) {
  for (size_t i = 0; i < n; i += i + 2 < n ? 2 : 1)
    fprintf(stream, "%s%.1f %.1f", i == 0 ? "M" : "L", points[i][0] * lines->scale,
            height - points[i][1] * lines->scale);
  if (n < 24) return;
  /* An arrow in the middle of the line. */
  const double *tip = points[n / 2 + 2], *tail = points[n / 2 - 1];
  const double x = tip[0] * lines->scale, y = height - tip[1] * lines->scale;
  const double a = (tip[0] - tail[0]) * lines->scale, b = -(tip[1] - tail[1]) * lines->scale;
  const double size = 4.0 / fmax(hypot(a, b), 1e-9);
  fprintf(stream, "M%.1f %.1fL%.1f %.1fL%.1f %.1f", x - size * (a + 0.6 * b),
          y - size * (b - 0.6 * a), x, y, x - size * (a - 0.6 * b), y - size * (b + 0.6 * a));
}

enum status map_streamlines(const struct plane *plane, double scale, double height, FILE *stream) {
  enum status status = STATUS_OK;
  struct lines lines = {.plane = plane, .scale = scale};
  double(*points)[2] = NULL, (*back)[2] = NULL;
  for (int d = 0; d < 2; d++)
    lines.cells[d] = (size_t)(2.0 * scale * (double)plane->size[d] / LINE_DISTANCE) + 1;
  TRY(memory_allocate(&lines.owner, lines.cells[0] * lines.cells[1], sizeof *lines.owner,
                      "streamlines"));
  TRY(memory_allocate(&points, 2 * POINTS_MAX, sizeof *points, "streamlines"));
  TRY(memory_allocate(&back, POINTS_MAX, sizeof *back, "streamlines"));
  fputs("<path fill=\"none\" stroke=\"#fff\" stroke-width=\"1.1\" stroke-opacity=\".8\" d=\"",
        stream);
  const double apart = 0.6 * LINE_DISTANCE / scale;
  const int columns = (int)ceil((double)plane->size[0] / apart);
  const int rows = (int)ceil((double)plane->size[1] / apart);
  for (int row = 0; row < rows; row++)
    for (int column = 0; column < columns; column++) {
      const int line = row * columns + column + 1;
      const double x = column * apart, y = row * apart;
      const size_t behind = trace(&lines, line, -1.0, x, y, back);
      for (size_t i = 0; i < behind; i++) {
        points[i][0] = back[behind - 1 - i][0];
        points[i][1] = back[behind - 1 - i][1];
      }
      size_t n = behind;
      if (n > 0) n += trace(&lines, line, 1.0, x, y, points + n - 1) - 1;
      if ((double)n * STEP < 26.0) continue; /* too short to be useful */
      for (size_t i = 0; i < n; i++) *owner_at(&lines, points[i][0], points[i][1]) = line;
      write_line(&lines, height, n, points, stream);
    }
  fputs("\"/>\n", stream);
cleanup:
  memory_free(&lines.owner);
  memory_free(&points);
  memory_free(&back);
  return status;
}
