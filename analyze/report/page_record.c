#include "analyze/report/page_record.h"

#include <math.h>
#include <string.h>

#include "analyze/report/page_html.h"
#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/provenance.h"

struct texts {
  size_t count;
  char **text;
};

static enum status read_texts(struct h5_file *file, const char *name, struct texts *texts) {
  if (!h5_exists(file, name)) return STATUS_OK;
  return h5_read_texts(file, name, &texts->count, &texts->text);
}

static const char *text_at(const struct texts *texts, size_t i) {
  return i < texts->count ? texts->text[i] : "";
}

static void cell(FILE *stream, const char *text) {
  fputs("<td>", stream);
  html_text(stream, text);
  fputs("</td>", stream);
}

enum { NAME, STATE, REASON, MODEL, CITATION, EFFECT_TEXTS };

enum status page_effects(const struct run *run, FILE *stream) {
  enum status status = STATUS_OK;
  static const char *const columns[EFFECT_TEXTS] = {"name", "state", "reason", "model", "citation"};
  struct texts effects[EFFECT_TEXTS] = {0}, passes = {0};
  double *share = NULL, *seconds = NULL;
  size_t shares = 0, times = 0;
  struct h5_file *file = NULL;
  TRY(h5_open(run->path, &file));
  for (int i = 0; i < EFFECT_TEXTS; i++) {
    char name[64];
    snprintf(name, sizeof name, "/run/effects/%s", columns[i]);
    TRY(read_texts(file, name, &effects[i]));
  }
  if (h5_exists(file, "/run/effects/share"))
    TRY(h5_read(file, "/run/effects/share", H5_F64, 1, &shares, &share));
  if (h5_exists(file, "/run/timing/seconds"))
    TRY(h5_read(file, "/run/timing/seconds", H5_F64, 1, &times, &seconds));
  TRY(read_texts(file, "/run/timing/name", &passes));

  fputs("<div class=\"wide\"><table><thead><tr><th>Effect</th><th></th><th>Why</th><th>Model</th>"
        "<th>Time</th></tr></thead><tbody>\n",
        stream);
  for (size_t i = 0; i < effects[NAME].count; i++) {
    bool on = strcmp(text_at(&effects[STATE], i), "on") == 0;
    fprintf(stream, "<tr class=\"%s\">", on ? "on" : "off");
    cell(stream, effects[NAME].text[i]);
    cell(stream, text_at(&effects[STATE], i));
    cell(stream, text_at(&effects[REASON], i));
    fputs("<td>", stream);
    html_text(stream, text_at(&effects[MODEL], i));
    if (text_at(&effects[CITATION], i)[0] != '\0') {
      fputs(" <span class=\"cite\">", stream);
      html_text(stream, text_at(&effects[CITATION], i));
      fputs("</span>", stream);
    }
    if (i < shares && share[i] > 0)
      fprintf(stream, "</td><td class=\"number\">%.1f&nbsp;%%</td></tr>\n", 100.0 * share[i]);
    else
      fputs("</td><td></td></tr>\n", stream);
  }
  fputs("</tbody></table></div>\n", stream);
  if (passes.count > 0)
    fputs("<table class=\"facts\"><thead><tr><th>Pass</th><th "
          "class=\"number\">Seconds</th></tr></thead>"
          "<tbody>\n",
          stream);
  for (size_t i = 0; i < passes.count && i < times; i++) {
    fputs("<tr>", stream);
    cell(stream, passes.text[i]);
    fprintf(stream, "<td class=\"number\">%.3g</td></tr>\n", seconds[i]);
  }
  if (passes.count > 0) fputs("</tbody></table>\n", stream);
cleanup:
  for (int i = 0; i < EFFECT_TEXTS; i++) h5_free_texts(effects[i].count, &effects[i].text);
  h5_free_texts(passes.count, &passes.text);
  memory_free(&share);
  memory_free(&seconds);
  h5_close(file);
  return status;
}

