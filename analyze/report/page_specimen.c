#include "analyze/report/page_specimen.h"

#include <math.h>
#include <string.h>

#include "analyze/report/page_html.h"
#include "analyze/plot.h"
#include "analyze/product.h"
#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/model_file.h"
#include "common/units.h"

#define PICTURE_SIDE 256 /* largest number of pixels per side of a slice */

/* A field [ny][nx] as a picture, y upwards, black at `low`, white at `high`, with at most
 * PICTURE_SIDE pixels per side. */
static enum status picture(FILE *stream, const float *field, size_t nx, size_t ny, double low,
                           double high, const char *alt) {
  enum status status = STATUS_OK;
  uint8_t *pixels = NULL;
  uint32_t palette[256];
  size_t width = nx < PICTURE_SIDE ? nx : PICTURE_SIDE;
  size_t height = ny < PICTURE_SIDE ? ny : PICTURE_SIDE;
  TRY(memory_allocate(&pixels, width * height, 1, "a picture"));
  for (size_t j = 0; j < height; j++)
    for (size_t i = 0; i < width; i++) {
      double v = (double)field[(height - 1 - j) * ny / height * nx + i * nx / width];
      pixels[j * width + i] =
          (uint8_t)lrint(255.0 * fmin(fmax((v - low) / (high - low), 0.0), 1.0));
    }
  html_palette_grey(palette);
  fputs("<figure class=\"pixels\">", stream);
  TRY(html_picture(stream, pixels, 1, width, height, palette, alt));
  fputs("<figcaption>", stream);
  html_text(stream, alt);
  fputs("</figcaption></figure>", stream);
cleanup:
  memory_free(&pixels);
  return status;
}

static void row(FILE *stream, const char *name, double value, const char *unit) {
  if (!isfinite(value)) return;
  fprintf(stream, "<tr><th>%s</th><td>%.5g%s%s</td></tr>\n", name, value, unit[0] ? " " : "", unit);
}

/* Specific surface per mm, with its 95 % half width if the file has one. */
static void row_of_surface(FILE *stream, struct h5_file *file) {
  const double surface = 1e-3 * h5_attribute_or_nan(file, "/model", "specific_surface");
  const double error = 1e-3 * h5_attribute_or_nan(file, "/model", "specific_surface_error");
  if (!isfinite(surface)) return;
  fputs("<tr><th>Specific surface</th><td>", stream);
  if (error > 0.0) { /* two digits of the error, and as many decimals of the surface */
    const int decimals = (int)fmax(0.0, 1.0 - floor(log10(error)));
    fprintf(stream, "%.*f &plusmn; %.*f", decimals, surface, decimals, error);
  } else {
    fprintf(stream, "%.4g", surface);
  }
  fputs(" 1/mm of bulk volume</td></tr>\n", stream);
}

static void write_percolation(FILE *stream, struct h5_file *file) {
  int32_t percolates[3]; /* z, y, x */
  if (!h5_attribute_exists(file, "/model", "percolates")) return;
  if (h5_read_attribute(file, "/model", "percolates", H5_I32, 3, percolates) != STATUS_OK) {
    error_clear();
    return;
  }
  fputs("<tr><th>A pore path leads through</th><td>", stream);
  for (int a = 2; a >= 0; a--)
    fprintf(stream, "%c %s%s", "zyx"[a], percolates[a] != 0 ? "yes" : "no", a > 0 ? ", " : "");
  fputs("</td></tr>\n", stream);
}

/* Reads a list in /quality and its length; NULL if the file has none. Free with memory_free. */
static double *quality_list(struct h5_file *file, const char *name, size_t *count) {
  double *values = NULL;
  char path[64];
  snprintf(path, sizeof path, "/quality/%s", name);
  *count = 0;
  if (!h5_exists(file, "/quality") || !h5_exists(file, path)) return NULL;
  if (h5_read(file, path, H5_F64, 1, count, &values) != STATUS_OK) error_clear();
  return values;
}

