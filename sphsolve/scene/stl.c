#include "sphsolve/scene/stl.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/input_file.h"
#include "common/memory.h"

/* Largest number of triangles in a file. */
enum { TRIANGLES_MAX = 4000000 };
/* Format: a title of 80 bytes, the number of triangles (32 bits, little endian), then for each
 * triangle its normal and corners in single precision and two more bytes (3D Systems 1989). */
enum { TITLE = 80, HEAD = 84, RECORD = 50 };
#define BYTES_MAX ((size_t)1 << 30)

static enum status read_bytes(const char *path, char **bytes, size_t *size) {
  enum status status = STATUS_OK;
  FILE *file = NULL;
  long end = -1;
  TRY(input_open(path, &file));
  if (fseek(file, 0, SEEK_END) == 0) end = ftell(file);
  if (end < 0 || (size_t)end > BYTES_MAX || fseek(file, 0, SEEK_SET) != 0)
    TRY_FAIL(STATUS_INPUT, "%s: no file of at most %zu bytes, as an STL of %d triangles is", path,
             BYTES_MAX, TRIANGLES_MAX);
  *size = (size_t)end;
  TRY(memory_allocate(bytes, *size + 1, 1, "an STL file"));
  if (fread(*bytes, 1, *size, file) != *size)
    TRY_FAIL(STATUS_INPUT, "%s: ends before its %zu bytes", path, *size);
  (*bytes)[*size] = '\0';
cleanup:
  if (file != NULL) fclose(file);
  return status;
}