/* One attribute as a row, whatever it is: a number, a few numbers, or text. */
static void attribute_row(struct h5_file *file, const char *object, const char *name,
                          FILE *stream) {
  double numbers[3];
  char *text = NULL;
  fprintf(stream, "<tr><th>");
  html_text(stream, name);
  fputs("</th><td>", stream);
  if (h5_read_attribute(file, object, name, H5_F64, 1, numbers) == STATUS_OK)
    fprintf(stream, "%.10g", numbers[0]);
  else {
    error_clear();
    if (h5_read_attribute(file, object, name, H5_F64, 3, numbers) == STATUS_OK)
      fprintf(stream, "%.8g, %.8g, %.8g", numbers[0], numbers[1], numbers[2]);
    else {
      error_clear();
      if (h5_read_attribute_text(file, object, name, &text) == STATUS_OK)
        html_text(stream, text);
      else
        error_clear();
    }
  }
  memory_free(&text);
  fputs("</td></tr>\n", stream);
}

static enum status attribute_rows(struct h5_file *file, const char *object, FILE *stream) {
  enum status status = STATUS_OK;
  size_t count = 0;
  char **names = NULL;
  TRY(h5_list_attributes(file, object, &count, &names));
  for (size_t i = 0; i < count; i++) attribute_row(file, object, names[i], stream);
cleanup:
  h5_free_texts(count, &names);
  return status;
}

enum status page_provenance(const struct run *run, FILE *stream) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  struct texts files = {0}, hashes = {0};
  char *scene = NULL;
  TRY(h5_open(run->path, &file));
  fputs("<details><summary>", stream);
  html_text(stream, run->name);
  fputs(" <span class=\"path\">", stream);
  html_text(stream, run->path);
  fputs("</span></summary>\n<div class=\"wide\"><table class=\"facts\"><tbody>\n", stream);
  if (h5_exists(file, "/provenance")) {
    TRY(attribute_rows(file, "/provenance", stream));
    TRY(read_texts(file, "/provenance/input_files", &files));
    TRY(read_texts(file, "/provenance/input_hashes", &hashes));
  }
  for (size_t i = 0; i < files.count; i++) {
    fputs("<tr><th>input, XXH3</th><td>", stream);
    html_text(stream, files.text[i]);
    fputs("<br><code>", stream);
    html_text(stream, text_at(&hashes, i));
    fputs("</code></td></tr>\n", stream);
  }
  TRY(attribute_rows(file, "/run", stream));
  fputs("</tbody></table></div>\n", stream);
  if (h5_exists(file, "/run/scene")) {
    TRY(h5_read_text(file, "/run/scene", &scene));
    fputs("<pre>", stream);
    html_text(stream, scene);
    fputs("</pre>\n", stream);
  }
  fputs("</details>\n", stream);
cleanup:
  h5_free_texts(files.count, &files.text);
  h5_free_texts(hashes.count, &hashes.text);
  memory_free(&scene);
  h5_close(file);
  return status;
}

/* A reference is listed when a run calls for it. */
struct reference {
  const char *key, *text;
};
static const struct reference references[] = {
    {"tosui", "Tosui " TOSUI_VERSION ", seepage through porous media from CT images by smoothed "
              "particle hydrodynamics (ct2model, sphsolve, analyze)."},
    {"morris", "Morris JP, Fox PJ, Zhu Y (1997). Modeling low Reynolds number incompressible flows "
               "using SPH. J. Comput. Phys. 136, 214-226."},
    {"adami", "Adami S, Hu XY, Adams NA (2012). A generalized wall boundary condition for smoothed "
              "particle hydrodynamics. J. Comput. Phys. 231, 7057-7075."},
    {"basa",
     "Basa M, Quinlan NJ, Lastiwka M (2009). Robustness and accuracy of SPH formulations for "
     "viscous flow. Int. J. Numer. Meth. Fluids 60, 1127-1148."},
    {"saomoto",
     "Saomoto H, Matsushima T, Yamada Y, Hatano Y (2006). Development of digital Toyoura "
     "porous model and porous media flow simulation using SPH (in Japanese)."},
    {"akbari",
     "Akbari H (2014). Modified moving particle method for modeling wave interaction with "
     "multi layered porous structures. Coastal Eng. 89, 1-19."},
    {"morimoto", "Morimoto T, Asai M, Kasama K, Fujisawa K, Imoto Y (2015). Unified numerical "
                 "analysis between the extended Darcy's law and Navier-Stokes equation by using "
                 "stabilized ISPH method (in Japanese). J. JSCE Ser. A2 70, I_213-I_221."},
    {"white", "White KP (1997). An effective truncation heuristic for bias reduction in simulation "
              "output. Simulation 69, 323-334."},
    {"flegal", "Flegal JM, Jones GL (2010). Batch means and spectral variance estimators in Markov "
               "chain Monte Carlo. Ann. Stat. 38, 1034-1070."},
    {"celik",
     "Celik IB, Ghia U, Roache PJ, Freitas CJ (2008). Procedure for estimation and reporting "
     "of uncertainty due to discretization in CFD applications. J. Fluids Eng. 130, 078001."},
};