/* A bar chart of values[i] percent with texts below, as an SVG. */
struct bar {
  double percent;
  char text[24];
};
static void write_bars(FILE *stream, const struct bar *bars, size_t n, const char *caption) {
  const double width = 420.0, height = 150.0, foot = 34.0, head = 14.0;
  const double side = 12.0; /* space for the labels of the outer bars */
  double most = 0.0, step = width / (double)n;
  for (size_t i = 0; i < n; i++) most = fmax(most, bars[i].percent);
  if (!(most > 0.0)) return;
  fprintf(stream,
          "<figure class=\"bars\"><svg viewBox=\"%g 0 %g %g\" width=\"%g\" font-size=\"10\" "
          "text-anchor=\"middle\" fill=\"currentColor\">",
          -side, width + 2.0 * side, height, width + 2.0 * side);
  /* Characters of size 10 are at most 6 wide; labels are as dense as the longest one allows. A
   * number wider than its bar is shortened, because it might overlap a taller neighbour. */
  const bool narrow = 0.8 * step < 6.0 * 6.0;
  size_t longest = 2;
  for (size_t i = 0; i < n; i++)
    longest = strlen(bars[i].text) > longest ? strlen(bars[i].text) : longest;
  const size_t every = (size_t)ceil(6.0 * (double)(longest + 1) / step);
  for (size_t i = 0; i < n; i++) {
    const double tall = (height - foot - head) * bars[i].percent / most;
    const double middle = ((double)i + 0.5) * step, top = height - foot - tall;
    fprintf(stream, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"/>",
            middle - 0.4 * step, top, 0.8 * step, tall, plot_colours[0]);
    fprintf(stream, "<text x=\"%.1f\" y=\"%.1f\">", middle, top - 3.0);
    if (narrow)
      fprintf(stream, "%.0f</text>", bars[i].percent);
    else
      fprintf(stream, "%.3g %%</text>", bars[i].percent);
    if (i % every != 0) continue;
    fprintf(stream, "<text x=\"%.1f\" y=\"%.1f\">", middle, height - foot + 12.0);
    html_text(stream, bars[i].text);
    fputs("</text>", stream);
  }
  fputs("</svg><figcaption>", stream);
  html_text(stream, caption);
  fputs("</figcaption></figure>\n", stream);
}

enum { BARS = 16 };

/* Distribution of pore widths: the bins of the file, one per voxel, with all larger ones in the
 * last bar. */
static void write_widths(FILE *stream, struct h5_file *file) {
  struct bar bars[BARS] = {0};
  size_t count = 0, n = 0;
  double *shares = quality_list(file, "local_thickness", &count);
  for (size_t i = 0; i < count && shares != NULL; i++) {
    const size_t bar = i < BARS ? i : BARS - 1;
    bars[bar].percent += 100.0 * shares[i];
    snprintf(bars[bar].text, sizeof bars[bar].text, bar == i ? "%zu-%zu" : "%zu+", bar, bar + 1);
    if (shares[i] > 0.0) n = bar + 1;
  }
  if (n > 0)
    write_bars(stream, bars, n,
               "Pore widths: share (%) of the pores by the ball, in voxels, that fits there");
  memory_free(&shares);
}

/* Variation of the void ratio between windows, for each window size with several windows. */
static void write_windows(FILE *stream, struct h5_file *file) {
  static const char *const NAMES[] = {"window", "windows", "void_ratio", "void_ratio_deviation"};
  double *values[4] = {NULL};
  struct bar bars[BARS] = {0};
  size_t least = BARS, n = 0;
  for (int i = 0; i < 4; i++) {
    size_t count;
    values[i] = quality_list(file, NAMES[i], &count);
    if (values[i] == NULL) count = 0;
    least = count < least ? count : least;
  }
  for (size_t i = 0; i < least; i++) {
    if (!(values[1][i] > 1.0) || !(values[2][i] > 0.0)) continue;
    bars[n].percent = 100.0 * values[3][i] / values[2][i];
    snprintf(bars[n++].text, sizeof bars[0].text, "%.4g \xC2\xB5m", 1e6 * values[0][i]);
  }
  if (n > 0)
    write_bars(
        stream, bars, n,
        "Representative volume: spread (%) of the void ratio from one window of this size to "
        "the next");
  for (int i = 0; i < 4; i++) memory_free(&values[i]);
}

