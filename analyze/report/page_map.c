#include "analyze/report/page_map.h"

#include <math.h>

#include "analyze/report/page_html.h"
#include "common/memory.h"

#define WIDTH 720.0      /* pixels of the longer side */
#define BAR 124.0        /* pixels beside the map for the colour scale */
#define FOOT 38.0        /* pixels below the map for the length scale */
#define LINE 28.0        /* pixels between lines of text */
#define NARROW_WIDTH 360 /* pixels: below this width the names of the axes have their own line */
#define FONT 22          /* pixels; half of it remains on a telephone */
#define GRAIN 255        /* colour index of the grains */
#define HATCH 254        /* colour index of the hatching of soil with pores below the site size */
#define COLOURS 254      /* of the colour scale, before those two */
#define GRAIN_RGB 0xd9d3c7
#define HATCH_RGB 0xb08968
#define HATCH_DISTANCE 14 /* pixels between two lines of the hatching */

/* Dark blue over green to yellow, perceptually uniform (after viridis), and blue over white to
 * red. */
static const int viridis[9][3] = {{68, 1, 84},    {71, 44, 122},  {59, 81, 139},
                                  {44, 113, 142}, {33, 144, 141}, {39, 173, 129},
                                  {92, 200, 99},  {170, 220, 50}, {253, 231, 37}};
static const int diverging[9][3] = {{5, 48, 97},     {46, 121, 181},  {120, 178, 213},
                                    {200, 223, 238}, {247, 247, 247}, {250, 212, 193},
                                    {235, 145, 113}, {193, 61, 62},   {103, 0, 31}};

static uint32_t colour(enum map_of what, double share) {
  const int(*stops)[3] = what == MAP_SPEED ? viridis : diverging;
  const double s = fmin(fmax(share, 0.0), 1.0) * 8.0;
  const int k = s >= 8.0 ? 7 : (int)s;
  uint32_t rgb = 0;
  for (int c = 0; c < 3; c++)
    rgb = rgb << 8 | (uint32_t)lrint(stops[k][c] + (s - k) * (stops[k + 1][c] - stops[k][c]));
  return rgb;
}

struct canvas {
  const struct plane *plane;
  enum map_of what;
  double scale, width, height; /* pixels per spacing; pixels */
};

static double distance_at(const struct canvas *canvas, double px, double py) {
  return plane_cubic(canvas->plane, canvas->plane->distance, px / canvas->scale - 0.5,
                     (canvas->height - py) / canvas->scale - 0.5);
}

static enum status write_pixels(const struct canvas *canvas, FILE *stream) {
  enum status status = STATUS_OK;
  const struct plane *plane = canvas->plane;
  const size_t width = (size_t)canvas->width, height = (size_t)canvas->height;
  uint8_t *pixels = NULL;
  uint32_t palette[256];
  for (int i = 0; i < COLOURS; i++) palette[i] = colour(canvas->what, i / (COLOURS - 1.0));
  palette[GRAIN] = GRAIN_RGB;
  palette[HATCH] = HATCH_RGB;
  TRY(memory_allocate(&pixels, width * height, 1, "a picture"));
  for (size_t j = 0; j < height; j++)
    for (size_t i = 0; i < width; i++) {
      const double x = ((double)i + 0.5) / canvas->scale - 0.5;
      const double y = (canvas->height - (double)j - 0.5) / canvas->scale - 0.5;
      double share;
      if (plane_cubic(plane, plane->distance, x, y) <= 0.0) {
        pixels[j * width + i] = GRAIN;
        continue;
      }
      if (plane->soil != NULL && (i + j) % HATCH_DISTANCE < 2 &&
          plane_linear(plane, plane->soil, 1, 0, x, y) > 0.5) {
        pixels[j * width + i] = HATCH;
        continue;
      }
      if (canvas->what == MAP_SPEED)
        share = plane_linear(plane, plane->speed, 1, 0, x, y) / plane->speed_high;
      else
        share = 0.5 + 0.5 * plane_linear(plane, plane->pressure, 1, 0, x, y) / plane->pressure_high;
      pixels[j * width + i] = (uint8_t)lrint((COLOURS - 1.0) * fmin(fmax(share, 0.0), 1.0));
    }
  fprintf(stream, "<image width=\"%zu\" height=\"%zu\" href=\"", width, height);
  TRY(html_png(stream, pixels, 1, width, height, palette));
  fputs("\"/>\n", stream);
cleanup:
  memory_free(&pixels);
  return status;
}

