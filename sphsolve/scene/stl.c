#include "sphsolve/scene/stl.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"

/* Of triangles; a file of more is not read. */
enum { TRIANGLES_MOST = 4000000 };
/* An 80 byte title, their number (32 bits, little endian), then for each its normal and corners as
 * single precision and two bytes more (3D Systems 1989). */
enum { TITLE = 80, HEAD = 84, RECORD = 50 };
#define BYTES_MOST ((size_t)1 << 30)

static enum status read_bytes(const char *path, char **bytes, size_t *size) {
  enum status status = STATUS_OK;
  FILE *file = fopen(path, "rb");
  long end = -1;
  if (file == NULL) return FAIL(STATUS_INPUT, "%s: cannot be read", path);
  if (fseek(file, 0, SEEK_END) == 0) end = ftell(file);
  if (end < 0 || (size_t)end > BYTES_MOST || fseek(file, 0, SEEK_SET) != 0)
    TRY_FAIL(STATUS_INPUT, "%s: no file of at most %zu bytes, as an STL of %d triangles is", path,
             BYTES_MOST, TRIANGLES_MOST);
  *size = (size_t)end;
  TRY(memory_allocate(bytes, *size + 1, 1, "an STL file"));
  if (fread(*bytes, 1, *size, file) != *size)
    TRY_FAIL(STATUS_INPUT, "%s: ends before its %zu bytes", path, *size);
  (*bytes)[*size] = '\0';
cleanup:
  fclose(file);
  return status;
}

static uint32_t little(const unsigned char *at) {
  return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static enum status read_binary(const char *bytes, size_t count, struct stl *stl) {
  enum status status = memory_allocate(&stl->corner, count, sizeof *stl->corner, "an STL file");
  if (status != STATUS_OK) return status;
  stl->count = count;
  for (size_t t = 0; t < count; t++)
    for (size_t k = 0; k < 9; k++) {
      const uint32_t bits = little((const unsigned char *)bytes + HEAD + RECORD * t + 12 + 4 * k);
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

static bool take(struct text *text, const char *word) {
  const size_t n = strlen(word);
  skip_space(text);
  for (size_t k = 0; k < n; k++)
    if (tolower((unsigned char)text->at[k]) != word[k]) return false;
  if (text->at[n] != '\0' && !isspace((unsigned char)text->at[n])) return false;
  text->at += n;
  return true;
}

static enum status want(struct text *text, const char *word) {
  if (take(text, word)) return STATUS_OK;
  return FAIL(STATUS_INPUT, "%s:%zu: '%s' is wanted here in an ASCII STL", text->path, text->line,
              word);
}

static enum status want_numbers(struct text *text, double number[3]) {
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
  TRY(want(text, "normal"));
  TRY(want_numbers(text, normal));
  TRY(want(text, "outer"));
  TRY(want(text, "loop"));
  for (int c = 0; c < 3; c++) {
    TRY(want(text, "vertex"));
    TRY(want_numbers(text, corner[c]));
  }
  TRY(want(text, "endloop"));
  TRY(want(text, "endfacet"));
cleanup:
  return status;
}

/* One solid after another. */
static enum status read_text(const char *path, const char *bytes, size_t size, struct stl *stl) {
  enum status status = STATUS_OK;
  struct text text = {.path = path, .at = bytes, .line = 1};
  size_t room = 0;
  while (take(&text, "solid")) {
    while (*text.at != '\0' && *text.at != '\n') text.at++; /* its name */
    while (take(&text, "facet")) {
      if (stl->count == TRIANGLES_MOST)
        TRY_FAIL(STATUS_INPUT, "%s: more than %d triangles", path, TRIANGLES_MOST);
      if (stl->count == room) {
        room = room > 0 ? 2 * room : 64;
        TRY(memory_resize(&stl->corner, room, sizeof *stl->corner, "an STL file"));
      }
      TRY(read_facet(&text, stl->corner[stl->count]));
      stl->count++;
    }
    TRY(want(&text, "endsolid"));
    while (*text.at != '\0' && *text.at != '\n') text.at++;
  }
  skip_space(&text);
  if (text.at != bytes + size) TRY(want(&text, "solid"));
cleanup:
  return status;
}

/* A corner, and which it is. */
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

/* Corners at the same place are one, as STL gives no others; then each edge has to belong to an
 * even number of triangles, and any line crosses the surface an even number of times. */
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
  memory_free(&place);
  memory_free(&number);
  memory_free(&edge);
  return status;
}

enum status stl_read(const char *path, double unit, struct stl *stl) {
  enum status status = STATUS_OK;
  char *bytes = NULL;
  size_t size = 0;
  memset(stl, 0, sizeof *stl);
  TRY(read_bytes(path, &bytes, &size));
  const size_t count = size >= HEAD ? little((const unsigned char *)bytes + TITLE) : 0;
  struct text text = {.path = path, .at = bytes, .line = 1};
  if (size >= HEAD && count <= TRIANGLES_MOST && size == HEAD + RECORD * count)
    TRY(read_binary(bytes, count, stl));
  else if (memchr(bytes, '\0', size) == NULL && take(&text, "solid"))
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
      *x = *x * unit + 0.0; /* and no -0 */
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
  memory_free(&stl->corner);
  stl->count = 0;
}
