/* Figures of the page: plots of the analyses, and pictures of the flow. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "analyze/lattice_note.h"
#include "analyze/plot.h"
#include "analyze/report/page_html.h"
#include "analyze/report/page_internal.h"
#include "analyze/report/page_map.h"
#include "analyze/report/page_specimen.h"
#include "common/log.h"
#include "common/memory.h"

/* A plot as a static picture; on failure the page is written without it. */
void page_still(FILE *out, const char *name, const char *body, int width, int height,
                const char *title) {
  char *svg = NULL;
  if (plot_svg(name, body, width, height, &svg) != STATUS_OK) {
    log_warning("%s", error_message());
    error_clear();
  }
  if (svg != NULL) {
    fprintf(out,
            "<img class=\"still\" data-name=\"%s\" width=\"%d\" height=\"%d\" alt=\"%s\" "
            "src=\"data:image/svg+xml;base64,",
            name, width, height, title);
    html_base64(out, svg, strlen(svg));
    fputs("\">\n", out);
  } else {
    fputs("<p class=\"still\">No still picture: gnuplot did not draw it when the page was "
          "made.</p>\n",
          out);
  }
  memory_free(&svg);
}

/* A figure: interactive charts (drawn by page.js into .charts), with the plot as their static
 * substitute. */
static void write_analysis(struct page *page, const struct analysis *analysis,
                           const struct part *part) {
  FILE *out = page->out;
  const struct product *product = &part->product;
  const bool open = part->showing == SHOW_OPEN;
  fprintf(out, "<section id=\"%s\"><h2>%s</h2>\n%s<figure>", analysis->name, analysis->heading,
          open ? "" : "<details><summary>One value a run: show the figure</summary>");
  if (analysis->charts)
    fprintf(out, "<div class=\"charts\" data-part=\"%s\"></div>\n", analysis->name);
  if (!page->lean || !analysis->charts)
    page_still(out, analysis->name, product->plot.data, product->width, product->height,
               analysis->heading);
  fprintf(out, "<figcaption>%s</figcaption></figure>\n<pre class=\"summary\">", analysis->caption);
  html_text(out, product->summary.data);
  fprintf(out, "</pre>%s</section>\n", open ? "" : "</details>");
}

void page_analyses(struct page *page) {
  for (enum showing showing = SHOW_OPEN; showing >= SHOW_FOLDED; showing--)
    for (size_t i = 0; i < ANALYSES; i++)
      if (page->parts[i].there && page->parts[i].showing == showing)
        write_analysis(page, analyses[i], &page->parts[i]);
}

enum status page_calibration(FILE *out, const json_t *calibration, const struct page_model *model) {
  enum status status = STATUS_OK;
  char *body = NULL;
  size_t size = 0;
  FILE *plot = open_memstream(&body, &size);
  if (plot == NULL) return FAIL(STATUS_RUN, "out of memory for a plot");
  page_calibration_plot(calibration, plot);
  if (fclose(plot) != 0) TRY_FAIL(STATUS_RUN, "out of memory for a plot");
  fputs("<figure><div class=\"charts\" data-part=\"calibration\"></div>", out);
  page_still(out, "calibration", body, 1200, 480, "Calibration of the threshold");
  fprintf(out,
          "<figcaption>Void ratio against the grey threshold, and the histogram of grey values; at "
          "the resolution of the model and of the scan. Dashed: the model&rsquo;s threshold%s."
          "</figcaption></figure>\n",
          model->rule == RULE_MATCHED ? " and the measured void ratio that it was set to give"
          : isfinite(model->void_ratio_measured)
              ? " and the measured void ratio, which it was not set to give"
              : "");
cleanup:
  free(body);
  return status;
}

/* Writes, for each lattice that gave an interval, the processor time so far, the estimate of k and
 * its interval. Returns whether there is any. */
static bool write_estimates(const struct run_levels *levels, FILE *plot) {
  double gone = 0.0;
  bool any = false;
  if (levels->estimate == NULL || levels->low == NULL || levels->high == NULL) return false;
  for (size_t i = 0; i < levels->count; i++) {
    gone += levels->seconds[i];
    const double k = 100.0 * levels->estimate[i];
    if (!isfinite(levels->low[i]) || !isfinite(levels->high[i])) continue;
    fprintf(plot, "%.6g %.8g %.8g %.8g\n", gone, k, k * (1.0 - levels->low[i]),
            k * (1.0 + levels->high[i]));
    any = true;
  }
  return any;
}

/* k on each lattice that the run solved against the processor time, and the result with its
 * interval. */
