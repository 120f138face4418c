/* Soil with pores below the site size: its share of the flux, and k over its permeability. */
#include <math.h>
#include <stdlib.h>

#include "analyze/plot.h"
#include "analyze/report/page_html.h"
#include "analyze/report/page_internal.h"
#include "common/hdf5_file.h"
#include "common/memory.h"

static const char group[] = "/run/micro";

struct curve {
  size_t count; /* 0: the run has none */
  double *factor, *k, *flux, *slope;
};

static enum status read_curve(struct h5_file *file, struct curve *curve) {
  enum status status = STATUS_OK;
  size_t n;
  if (!h5_exists(file, "/run/micro/factor")) return STATUS_OK;
  TRY(h5_read(file, "/run/micro/factor", H5_F64, 1, &curve->count, &curve->factor));
  TRY(h5_read(file, "/run/micro/k", H5_F64, 1, &n, &curve->k));
  if (n != curve->count) TRY_FAIL(STATUS_INPUT, "%s: %s is damaged", h5_path(file), group);
  TRY(h5_read(file, "/run/micro/flux_share", H5_F64, 1, &n, &curve->flux));
  if (n != curve->count) TRY_FAIL(STATUS_INPUT, "%s: %s is damaged", h5_path(file), group);
  TRY(h5_read(file, "/run/micro/dlnk_dlnk_micro", H5_F64, 1, &n, &curve->slope));
  if (n != curve->count) TRY_FAIL(STATUS_INPUT, "%s: %s is damaged", h5_path(file), group);
cleanup:
  return status;
}

static enum status write_curve(struct page *page, const struct curve *c, double permeability) {
  enum status status = STATUS_OK;
  char *body = NULL;
  size_t size = 0;
  FILE *out = page->out, *plot = open_memstream(&body, &size);
  if (plot == NULL) return FAIL(STATUS_RUN, "out of memory for a plot");
  fputs("$curve << EOD\n", plot);
  for (size_t i = 0; i < c->count; i++)
    fprintf(plot, "%.6g %.8g %.6g\n", c->factor[i] * permeability, 100.0 * c->k[i],
            100.0 * c->flux[i]);
  fprintf(
      plot,
      "EOD\nset logscale x\nset format x '10^{%%L}'\nset xlabel 'permeability of the soil (m^2)'\n"
      "set ylabel 'k (cm/s)'\nset yrange [0:*]\nset y2label 'flux through soil (%%)'\n"
      "set y2range [0:*]\nset y2tics\nset ytics nomirror\nset key outside below\n"
      "plot $curve using 1:2 with linespoints pointtype 7 linewidth 1.8 linecolor rgb '%s' "
      "title 'k', $curve using 1:3 axes x1y2 with linespoints pointtype 5 linewidth 1.4 "
      "dashtype 2 linecolor rgb '%s' title 'flux through soil'\n",
      plot_colours[0], plot_colours[1]);
  if (fclose(plot) != 0) TRY_FAIL(STATUS_RUN, "out of memory for a plot");
  fputs("<figure>", out);
  page_still(out, "micro", body, 760, 420, "k against the permeability of the soil");
  fputs("<figcaption>k, and the share of the flux that goes through soil, against the soil&rsquo;s "
        "permeability (its geometric mean; all of it is changed alike).</figcaption></figure>\n"
        "<div class=\"wide\"><table><thead><tr><th>Permeability of the soil</th><th>k</th><th>Flux "
        "through soil</th><th>d ln k / d ln k<sub>micro</sub></th></tr></thead><tbody>\n",
        out);
  for (size_t i = 0; i < c->count; i++)
    fprintf(out,
            "<tr><td>%.3g m&sup2;</td><td>%.4g cm/s</td><td>%.2g&nbsp;%%</td><td>%.2g</td></tr>\n",
            c->factor[i] * permeability, 100.0 * c->k[i], 100.0 * c->flux[i], c->slope[i]);
  fputs("</tbody></table></div>\n", out);
cleanup:
  free(body);
  return status;
}

bool page_has_soil(const struct page *page) {
  struct h5_file *file = NULL;
  bool has = false;
  if (h5_open(page->subject.runs[0].path, &file) == STATUS_OK)
    has = h5_exists(file, group);
  else
    error_clear();
  h5_close(file);
  return has;
}

enum status page_soil(struct page *page) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  struct curve curve = {0};
  FILE *out = page->out;
  if (!page_has_soil(page)) return STATUS_OK;
  TRY(h5_open(page->subject.runs[0].path, &file));
  TRY(read_curve(file, &curve));
  const double permeability = h5_attribute_or_nan(file, group, "permeability");
  const double slope = h5_attribute_or_nan(file, group, "dlnk_dlnk_micro");
  fprintf(out,
          "<section id=\"soil\"><h2>Soil with pores below the voxel</h2>\n<p>%.2g&nbsp;%% of the "
          "sites are soil of porosity %.2g and permeability %.3g m&sup2; (geometric mean). "
          "%.2g&nbsp;%% of the flux goes through it, and its drag takes %.2g&nbsp;%% of the power "
          "that drives the flow: 10&nbsp;%% more permeability of the soil is %.2g&nbsp;%% more "
          "k.</p>\n",
          100.0 * h5_attribute_or_nan(file, group, "sites"),
          h5_attribute_or_nan(file, group, "porosity"), permeability,
          100.0 * h5_attribute_or_nan(file, group, "flux_share"), 100.0 * slope, 10.0 * slope);
  if (curve.count > 1) TRY(write_curve(page, &curve, permeability));
  fputs("</section>\n", out);
cleanup:
  memory_free(&curve.factor);
  memory_free(&curve.k);
  memory_free(&curve.flux);
  memory_free(&curve.slope);
  h5_close(file);
  return status;
}