static uint32_t read_little_endian(const unsigned char *at) {
  return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static enum status read_binary(const char *bytes, size_t count, struct stl *stl) {
  enum status status = memory_allocate(&stl->corner, count, sizeof *stl->corner, "an STL file");
  if (status != STATUS_OK) return status;
  stl->count = count;
  for (size_t t = 0; t < count; t++)
    for (size_t k = 0; k < 9; k++) {
      const uint32_t bits =
          read_little_endian((const unsigned char *)bytes + HEAD + RECORD * t + 12 + 4 * k);
      float value;
      memcpy(&value, &bits, sizeof value);
      stl->corner[t][k / 3][k % 3] = (double)value;
    }
  return STATUS_OK;
}

struct text {
  const char *path, *at;
  size_t line;
};

static void skip_space(struct text *text) {
  for (; isspace((unsigned char)*text->at); text->at++) text->line += *text->at == '\n';
}

static bool skip_word(struct text *text, const char *word) {
  const size_t n = strlen(word);
  skip_space(text);
  for (size_t k = 0; k < n; k++)
    if (tolower((unsigned char)text->at[k]) != word[k]) return false;
  if (text->at[n] != '\0' && !isspace((unsigned char)text->at[n])) return false;
  text->at += n;
  return true;
}

static enum status expect_word(struct text *text, const char *word) {
  if (skip_word(text, word)) return STATUS_OK;
  return FAIL(STATUS_INPUT, "%s:%zu: '%s' is wanted here in an ASCII STL", text->path, text->line,
              word);
}

static enum status read_numbers(struct text *text, double number[3]) {
  for (int a = 0; a < 3; a++) {
    char *end;
    skip_space(text);
    number[a] = strtod(text->at, &end);
    if (end == text->at)
      return FAIL(STATUS_INPUT, "%s:%zu: three numbers are wanted here", text->path, text->line);
    text->at = end;
  }
  return STATUS_OK;
}

static enum status read_facet(struct text *text, double corner[3][3]) {
  enum status status = STATUS_OK;
  double normal[3];
  TRY(expect_word(text, "normal"));
  TRY(read_numbers(text, normal));
  TRY(expect_word(text, "outer"));
  TRY(expect_word(text, "loop"));
  for (int c = 0; c < 3; c++) {
    TRY(expect_word(text, "vertex"));
    TRY(read_numbers(text, corner[c]));
  }
  TRY(expect_word(text, "endloop"));
  TRY(expect_word(text, "endfacet"));
cleanup:
  return status;
}

/* Reads an ASCII file, which may contain several solids. */
static enum status read_text(const char *path, const char *bytes, size_t size, struct stl *stl) {
  enum status status = STATUS_OK;
  struct text text = {.path = path, .at = bytes, .line = 1};
  size_t room = 0;
  while (skip_word(&text, "solid")) {
    while (*text.at != '\0' && *text.at != '\n') text.at++; /* its name */
    while (skip_word(&text, "facet")) {
      if (stl->count == TRIANGLES_MAX)
        TRY_FAIL(STATUS_INPUT, "%s: more than %d triangles", path, TRIANGLES_MAX);
      if (stl->count == room) {
        room = room > 0 ? 2 * room : 64;
        TRY(memory_resize(&stl->corner, room, sizeof *stl->corner, "an STL file"));
      }
      TRY(read_facet(&text, stl->corner[stl->count]));
      stl->count++;
    }
    TRY(expect_word(&text, "endsolid"));
    while (*text.at != '\0' && *text.at != '\n') text.at++;
  }
  skip_space(&text);
  if (text.at != bytes + size) TRY(expect_word(&text, "solid"));
cleanup:
  return status;
}

/* Position and index of a corner. */
struct place {
  double x[3];
  size_t corner;
};

static int by_place(const void *a, const void *b) {
  const double *x = ((const struct place *)a)->x, *y = ((const struct place *)b)->x;
  for (int k = 0; k < 3; k++)
    if (x[k] != y[k]) return x[k] < y[k] ? -1 : 1;
  return 0;
}

struct edge {
  uint32_t from, to;
};

static int by_ends(const void *a, const void *b) {
  const struct edge *x = a, *y = b;
  if (x->from != y->from) return x->from < y->from ? -1 : 1;
  return (x->to > y->to) - (x->to < y->to);
}

/* Checks that the surface is closed. Corners at the same place are identified, as STL has no
 * connectivity; each edge must then belong to an even number of triangles, so that any line crosses
 * the surface an even number of times. */
static enum status check_closed(const char *path, const struct stl *stl) {
  enum status status = STATUS_OK;
  const size_t n = 3 * stl->count;
  struct place *place = NULL;
  struct edge *edge = NULL;
  uint32_t *number = NULL, last = 0;
  size_t edges = 0, open = 0, first = 0;
  TRY(memory_allocate(&place, n, sizeof *place, "an STL file"));
  TRY(memory_allocate(&number, n, sizeof *number, "an STL file"));
  TRY(memory_allocate(&edge, n, sizeof *edge, "an STL file"));
  for (size_t k = 0; k < n; k++) {
    memcpy(place[k].x, stl->corner[k / 3][k % 3], sizeof place[k].x);
    place[k].corner = k;
  }
  qsort(place, n, sizeof *place, by_place);
  for (size_t k = 0; k < n; k++) {
    if (k > 0 && by_place(&place[k - 1], &place[k]) != 0) last++;
    number[place[k].corner] = last;
  }
  for (size_t k = 0; k < n; k++) {
    const uint32_t a = number[k], b = number[k % 3 == 2 ? k - 2 : k + 1];
    if (a != b) edge[edges++] = (struct edge){a < b ? a : b, a < b ? b : a};
  }
  qsort(edge, edges, sizeof *edge, by_ends);
  for (size_t k = 0, end; k < edges; k = end) {
    for (end = k + 1; end < edges && by_ends(&edge[k], &edge[end]) == 0;) end++;
    if ((end - k) % 2 == 0) continue;
    if (open++ == 0) first = k;
  }
  if (open > 0) {
    size_t k = 0;
    while (number[place[k].corner] != edge[first].from) k++;
    TRY_FAIL(STATUS_INPUT,
             "%s: the surface is open: %zu edge%s to an odd number of triangles, the first at "
             "(%g, %g, %g) m; close it in the program that made it",
             path, open, open == 1 ? " belongs" : "s belong", place[k].x[0], place[k].x[1],
             place[k].x[2]);
  }
cleanup:
  MEMORY_FREE(&place, &number, &edge);
  return status;
}

enum status stl_read(const char *path, double unit, struct stl *stl) {
  enum status status = STATUS_OK;
  char *bytes = NULL;
  size_t size = 0;
  memset(stl, 0, sizeof *stl);
  TRY(read_bytes(path, &bytes, &size));
  const size_t count = size >= HEAD ? read_little_endian((const unsigned char *)bytes + TITLE) : 0;
  struct text text = {.path = path, .at = bytes, .line = 1};
  if (size >= HEAD && count <= TRIANGLES_MAX && size == HEAD + RECORD * count)
    TRY(read_binary(bytes, count, stl));
  else if (memchr(bytes, '\0', size) == NULL && skip_word(&text, "solid"))
    TRY(read_text(path, bytes, size, stl));
  else
    TRY_FAIL(STATUS_INPUT,
             "%s: no STL: an ASCII one begins with 'solid', and a binary one of %zu triangles has "
             "%zu bytes, not %zu",
             path, count, HEAD + RECORD * count, size);
  if (stl->count == 0) TRY_FAIL(STATUS_INPUT, "%s: holds no triangle", path);
  for (int a = 0; a < 3; a++) stl->extent[a] = INFINITY, stl->extent[a + 3] = -INFINITY;
  for (size_t t = 0; t < stl->count; t++)
    for (int k = 0; k < 9; k++) {
      double *x = &stl->corner[t][k / 3][k % 3];
      *x = *x * unit + 0.0; /* without -0 */
      if (!isfinite(*x))
        TRY_FAIL(STATUS_INPUT, "%s: triangle %zu has a corner that is no number", path, t + 1);
      stl->extent[k % 3] = fmin(stl->extent[k % 3], *x);
      stl->extent[k % 3 + 3] = fmax(stl->extent[k % 3 + 3], *x);
    }
  TRY(check_closed(path, stl));
cleanup:
  memory_free(&bytes);
  return status;
}

void stl_free(struct stl *stl) {
  for (int a = 0; a < 3; a++) MEMORY_FREE(&stl->columns[a].start, &stl->columns[a].triangle);
  memory_free(&stl->corner);
  stl->count = 0;
}

/* Where the edge a b meets the plane at v. */
static void cut_edge(const double *a, const double *b, int run, int across, int up, double v,
                     double at[2]) {
  for (int k = 0; k < 3; k++) /* same order of the ends for both triangles */
    if (a[k] != b[k]) {
      if (a[k] > b[k]) {
        const double *c = a;
        a = b, b = c;
      }
      break;
    }
  const double t = (v - a[up]) / (b[up] - a[up]);
  at[0] = a[run] + t * (b[run] - a[run]);
  at[1] = a[across] + t * (b[across] - a[across]);
}

/* Whether a point is inside: the plane through it cuts each triangle that has corners on both sides
 * in one segment, and a line in that plane crosses the segments an even number of times: each end
 * point belongs to the two triangles at an edge and is computed from this edge alone, with its ends
 * in a fixed order, hence with identical bits. So no ray passes between triangles. */
bool stl_section(double corner[3][3], int run, int across, int up, double v, double end[2][2]) {
  int n = 0;
  for (int k = 0; k < 3; k++) {
    const double *a = corner[k], *b = corner[(k + 1) % 3];
    if ((a[up] > v) != (b[up] > v)) cut_edge(a, b, run, across, up, v, end[n++]);
  }
  return n == 2;
}

/* The column of a place along one of its axes, from the body's end on. */
static size_t column_at(const struct stl *stl, const struct stl_columns *columns, int axis, int n,
                        double x) {
  const double at = (x - stl->extent[(axis + 1 + n) % 3]) / columns->width;
  return (size_t)fmin(fmax(at, 0), (double)columns->size[n] - 1);
}

/* Counts the triangles of each column, or sorts them in. */
static void fill_columns(const struct stl *stl, int axis, bool count, struct stl_columns *columns) {
  for (size_t t = 0; t < stl->count; t++) {
    size_t from[2], to[2];
    for (int n = 0; n < 2; n++) {
      const int b = (axis + 1 + n) % 3;
      double(*x)[3] = stl->corner[t];
      from[n] = column_at(stl, columns, axis, n, fmin(fmin(x[0][b], x[1][b]), x[2][b]));
      to[n] = column_at(stl, columns, axis, n, fmax(fmax(x[0][b], x[1][b]), x[2][b]));
    }
    for (size_t j = from[1]; j <= to[1]; j++)
      for (size_t i = from[0]; i <= to[0]; i++) {
        size_t *end = &columns->start[j * columns->size[0] + i + 1];
        if (!count) columns->triangle[*end] = (uint32_t)t;
        ++*end;
      }
  }
}

enum status stl_sort(struct stl *stl, double width) {
  enum status status = STATUS_OK;
  for (int a = 0; a < 3; a++) {
    struct stl_columns *columns = &stl->columns[a];
    const int across = (a + 1) % 3, up = (a + 2) % 3;
    const double area =
        (stl->extent[across + 3] - stl->extent[across]) * (stl->extent[up + 3] - stl->extent[up]);
    *columns = (struct stl_columns){.width = fmin(width, sqrt(area / (double)stl->count))};
    if (!(columns->width > 0)) columns->width = width; /* a body without extent has no inside */
    for (int n = 0; n < 2; n++) {
      const int b = (a + 1 + n) % 3;
      columns->size[n] = (size_t)((stl->extent[b + 3] - stl->extent[b]) / columns->width) + 1;
    }
    const size_t all = columns->size[0] * columns->size[1];
    TRY(memory_allocate(&columns->start, all + 2, sizeof *columns->start, "an STL file"));
    fill_columns(stl, a, true, columns);
    for (size_t c = 0; c < all; c++) columns->start[c + 1] += columns->start[c];
    TRY(memory_allocate(&columns->triangle, columns->start[all], sizeof *columns->triangle,
                        "an STL file"));
    /* `start` of a column goes to its end while it is filled, which is the start of the next. */
    memmove(columns->start + 1, columns->start, (all + 1) * sizeof *columns->start);
    fill_columns(stl, a, false, columns);
  }
cleanup:
  return status;
}

static int by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

size_t stl_scan(const struct stl *stl, int axis, const double x[3], double *at, size_t most) {
  const struct stl_columns *columns = &stl->columns[axis];
  const int across = (axis + 1) % 3, up = (axis + 2) % 3;
  size_t n = 0;
  for (int b = 0; b < 3; b++)
    if (b != axis && !(x[b] > stl->extent[b] && x[b] < stl->extent[b + 3])) return 0;
  const size_t column = column_at(stl, columns, axis, 1, x[up]) * columns->size[0] +
                        column_at(stl, columns, axis, 0, x[across]);
  for (size_t k = columns->start[column]; k < columns->start[column + 1] && n < most; k++) {
    double end[2][2];
    if (!stl_section(stl->corner[columns->triangle[k]], axis, across, up, x[up], end) ||
        (end[0][1] > x[across]) == (end[1][1] > x[across]))
      continue;
    at[n++] =
        end[0][0] + (end[1][0] - end[0][0]) * (x[across] - end[0][1]) / (end[1][1] - end[0][1]);
  }
  qsort(at, n, sizeof *at, by_value);
  return n;
}

bool stl_may_meet(const struct stl *stl, const double from[3], const double to[3]) {
  const struct stl_columns *columns = &stl->columns[2];
  size_t first[2], last[2];
  for (int n = 0; n < 2; n++) {
    first[n] = column_at(stl, columns, 2, n, from[n]);
    last[n] = column_at(stl, columns, 2, n, to[n]);
  }
  for (size_t j = first[1]; j <= last[1]; j++)
    for (size_t i = first[0]; i <= last[0]; i++) {
      const size_t column = j * columns->size[0] + i;
      for (size_t k = columns->start[column]; k < columns->start[column + 1]; k++) {
        double(*x)[3] = stl->corner[columns->triangle[k]];
        bool meets = true;
        for (int a = 2; a >= 0 && meets; a--)
          meets = !(x[0][a] > to[a] && x[1][a] > to[a] && x[2][a] > to[a]) &&
                  !(x[0][a] < from[a] && x[1][a] < from[a] && x[2][a] < from[a]);
        if (meets) return true;
      }
    }
  return false;
}
