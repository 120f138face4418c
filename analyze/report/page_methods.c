#include "analyze/report/page_methods.h"

#include <math.h>
#include <string.h>

#include "analyze/report/page_html.h"
#include "analyze/tensor.h"
#include "common/hdf5_file.h"
#include "common/kernel.h"
#include "common/provenance.h"

/* A reference is listed if a sentence cites it, in the order of citation. */
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
    {"richards",
     "Richards LA (1931). Capillary conduction of liquids through porous mediums. Physics "
     "1, 318-333."},
    {"celia", "Celia MA, Bouloutas ET, Zarba RL (1990). A general mass-conservative numerical "
              "solution for the unsaturated flow equation. Water Resour. Res. 26, 1483-1496."},
    {"genuchten",
     "van Genuchten MT (1980). A closed-form equation for predicting the hydraulic conductivity of "
     "unsaturated soils. Soil Sci. Soc. Am. J. 44, 892-898."},
    {"mualem", "Mualem Y (1976). A new model for predicting the hydraulic conductivity of "
               "unsaturated porous media. Water Resour. Res. 12, 513-522."},
    {"white", "White KP (1997). An effective truncation heuristic for bias reduction in simulation "
              "output. Simulation 69, 323-334."},
    {"flegal", "Flegal JM, Jones GL (2010). Batch means and spectral variance estimators in Markov "
               "chain Monte Carlo. Ann. Stat. 38, 1034-1070."},
    {"otsu", "Otsu N (1979). A threshold selection method from gray-level histograms. IEEE Trans. "
             "Syst. Man Cybern. 9, 62-66."},
    {"celik",
     "Celik IB, Ghia U, Roache PJ, Freitas CJ (2008). Procedure for estimation and reporting "
     "of uncertainty due to discretization in CFD applications. J. Fluids Eng. 130, 078001."},
    {"hoeting",
     "Hoeting JA, Madigan D, Raftery AE, Volinsky CT (1999). Bayesian model averaging: a "
     "tutorial. Stat. Sci. 14, 382-417."},
    {"brenner", "Brenner H (1980). Dispersion resulting from flow through spatially periodic "
                "porous media. Phil. Trans. R. Soc. Lond. A 297, 81-133."},
    {"bijeljic", "Bijeljic B, Muggeridge AH, Blunt MJ (2004). Pore-scale modeling of longitudinal "
                 "dispersion. Water Resour. Res. 40, W11501."},
};
enum { REFERENCES = sizeof references / sizeof *references };
struct cited {
  size_t count, reference[REFERENCES];
};

static void cite(FILE *stream, const char *key, struct cited *cited) {
  size_t n = 0;
  while (n < cited->count && strcmp(references[cited->reference[n]].key, key) != 0) n++;
  if (n == cited->count)
    for (size_t i = 0; i < REFERENCES; i++)
      if (strcmp(references[i].key, key) == 0) cited->reference[cited->count++] = i;
  fprintf(stream, " [%zu]", n + 1);
}

/* Reynolds number above which inertia is mentioned: creeping flow has none. */
#define INERTIA_REYNOLDS 0.1

/* Axes along which the sample is mirrored, and closed sides. The mirrored sides of a model are
 * those along x and y. */
static void write_sides(const struct run *run, const struct page_model *model, FILE *stream) {
  bool sides = strcmp(model->sides, "mirrored") == 0;
  char axes[3] = "";
  size_t count = 0;
  for (int d = 0; d < 3; d++)
    if (model->mirror_axis[0] == "xyz"[d] || (sides && d < 2) || run->mirrored[d])
      axes[count++] = "xyz"[d];
  for (size_t i = 0; i < count; i++)
    fprintf(stream, "%s%c",
            i == 0           ? "; it is mirrored along "
            : i + 1 == count ? " and "
                             : ", ",
            axes[i]);
  if (strcmp(model->sides, "closed") == 0) fputs("; its sides are walls", stream);
}

/* Origin of the geometry, as far as the model file describes it. */
static void write_geometry(const struct run *run, const struct page_model *model,
                           struct cited *cited, FILE *stream) {
  if (!model->named) return;
  if (!model->found) {
    fputs(model->other ? ", from a model file that was changed or replaced after the run"
                       : ", from a model file that could not be read when this page was made",
          stream);
    return;
  }
  if (!model->scanned) {
    fputs(", from a voxel model", stream);
    return;
  }
  fputs(", made by ct2model from an image", stream);
  switch (model->rule) {
  case RULE_MATCHED:
    fprintf(stream,
            " whose grey threshold (%.4g) was set so that the model has the void ratio measured on "
            "the specimen, %.4g",
            model->threshold, model->void_ratio_measured);
    if (fabs(model->void_ratio / model->void_ratio_measured - 1.0) > 0.01)
      fprintf(stream, " (it has %.4g)", model->void_ratio);
    break;
  case RULE_OTSU:
    fprintf(stream, " at the grey threshold of Otsu&rsquo;s method");
    cite(stream, "otsu", cited);
    fprintf(stream, ", %.4g, which gives a void ratio of %.4g", model->threshold,
            model->void_ratio);
    break;
  case RULE_GIVEN:
    fprintf(stream, " at a given grey threshold of %.4g, which gives a void ratio of %.4g",
            model->threshold, model->void_ratio);
    break;
  case RULE_LABELS:
    fprintf(stream, " that was segmented before; the model has a void ratio of %.4g",
            model->void_ratio);
    break;
  default:
    fprintf(stream, "; it has a void ratio of %.4g", model->void_ratio);
  }
  if ((model->rule == RULE_OTSU || model->rule == RULE_GIVEN || model->rule == RULE_LABELS)) {
    if (isfinite(model->void_ratio_measured))
      fprintf(stream, "; %.4g was measured on the specimen", model->void_ratio_measured);
    else
      fputs("; no measured void ratio was given", stream);
  }
  write_sides(run, model, stream);
}