enum status page_levels(struct page *page) {
  enum status status = STATUS_OK;
  const struct run *run = &page->subject.runs[0];
  const struct run_levels *levels = &run->levels;
  char *body = NULL;
  size_t size = 0;
  double gone = 0.0;
  if (levels->count < 2 || page->subject.n > 1 || !(levels->seconds[0] >= 0.0)) return STATUS_OK;
  FILE *plot = open_memstream(&body, &size);
  if (plot == NULL) return FAIL(STATUS_RUN, "out of memory for a plot");
  fputs("$levels << EOD\n", plot);
  for (size_t i = 0; i < levels->count; i++)
    fprintf(plot, "%.6g %.8g %.4g\n", gone += levels->seconds[i], 100.0 * levels->k[i],
            1e6 * levels->spacing[i]);
  fputs("EOD\n$estimates << EOD\n", plot);
  const bool estimated = write_estimates(levels, plot);
  fprintf(plot,
          "EOD\n$result << EOD\n%.6g %.8g %.8g %.8g\nEOD\nset logscale x\nset xlabel 'Processor "
          "time (s)'\nset ylabel 'k (cm/s)'\nset yrange [0:*]\nset xrange [%.6g:%.6g]\n"
          "set key outside below center vertical maxrows 3 Left reverse height 1\nset offsets 0, "
          "0, graph "
          "0.25, 0\n"
          "plot $levels using 1:2 with linespoints pointtype 7 linewidth 1.8 linecolor rgb '%s' "
          "title 'each lattice', $levels using 1:2:(sprintf('%%.3g µm', $3)) with labels left "
          "rotate by 40 offset 0.2,0.6 notitle, %s%s%s$result using 1:2:3:4 with yerrorbars "
          "pointtype 5 linewidth 2 linecolor "
          "rgb '%s' title 'result, 95 %%'\n",
          gone, 100.0 * run->k, 100.0 * run->k_low, 100.0 * run->k_high, 0.6 * levels->seconds[0],
          4.0 * gone, plot_colours[0],
          estimated
              ? "$estimates using 1:2:3:4 with yerrorbars pointtype 4 linewidth 1.2 linecolor "
                "rgb '"
              : "",
          estimated ? plot_colours[2] : "",
          estimated ? "' title 'estimate so far, resolution alone', " : "", plot_colours[1]);
  if (fclose(plot) != 0) TRY_FAIL(STATUS_RUN, "out of memory for a plot");
  fputs("<section id=\"levels\"><h2>Accuracy and its cost</h2><figure>", page->out);
  page_still(page->out, "levels", body, 560, 440, "k of each lattice against processor time");
  fputs("<figcaption>k on each lattice, from the coarsest to the finest, against the processor "
        "time of the "
        "lattices so far; what they together say of the limit; and the result with its "
        "interval.</figcaption></figure></section>\n",
        page->out);
cleanup:
  free(body);
  return status;
}

/* Maps of a plane, and the pores that carry half of the flow. */
static enum status write_pictures(struct page *page) {
  enum status status = STATUS_OK;
  FILE *out = page->out;
  if (page->subject.maps) {
    fprintf(out, "<div class=\"maps\"><figure>");
    TRY(map_write(&page->plane, MAP_SPEED, out));
    fprintf(out,
            "<figcaption>Speed, with streamlines of the velocity in the plane %c = %.4g mm. "
            "Outlines: the walls that the flow feels.",
            "xyz"[page->plane.axis], 1e3 * page -> plane.at);
    if (page->plane.soil != NULL) fputs(" Hatched: soil with pores below the voxel.", out);
    lattice_note_write(&page->subject.runs[0], " ", ".", out);
    fputs("</figcaption></figure>\n", out);
    if (page->plane.pressure != NULL && page->plane.pressure_high > 0.0) {
      fprintf(out, "<figure>");
      TRY(map_write(&page->plane, MAP_PRESSURE, out));
      fputs("<figcaption>Pressure in the same plane about its mean, beside what drives the "
            "flow.</figcaption></figure>\n",
            out);
    }
    fputs("</div>\n", out);
  }
  if (page->flow.paths != NULL) {
    fputs("<figure class=\"paths\">", out);
    TRY(paths_write(&page->flow, out));
    fprintf(out,
            "<figcaption>Half of the flow goes through %.2g&nbsp;%% of the pores&rsquo; "
            "volume: the fastest water along the force (blue), among the grains.</figcaption>"
            "</figure>\n",
            100.0 * page->flow.paths_share);
  }
cleanup:
  return status;
}

enum status page_flow_section(struct page *page) {
  enum status status = STATUS_OK;
  FILE *out = page->out;
  if (!page->has_flow) return STATUS_OK;
  fputs("<section id=\"flow\"><h2>Grains and flow</h2>\n", out);
  TRY(write_pictures(page));
  fputs("<figure><div id=\"view\"><div class=\"still3d\">", out);
  TRY(flow_write_still(&page->flow, out));
  const bool flows = page->flow.speed_high > 0.0;
  fprintf(out, "</div></div>\n<figcaption>Grains%s of <em>", flows ? " and streamlines" : "");
  html_text(out, page->subject.runs[0].name);
  if (flows)
    fprintf(out, "</em>, coloured by speed from 0 (light) to %.3g mm/s (dark). ",
            1e3 * page->flow.speed_high);
  else
    fputs("</em>; the water rests. ", out);
  fputs("Drag to turn, wheel or pinch to zoom; the slider cuts the grains.", out);
  lattice_note_write(&page->subject.runs[0], " ", ".", out);
  fputs("</figcaption></figure></section>\n", out);
cleanup:
  return status;
}