static void write_table(FILE *stream, struct h5_file *file, const struct voxel_model *model,
                        const struct page_model *facts, const char *path) {
  fputs("<table class=\"facts\"><tbody>\n<tr><th>Model file</th><td>", stream);
  html_text(stream, path);
  fprintf(stream,
          "</td></tr>\n<tr><th>Sites (x, y, z)</th><td>%zu &times; %zu &times; %zu</td></tr>\n",
          model->size[0], model->size[1], model->size[2]);
  row(stream, "Spacing", 1e6 * model->spacing[0], "&micro;m");
  row(stream, "Void ratio, measured on the specimen", model->void_ratio_measured, "");
  const double walls = facts->void_ratio_walls;
  const bool within = fabs(walls - model->void_ratio) > 1e-6; /* false if NAN */
  /* Voxels of labels are cut at the smoothed walls, not at the labels. */
  row(stream,
      !within                      ? "Void ratio of the model"
      : facts->rule == RULE_LABELS ? "Void ratio by voxels of the smoothed labels"
                                   : "Void ratio of the model, by voxels",
      model->void_ratio, "");
  if (within) row(stream, "Void ratio within its walls, which are used", walls, "");
  row(stream, "Grey threshold", model->threshold, "");
  row(stream, "Otsu's threshold, for comparison",
      h5_attribute_or_nan(file, "/calibration", "threshold_otsu"), "");
  row(stream, "Threshold per void ratio, dT/de",
      h5_attribute_or_nan(file, "/calibration", "dthreshold_dvoid_ratio"), "");
  row(stream, "Porosity", h5_attribute_or_nan(file, "/model", "porosity"), "");
  row(stream, "Connected porosity", h5_attribute_or_nan(file, "/model", "connected_porosity"), "");
  row(stream, "Isolated pores (on no path along z)",
      h5_attribute_or_nan(file, "/model", "isolated_pores"), "");
  row(stream, "Floating grains (touch no other, nor a side)",
      h5_attribute_or_nan(file, "/model", "floating_grains"), "");
  write_percolation(stream, file);
  row_of_surface(stream, file);
  row(stream, "Pore voxels that touch a grain",
      100.0 * h5_attribute_or_nan(file, "/model", "pore_voxels_touching_grain"), "%");
  row(stream, "Median pore width", h5_attribute_or_nan(file, "/model", "local_thickness_median"),
      "voxels");
  row(stream, "Critical width (of the widest way along z)",
      h5_attribute_or_nan(file, "/model", "critical_width"), "voxels");
  row(stream, "Correlation length", 1e6 * h5_attribute_or_nan(file, "/model", "correlation_length"),
      "&micro;m");
  fputs("</tbody></table>\n<div class=\"pictures\">", stream);
  write_widths(stream, file);
  write_windows(stream, file);
  fputs("</div>\n", stream);
}

/* Datasets of /calibration: at the resolution of the model, then at that of the scan if stored. */
#define CURVES 5
static const char *const curves[CURVES] = {"threshold", "void_ratio", "histogram",
                                           "void_ratio_original", "histogram_original"};

static enum status read_calibration(struct h5_file *file, const struct voxel_model *model,
                                    json_t **calibration) {
  enum status status = STATUS_OK;
  json_t *object = NULL;
  for (size_t i = 0; i < CURVES; i++) {
    double *values = NULL;
    size_t count = 0;
    char name[64];
    snprintf(name, sizeof name, "/calibration/%s", curves[i]);
    if (!h5_exists(file, name)) {
      if (i == 0) return STATUS_OK; /* without thresholds there is no curve */
      continue;
    }
    TRY(h5_read(file, name, H5_F64, 1, &count, &values));
    if (object == NULL) object = json_object();
    json_object_set_new(object, curves[i], json_numbers(values, count));
    memory_free(&values);
  }
  json_put_number(object, "void_ratio_measured", model->void_ratio_measured);
  json_put_number(object, "threshold_chosen", model->threshold);
  json_put_number(
      object, "void_ratio_shown",
      3.0 * (model->void_ratio_measured > 0.0 ? model->void_ratio_measured : model->void_ratio));
  *calibration = object;
  object = NULL;
cleanup:
  json_decref(object);
  return status;
}