/* Smoothing of the grain surface before the run, as needed to repeat it. */
static void write_surface(const struct page_model *model, FILE *stream) {
  if (model->rule == RULE_LABELS && model->smoothing > 0.0) {
    fprintf(
        stream,
        "Walls are drawn through the labels smoothed by a Gaussian with a standard deviation of "
        "%.4g &micro;m",
        1e6 * model->smoothing);
    if (model->smoothing_even > 0.0)
      fprintf(stream, ", where they are even enough of %.4g &micro;m without its second moment",
              1e6 * model->smoothing_even);
    fputs(", at the volume of their pores. ", stream);
  }
  if (model->blur_removed)
    fprintf(stream,
            "The scanner&rsquo;s blur, by the edges of the scan a Gaussian with a standard "
            "deviation of %.4g &micro;m, was taken out of the surface. ",
            1e6 * model->blur);
}

static void write_solver(const struct run *run, struct cited *cited, FILE *stream) {
  if (strcmp(run->method, "stokes") == 0) {
    fputs(
        "The steady creeping flow was solved with the smoothed particle hydrodynamics operators of",
        stream);
    cite(stream, "morris", cited);
    fputs(" on the lattice itself. ", stream);
    if (run->reynolds > INERTIA_REYNOLDS)
      fprintf(stream, "Inertia is left out, at a Reynolds number of %.2g. ", run->reynolds);
  } else if (strcmp(run->method, "isph") == 0) {
    fputs("The unified Navier-Stokes and extended Darcy equations were integrated by stabilised "
          "incompressible smoothed particle hydrodynamics",
          stream);
    cite(stream, "morimoto", cited);
    cite(stream, "akbari", cited);
    fputs(". ", stream);
  } else if (strcmp(run->method, "richards") == 0) {
    fputs("The equation of Richards for water in soil that is not full", stream);
    cite(stream, "richards", cited);
    fputs(" was solved in its mass-conserving form", stream);
    cite(stream, "celia", cited);
    fputs(" on fixed sites, with the curves of van Genuchten", stream);
    cite(stream, "genuchten", cited);
    fputs(" and Mualem", stream);
    cite(stream, "mualem", cited);
    fputs(". ", stream);
  } else if (strcmp(run->method, "wcsph") == 0) {
    fprintf(stream,
            "Weakly compressible smoothed particle hydrodynamics with a %s and the viscosity of",
            /* The default of older runs. */
            kernel_in_words(*run->kernel ? run->kernel : "quintic"));
    cite(stream, "morris", cited);
    fputs(" was integrated in time. ", stream);
  }
}

static void write_walls(const struct run *run, const struct page_model *model, struct cited *cited,
                        FILE *stream) {
  if (strcmp(run->wall, "adami") == 0) {
    fputs("Grain surfaces carry dummy velocities", stream);
    cite(stream, "adami", cited);
    fputs(". ", stream);
  } else if (strcmp(run->wall, "subvoxel") == 0) {
    fputs("No slip holds at the wall itself, by image velocities from the distance to it, after",
          stream);
    cite(stream, "basa", cited);
    if (model->found)
      fprintf(stream, "; walls are %s",
              model->wall_distance    ? "the model&rsquo;s signed distances to the grain surface"
              : model->grain_fraction ? "found from the grain fraction of the voxels"
                                      : "the faces of the voxels");
    fputs(". ", stream);
  } else if (strcmp(run->wall, "frozen") == 0) {
    fputs("Grains are frozen fluid particles after", stream);
    cite(stream, "saomoto", cited);
    fputs(", which widens every gap by one spacing. ", stream);
  }
}

static void write_soil(const struct page_model *model, FILE *stream) {
  if (model->soil)
    fputs("Soil with pores below the voxel is solved together with the open pores, as a porous "
          "medium with a drag of its own permeability. ",
          stream);
}

