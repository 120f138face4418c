/* Data of the three-dimensional view and its static picture; the fields are computed in
 * page_flow.c. */
#include <math.h>
#include <string.h>

#include "analyze/report/page_flow.h"
#include "analyze/report/page_html.h"
#include "common/memory.h"

void flow_write_json(const struct flow *flow, const char *label, FILE *stream) {
  size_t cells = flow->size[0] * flow->size[1] * flow->size[2];
  fprintf(stream, "{\"label\":\"%s\",\"size\":[%zu,%zu,%zu],\"cell\":[%.6g,%.6g,%.6g],", label,
          flow->size[0], flow->size[1], flow->size[2], flow->cell[0], flow->cell[1], flow->cell[2]);
  fprintf(stream, "\"speed_high\":%.6g,\"lines\":[", flow->speed_high);
  for (size_t i = 0; i < flow->line_count; i++)
    fprintf(stream, "%s%zu", i > 0 ? "," : "", flow->line_start[i + 1] - flow->line_start[i]);
  fputs("],\"grains\":\"", stream);
  uint8_t *bytes = NULL;
  if (memory_allocate(&bytes, cells, 1, "grains") == STATUS_OK) {
    for (size_t i = 0; i < cells; i++)
      bytes[i / 2] |= (uint8_t)((unsigned)lrintf(15.0f * flow->solid[i]) << (i % 2 * 4));
    html_base64(stream, bytes, (cells + 1) / 2);
  }
  memory_free(&bytes);
  fputs("\",\"points\":\"", stream);
  /* Unsigned 16-bit integers: positions in 1/500 cell (enough for FLOW_SIDE cells), speed times
   * 65535. */
  uint16_t *words = NULL;
  if (memory_allocate(&words, 4 * flow->point_count, 2, "streamlines") == STATUS_OK) {
    for (size_t i = 0; i < 4 * flow->point_count; i++)
      words[i] = (uint16_t)lrintf(flow->points[i] * (i % 4 == 3 ? 65535.0f : 500.0f));
    html_base64(stream, words, 8 * flow->point_count);
  }
  memory_free(&words);
  fputs("\"}", stream);
}

#define STILL 360 /* pixels per side */

void flow_camera(const struct flow *flow, size_t side, struct camera *camera) {
  const double turn = 0.62, tilt = 0.42;
  const double forward[3] = {cos(tilt) * sin(turn), cos(tilt) * cos(turn), -sin(tilt)};
  double diagonal = 0.0;
  memcpy(camera->forward, forward, sizeof forward);
  camera->right[0] = cos(turn);
  camera->right[1] = -sin(turn);
  camera->right[2] = 0.0;
  camera->up[0] = sin(tilt) * sin(turn);
  camera->up[1] = sin(tilt) * cos(turn);
  camera->up[2] = cos(tilt);
  for (int d = 0; d < 3; d++) {
    camera->middle[d] = 0.5 * (double)flow->size[d];
    diagonal += (double)flow->size[d] * (double)flow->size[d];
  }
  camera->scale = 0.97 * sqrt(diagonal) / (double)side;
}

/* The near upper octant is cut away to show the flow inside. */
static bool cut_away(const struct flow *flow, const double p[3]) {
  return p[0] < 0.55 * (double)flow->size[0] && p[1] < 0.55 * (double)flow->size[1] &&
         p[2] > 0.45 * (double)flow->size[2];
}

static float solid_at(const struct flow *flow, const double p[3]) {
  size_t at[3];
  for (int d = 0; d < 3; d++) {
    if (p[d] < 0.0 || p[d] >= (double)flow->size[d]) return 0.0f;
    at[d] = (size_t)p[d];
  }
  if (cut_away(flow, p)) return 0.0f;
  return flow->solid[(at[2] * flow->size[1] + at[1]) * flow->size[0] + at[0]];
}

/* Palette indices: 1 to 120 grains by brightness, 128 to 255 streamlines by speed, 0 background. */
static void still_palette(uint32_t palette[256]) {
  static const uint8_t stops[5][3] = {{0xfd, 0xb4, 0x2f},
                                      {0xed, 0x79, 0x53},
                                      {0xcc, 0x47, 0x78},
                                      {0x9c, 0x17, 0x9e},
                                      {0x0d, 0x08, 0x87}};
  palette[0] = 0xffffff;
  for (int i = 1; i < 256; i++) {
    double rgb[3];
    if (i < 128) {
      double b = 0.30 + 0.70 * i / 120.0;
      rgb[0] = 214 * fmin(b, 1.0);
      rgb[1] = 206 * fmin(b, 1.0);
      rgb[2] = 192 * fmin(b, 1.0);
    } else {
      double s = 4.0 * (i - 128) / 127.0;
      int k = s >= 4.0 ? 3 : (int)s;
      for (int c = 0; c < 3; c++) rgb[c] = stops[k][c] + (s - k) * (stops[k + 1][c] - stops[k][c]);
    }
    palette[i] = (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2];
  }
}