static double array_number(const json_t *object, const char *name, size_t i) {
  const json_t *value = json_array_get(json_object_get(object, name), i);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

static double largest(const json_t *object, const char *name) {
  double most = 0.0;
  for (size_t i = 0; i < json_array_size(json_object_get(object, name)); i++)
    most = fmax(most, array_number(object, name, i));
  return most > 0.0 ? most : 1.0;
}

void page_calibration_plot(const json_t *calibration, FILE *plot) {
  size_t n = json_array_size(json_object_get(calibration, "threshold"));
  double measured = json_number_value(json_object_get(calibration, "void_ratio_measured"));
  double chosen = json_number_value(json_object_get(calibration, "threshold_chosen"));
  double highest = json_number_value(json_object_get(calibration, "void_ratio_shown")), end = 0.0;
  fputs("$c << EOD\n", plot); /* columns in the order of `curves` */
  for (size_t i = 0; i < n; i++) {
    for (size_t c = 0; c < CURVES; c++) {
      double v = array_number(calibration, curves[c], i);
      fprintf(plot, isfinite(v) ? "%.7g " : "NaN ", v);
    }
    fputc('\n', plot);
    if (array_number(calibration, "histogram", i) > 0.0)
      end = array_number(calibration, "threshold", i);
  }
  fprintf(plot,
          "EOD\nset multiplot layout 1,2 margins 0.07,0.985,0.22,0.97 spacing 0.1,0\n"
          "set xlabel 'Grey threshold'\nset ylabel 'Void ratio (-)'\nset yrange [0:%.4g]\n"
          "set xrange [*:%.6g]\n"
          "set key at screen 0.5,0.02 center bottom horizontal samplen 2 reverse Left\n",
          highest, end > 0.0 ? 1.05 * end : 1e9);
  if (measured > 0.0)
    fprintf(plot,
            "set arrow from graph 0, first %.6g to graph 1, first %.6g nohead dashtype 2 "
            "linewidth 1.5 linecolor rgb '#444444'\n",
            measured, measured);
  if (isfinite(chosen) && chosen != 0.0)
    fprintf(plot,
            "set arrow from first %.6g, graph 0 to first %.6g, graph 1 nohead dashtype 2 "
            "linewidth 1.5 linecolor rgb '#444444'\n",
            chosen, chosen);
  bool scan = json_array_size(json_object_get(calibration, "void_ratio_original")) == n &&
              json_array_size(json_object_get(calibration, "histogram_original")) == n;
  fprintf(plot, "plot $c using 1:2 with lines linewidth 2 linecolor rgb '%s' title 'model', ",
          plot_colours[0]);
  if (scan)
    fprintf(plot, "$c using 1:4 with lines linewidth 2 linecolor rgb '%s' title 'scan', ",
            plot_colours[1]);
  fprintf(plot,
          "NaN with lines dashtype 2 linewidth 1.5 linecolor rgb '#444444' title '%s'\n"
          "unset arrow\nunset key\nset yrange [0:*]\nset xlabel 'Grey value'\n"
          "set ylabel 'Voxels (share of the highest)'\n"
          "plot $c using 1:($3/%.8g) with lines linewidth 1.8 linecolor rgb '%s'",
          measured > 0.0 ? "measured void ratio; threshold" : "threshold",
          largest(calibration, "histogram"), plot_colours[0]);
  if (scan)
    fprintf(plot, ", $c using 1:($5/%.8g) with lines linewidth 1.8 linecolor rgb '%s'",
            largest(calibration, "histogram_original"), plot_colours[1]);
  fputs("\nunset multiplot\n", plot);
}

/* The middle slice of the scan, if the file has one: grey values, and cut at the scan's
 * threshold. */
static enum status scan_pictures(FILE *stream, struct h5_file *file,
                                 const struct page_model *facts) {
  enum status status = STATUS_OK;
  float *grey = NULL;
  size_t size[2]; /* y, x */
  if (!h5_exists(file, "/calibration/slice")) return STATUS_OK;
  double pore = h5_attribute_or_nan(file, "/calibration", "pore_peak");
  double grain = h5_attribute_or_nan(file, "/calibration", "grain_peak");
  double threshold = h5_attribute_or_nan(file, "/calibration", "threshold_original");
  TRY(h5_read(file, "/calibration/slice", H5_F32, 2, size, &grey));
  if (facts->rule == RULE_LABELS) { /* the grey values are not those of a scan */
    TRY(picture(stream, grey, size[1], size[0], pore, grain,
                "The middle slice: distance to the walls that were drawn through the labels"));
    goto cleanup;
  }
  if (!(fabs(grain - pore) > 0.0)) goto cleanup;
  TRY(picture(stream, grey, size[1], size[0], pore - 0.3 * (grain - pore),
              grain + 0.3 * (grain - pore), "A slice through the middle of the scan"));
  if (isfinite(threshold)) {
    for (size_t i = 0; i < size[0] * size[1]; i++)
      grey[i] = ((double)grey[i] > threshold) == (grain > pore) ? 1.0f : 0.0f;
    TRY(picture(stream, grey, size[1], size[0], 0.0, 1.0,
                facts->rule == RULE_MATCHED
                    ? "The slice at the threshold that gives the measured void ratio"
                    : "The slice at the threshold of the model"));
  }
cleanup:
  memory_free(&grey);
  return status;
}

static enum status model_pictures(FILE *stream, const struct voxel_model *model) {
  enum status status = STATUS_OK;
  size_t nx = model->size[0], ny = model->size[1], z = model->size[2] / 2;
  float *layer = NULL;
  if (model->mirror_plane > 0) z = (size_t)model->mirror_plane / 2; /* the middle of the scan */
  TRY(memory_allocate(&layer, nx * ny, sizeof *layer, "a picture"));
  for (size_t i = 0; i < nx * ny; i++) {
    const size_t site = z * nx * ny + i;
    const bool soil = model->micro_porosity != NULL && model->micro_porosity[site] > 0.0f;
    layer[i] = soil && model->solid[site] == 0 ? 0.5f : (float)model->solid[site];
  }
  if (model->grain_fraction != NULL)
    TRY(picture(stream, model->grain_fraction + z * nx * ny, nx, ny, 0.0, 1.0,
                "Grain fraction of a layer, at the model's resolution"));
  if (model->wall_distance != NULL)
    TRY(picture(stream, model->wall_distance + z * nx * ny, nx, ny, model->spacing[0],
                -model->spacing[0], "Signed distance to the grain surface, one spacing each way"));
  TRY(picture(stream, layer, nx, ny, 0.0, 1.0,
              model->micro_porosity != NULL
                  ? "The same layer of the model (grains light, soil grey)"
                  : "The same layer of the binary model (grains light)"));
cleanup:
  memory_free(&layer);
  return status;
}

static enum status write_model(const struct page_model *facts, const struct voxel_model *model,
                               FILE *stream, json_t **calibration) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  TRY(h5_open(facts->path, &file));
  fputs("<div class=\"pictures\">", stream);
  TRY(scan_pictures(stream, file, facts));
  TRY(model_pictures(stream, model));
  fputs("</div>\n", stream);
  write_table(stream, file, model, facts, facts->path);
  TRY(read_calibration(file, model, calibration));
cleanup:
  h5_close(file);
  return status;
}

enum status page_specimen(const struct run *run, const struct page_model *facts,
                          const struct voxel_model *model, FILE *stream, json_t **calibration) {
  *calibration = NULL;
  if (run->model_path[0] == '\0') {
    fputs("<p>The scene has no scanned model; its domain and regions stand in the scene file "
          "below.</p>\n",
          stream);
    return STATUS_OK;
  }
  if (model->solid != NULL) {
    if (write_model(facts, model, stream, calibration) == STATUS_OK) return STATUS_OK;
    log_warning("%s; the report leaves the specimen out", error_message());
    error_clear();
  } else if (!facts->found && !facts->other) {
    log_warning("%s: the model file %s is not found; the report leaves the specimen out (put it "
                "beside the run)",
                run->path, run->model_path);
  }
  fputs("<p>The model file <code>", stream);
  html_text(stream, run->model_path);
  fputs(facts->other
            ? "</code> is not the one that was run: it was changed or replaced since.</p>\n"
            : "</code> could not be read when this page was made.</p>\n",
        stream);
  return STATUS_OK;
}