/* Lattices of a single run that solved several. */
static void write_lattices(const struct run *run, struct cited *cited, FILE *stream) {
  const struct run_levels *l = &run->levels;
  fprintf(stream,
          "The error of resolution is that of the limit of %zu lattices with spacings from %.4g to "
          "%.4g &micro;m, averaged over the orders of convergence",
          l->count, 1e6 * l->spacing[0], 1e6 * l->spacing[l->count - 1]);
  cite(stream, "hoeting", cited);
  fputs(strcmp(run->method, "stokes") == 0 ? "; the permeability is that limit. " : ". ", stream);
}

static void write_result(const struct run *run, const struct methods_facts *facts,
                         struct cited *cited, FILE *stream) {
  if (!facts->permeable) return;
  if (facts->averaged) {
    fputs("The Darcy velocity was averaged after the start-up, whose end is given by the marginal "
          "standard "
          "error rule",
          stream);
    cite(stream, "white", cited);
    fputs("; its error is from batch means", stream);
    cite(stream, "flegal", cited);
    fputs(". ", stream);
  }
  fputs(facts->fitted
            ? "Permeability is the slope of the superficial velocity against the hydraulic gradient"
            : "Permeability is the superficial velocity over the hydraulic gradient",
        stream);
  if (facts->extrapolated) fputs(", extrapolated over the spacings of the runs", stream);
  fputs("; errors are 95&nbsp;% half widths. ", stream);
  if (facts->index) {
    fputs("The error of resolution is a grid convergence index", stream);
    cite(stream, "celik", cited);
    fputs(". ", stream);
  }
  if (facts->lattices && run->levels.count > 1) write_lattices(run, cited, stream);
}

/* Method by which the dispersion coefficients of solutes were determined. */
static enum status write_solutes(const struct subject *subject, struct cited *cited, FILE *stream) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  bool closure = false, walk = false;
  if (subject->solute_count == 0) return STATUS_OK;
  for (size_t i = 0; i < subject->solute_count; i++) {
    TRY(h5_open(subject->solutes[i], &file));
    closure |= h5_exists(file, "/solute/closure");
    walk |= h5_exists(file, "/solute/walk");
    h5_close(file);
    file = NULL;
  }
  fputs("How a solute disperses in the flow was found ", stream);
  if (closure) {
    fputs("from the closure problem of its transport", stream);
    cite(stream, "brenner", cited);
    fputs(" on finite volumes", stream);
  }
  if (walk) {
    fputs(closure ? ", and by random walks" : "by random walks", stream);
    cite(stream, "bijeljic", cited);
  }
  fputs(". ", stream);
cleanup:
  h5_close(file);
  return status;
}

/* Whether the sites are cubic; lattices with their own spacings fit the body in each direction
 * separately. */
static bool run_is_cubic(const struct run *run) {
  bool cubic = true;
  for (int d = 1; d < 3; d++)
    cubic = cubic && (run->size[d] <= 1 || fabs(run->spacing[d] / run->spacing[0] - 1.0) < 5e-4);
  return cubic;
}

enum status page_methods(const struct subject *subject, const struct page_model *model,
                         const struct methods_facts *facts, FILE *stream) {
  enum status status = STATUS_OK;
  struct cited cited = {0};
  struct tensor tensor;
  bool has_tensor;
  const struct run *run = &subject->runs[0];
  fprintf(stream, "<p>Flow was computed with Tosui %s", TOSUI_VERSION);
  cite(stream, "tosui", &cited);
  const bool coarse = run->spacing[0] > 1e-3;
  const double unit = coarse ? 1e3 : 1e6;
  fprintf(stream, " on a lattice of %zu &times; %zu &times; %zu points of %.4g", run->size[0],
          run->size[1], run->size[2], unit * run->spacing[0]);
  if (!run_is_cubic(run))
    fprintf(stream, " &times; %.4g &times; %.4g", unit * run->spacing[1], unit * run->spacing[2]);
  fputs(coarse ? " mm" : " &micro;m", stream);
  write_geometry(run, model, &cited, stream);
  fputs(". ", stream);
  write_surface(model, stream);
  fprintf(stream, "The fluid had a density of %g kg/m&sup3; and a viscosity of %g Pa&nbsp;s. ",
          run->density, run->viscosity);
  write_solver(run, &cited, stream);
  write_walls(run, model, &cited, stream);
  write_soil(model, stream);
  if (subject->n > 1)
    fprintf(stream, "%zu runs entered this page; lattice, model and fluid are the first&rsquo;s. ",
            subject->n);
  write_result(run, facts, &cited, stream);
  TRY(tensor_read(run, &tensor, &has_tensor));
  if (has_tensor)
    fputs("The tensor of permeability is from three flows, each driven along one of x, y and z. ",
          stream);
  TRY(write_solutes(subject, &cited, stream));
  fputs("</p>\n<ol class=\"references\">\n", stream);
  for (size_t i = 0; i < cited.count; i++)
    fprintf(stream, "<li>%s</li>\n", references[cited.reference[i]].text);
  fputs("</ol>\n", stream);
cleanup:
  return status;
}