static void cite(FILE *stream, const char *key, bool used[]) {
  for (size_t i = 0; i < sizeof references / sizeof *references; i++)
    if (strcmp(references[i].key, key) == 0) {
      used[i] = true;
      fprintf(stream, " [%zu]", i + 1);
    }
}

enum status page_methods(const struct run *runs, size_t n, FILE *stream) {
  bool used[sizeof references / sizeof *references] = {false};
  const struct run *run = &runs[0];
  fprintf(stream, "<p>Flow was computed with Tosui %s", TOSUI_VERSION);
  cite(stream, "tosui", used);
  fprintf(stream, " on a lattice of %zu &times; %zu &times; %zu sites of %.4g &micro;m",
          run->size[0], run->size[1], run->size[2], 1e6 * run->spacing[0]);
  if (run->model_path[0] != '\0')
    fputs(", made from CT slices whose grey threshold was set so that the model has the void ratio "
          "measured on the specimen",
          stream);
  fprintf(stream, ". The fluid had a density of %g kg/m&sup3; and a viscosity of %g Pa&nbsp;s. ",
          run->density, run->viscosity);
  if (strcmp(run->method, "stokes") == 0) {
    fputs(
        "The steady creeping flow was solved with the smoothed particle hydrodynamics operators of",
        stream);
    cite(stream, "morris", used);
    fputs(" on the lattice itself. ", stream);
  } else if (strcmp(run->method, "isph") == 0) {
    fputs("The unified Navier-Stokes and extended Darcy equations were integrated by stabilised "
          "incompressible smoothed particle hydrodynamics",
          stream);
    cite(stream, "morimoto", used);
    cite(stream, "akbari", used);
    fputs(". ", stream);
  } else {
    fputs("Weakly compressible smoothed particle hydrodynamics with a quintic spline and the "
          "viscosity of",
          stream);
    cite(stream, "morris", used);
    fputs(" was integrated in time. ", stream);
  }
  if (strcmp(run->wall, "adami") == 0) {
    fputs("Grain surfaces carry dummy velocities", stream);
    cite(stream, "adami", used);
    fputs(". ", stream);
  } else if (strcmp(run->wall, "subvoxel") == 0) {
    fputs("No slip holds at the grain surface itself, by image velocities from the signed wall "
          "distance after",
          stream);
    cite(stream, "basa", used);
    fputs(". ", stream);
  } else if (strcmp(run->wall, "frozen") == 0) {
    fputs("Grains are frozen fluid particles after", stream);
    cite(stream, "saomoto", used);
    fputs(", which widens every gap by one spacing. ", stream);
  }
  fprintf(stream, "%zu run%s entered this page. ", n, n > 1 ? "s" : "");
  if (strcmp(run->method, "stokes") != 0) {
    fputs("The Darcy velocity was averaged after the steady point given by the marginal standard "
          "error rule",
          stream);
    cite(stream, "white", used);
    fputs("; its error is from batch means", stream);
    cite(stream, "flegal", used);
    fputs(". ", stream);
  }
  fputs("Permeability is the slope of the superficial velocity against the hydraulic gradient; "
        "errors are 95&nbsp;% half widths. ",
        stream);
  fputs("Errors of resolution follow the grid convergence index", stream);
  cite(stream, "celik", used);
  fputs(" where runs at several spacings are given.</p>\n<ol class=\"references\">\n", stream);
  for (size_t i = 0; i < sizeof references / sizeof *references; i++)
    if (used[i]) fprintf(stream, "<li value=\"%zu\">%s</li>\n", i + 1, references[i].text);
  fputs("</ol>\n", stream);
  return STATUS_OK;
}