/* Contours of distance 0 by marching squares on cells of four pixels, with interpolated
 * crossings. */
static void write_outlines(const struct canvas *canvas, FILE *stream) {
  const double cell = 4.0;
  fputs("<path fill=\"none\" stroke=\"#5d564a\" stroke-width=\"1.6\" stroke-linecap=\"round\" d=\"",
        stream);
  for (double y = 0.0; y + cell <= canvas->height; y += cell) {
    double left[2] = {distance_at(canvas, 0.0, y), distance_at(canvas, 0.0, y + cell)};
    for (double x = 0.0; x + cell <= canvas->width; x += cell) {
      const double right[2] = {distance_at(canvas, x + cell, y),
                               distance_at(canvas, x + cell, y + cell)};
      /* Corners around the cell: a side between corners of different sign is crossed. */
      const double v[5] = {left[0], right[0], right[1], left[1], left[0]};
      static const double corner[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
      double cross[4][2];
      int n = 0;
      for (int k = 0; k < 4; k++) {
        if ((v[k] > 0) == (v[k + 1] > 0)) continue;
        const double t = v[k] / (v[k] - v[k + 1]);
        for (int d = 0; d < 2; d++)
          cross[n][d] = corner[k][d] + t * (corner[k + 1][d] - corner[k][d]);
        n++;
      }
      for (int k = 0; k + 1 < n; k += 2)
        fprintf(stream, "M%.1f %.1fL%.1f %.1f", x + cell * cross[k][0], y + cell * cross[k][1],
                x + cell * cross[k + 1][0], y + cell * cross[k + 1][1]);
      left[0] = right[0];
      left[1] = right[1];
    }
  }
  fputs("\"/>\n", stream);
}

/* The unit in which the numbers of a colour scale are short, seven characters with their signs. */
struct map_unit {
  double factor;
  const char *name;
};

static struct map_unit unit_of(bool speed, double high) {
  static const struct map_unit units[2][4] = {
      {{1e-3, "kPa"}, {1.0, "Pa"}, {1e3, "mPa"}, {1e6, "&#181;Pa"}},
      {{1.0, "m/s"}, {1e3, "mm/s"}, {1e6, "&#181;m/s"}, {1e9, "nm/s"}}};
  const struct map_unit *unit = units[speed];
  int i = 1;
  if (unit[1].factor * high >= 1000.0) i = 0;
  while (i < 3 && unit[i].factor * high < 0.1) i++;
  return unit[i];
}

static void write_scales(const struct canvas *canvas, FILE *stream) {
  const struct plane *plane = canvas->plane;
  const bool speed = canvas->what == MAP_SPEED;
  const struct map_unit unit = unit_of(speed, speed ? plane->speed_high : plane->pressure_high);
  const double high = unit.factor * (speed ? plane->speed_high : plane->pressure_high);
  const double x = canvas->width + 14.0, tall = fmin(canvas->height, 320.0);
  for (int i = 0; i < 64; i++)
    fprintf(stream, "<rect x=\"%.1f\" y=\"%.2f\" width=\"14\" height=\"%.2f\" fill=\"#%06x\"/>", x,
            32.0 + (tall - 40.0) * i / 64.0, (tall - 40.0) / 64.0 + 0.4,
            colour(canvas->what, 1.0 - (i + 0.5) / 64.0));
  fprintf(stream, "<text x=\"%.1f\" y=\"18\">%s</text>", x, unit.name);
  for (int i = 0; i <= 4; i++) {
    const double value = speed ? high * (4 - i) / 4.0 : high * (2 - i) / 2.0;
    fprintf(stream, "<text x=\"%.1f\" y=\"%.1f\">%s%.*g</text>", x + 20.0,
            39.0 + (tall - 40.0) * i / 4.0,
            i == 0 || (!speed && i == 4) ? (i == 0 ? "&#8805; " : "&#8804; ") : "",
            fabs(value) < 99.5 ? 2 : 3, value);
  }
  if (plane->soil != NULL) {
    const double y = tall + 14.0;
    fprintf(stream,
            "<rect class=\"soil\" x=\"%.1f\" y=\"%.1f\" width=\"28\" height=\"24\" "
            "fill=\"#%06x\"/><path fill=\"none\" stroke=\"#%06x\" stroke-width=\"2\" "
            "d=\"M%.1f %.1fl14 -14m-14 24l24 -24m4 10l-14 14\"/><text x=\"%.1f\" "
            "y=\"%.1f\">soil</text>",
            x, y, colour(canvas->what, speed ? 0.0 : 0.5), HATCH_RGB, x, y + 14.0, x + 36.0,
            y + 20.0);
  }
  /* A round length of about a quarter of the width. */
  const double metres = 0.25 * canvas->width / canvas->scale * plane->spacing[0];
  double length = pow(10.0, floor(log10(metres)));
  length *= metres / length >= 5.0 ? 5.0 : metres / length >= 2.0 ? 2.0 : 1.0;
  const double pixels = length / plane->spacing[0] * canvas->scale;
  const bool narrow = canvas->width < NARROW_WIDTH;
  fprintf(stream,
          "<rect x=\"0\" y=\"%.1f\" width=\"%.1f\" height=\"4\" fill=\"#222\"/>"
          "<text x=\"%.1f\" y=\"%.1f\">%.4g &#181;m</text>"
          "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%c across, %c up</text>\n",
          canvas->height + 16.0, pixels, pixels + 8.0, canvas->height + 26.0, 1e6 * length,
          narrow ? 0.0 : canvas->width, canvas->height + 26.0 + narrow * LINE,
          narrow ? "start" : "end", "xyz"[plane->across], "xyz"[plane->up]);
}

enum status map_write(const struct plane *plane, enum map_of what, FILE *stream) {
  enum status status = STATUS_OK;
  const double longer = (double)(plane->size[0] > plane->size[1] ? plane->size[0] : plane->size[1]);
  struct canvas canvas = {.plane = plane, .what = what, .scale = WIDTH / longer};
  canvas.width = floor(canvas.scale * (double)plane->size[0]);
  canvas.height = floor(canvas.scale * (double)plane->size[1]);
  const double width = fmax(canvas.width, 60.0) + BAR;
  const double height = canvas.height + FOOT + (canvas.width < NARROW_WIDTH) * LINE;
  fprintf(stream,
          "<svg class=\"map\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" "
          "width=\"%.0f\" height=\"%.0f\" font-family=\"sans-serif\" font-size=\"%d\" "
          "role=\"img\" aria-label=\"%s\"><rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
          width, height, width, height, FONT,
          what == MAP_SPEED ? "Speed with streamlines over the grains"
                            : "Pressure over the grains");
  TRY(write_pixels(&canvas, stream));
  if (what == MAP_SPEED) {
    /* Points are at the centres of their cells. */
    fprintf(stream, "<g transform=\"translate(%.2f %.2f)\">", 0.5 * canvas.scale,
            -0.5 * canvas.scale);
    TRY(map_streamlines(plane, canvas.scale, canvas.height, stream));
    fputs("</g>", stream);
  }
  write_outlines(&canvas, stream);
  write_scales(&canvas, stream);
  fputs("</svg>\n", stream);
cleanup:
  return status;
}