/* Traces one ray to the first grain. The brightness depends on the normal of the surface and on
 * depth. */
static void shade(const struct flow *flow, const struct camera *camera, double u, double v,
                  double reach, uint8_t *pixel, float *depth) {
  for (double t = -reach; t < reach; t += 0.5) { // NOLINT: halves are exact
    double p[3];
    for (int d = 0; d < 3; d++)
      p[d] = camera->middle[d] + u * camera->right[d] + v * camera->up[d] + t * camera->forward[d];
    if (solid_at(flow, p) > 0.5f) {
      /* Light from the upper left; the gradient of the grain field is the inward normal. */
      double g[3], length = 0.0, lit = 0.0;
      static const double light[3] = {0.35, 0.55, -0.76};
      for (int d = 0; d < 3; d++) {
        double a[3] = {p[0], p[1], p[2]}, b[3] = {p[0], p[1], p[2]};
        a[d] -= 1.5;
        b[d] += 1.5;
        g[d] = (double)(solid_at(flow, b) - solid_at(flow, a));
        length += g[d] * g[d];
      }
      length = sqrt(length);
      for (int d = 0; d < 3; d++) lit += length > 0 ? g[d] / length * light[d] : 0.4 * light[d];
      double brightness = 0.35 + 0.65 * fmax(lit, 0.0);
      *pixel = (uint8_t)(1 + 119 * brightness);
      *depth = (float)t;
      return;
    }
  }
}

static void draw_line(const struct flow *flow, const struct camera *camera, size_t line,
                      uint8_t *pixels, const float *depths) {
  for (size_t i = flow->line_start[line]; i < flow->line_start[line + 1]; i++) {
    double p[3], u = 0.0, v = 0.0, t = 0.0;
    for (int d = 0; d < 3; d++) {
      p[d] = (double)flow->points[4 * i + (size_t)d];
      double q = p[d] - camera->middle[d];
      u += q * camera->right[d];
      v += q * camera->up[d];
      t += q * camera->forward[d];
    }
    double x = 0.5 * STILL + u / camera->scale, y = 0.5 * STILL - v / camera->scale;
    for (int k = 0; k < 4; k++) { /* lines are two pixels wide */
      double px = x + (k & 1), py = y + (k >> 1);
      if (px < 0 || py < 0 || px >= STILL || py >= STILL) continue;
      size_t at = (size_t)py * STILL + (size_t)px;
      if (t < (double)depths[at])
        pixels[at] = (uint8_t)(128 + lrintf(127.0f * flow->points[4 * i + 3]));
    }
  }
}

enum status flow_write_still(const struct flow *flow, FILE *stream) {
  enum status status = STATUS_OK;
  uint8_t *pixels = NULL;
  float *depths = NULL;
  uint32_t palette[256];
  struct camera camera;
  flow_camera(flow, STILL, &camera);
  TRY(memory_allocate(&pixels, STILL * STILL, 1, "a picture"));
  TRY(memory_allocate(&depths, STILL * STILL, sizeof *depths, "a picture"));
  double reach = 0.5 * camera.scale * STILL;
  for (size_t y = 0; y < STILL; y++)
    for (size_t x = 0; x < STILL; x++) {
      size_t at = y * STILL + x;
      depths[at] = INFINITY;
      shade(flow, &camera, ((double)x + 0.5 - 0.5 * STILL) * camera.scale,
            (0.5 * STILL - (double)y - 0.5) * camera.scale, reach, &pixels[at], &depths[at]);
    }
  for (size_t i = 0; i < flow->line_count; i++) draw_line(flow, &camera, i, pixels, depths);
  still_palette(palette);
  TRY(html_picture(stream, pixels, 1, STILL, STILL, palette,
                   "Grains with one corner cut away and streamlines coloured by speed"));
cleanup:
  memory_free(&pixels);
  memory_free(&depths);
  return status;
}
