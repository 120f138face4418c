#include "analyze/report/page_methods.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

#include "analyze/product.h"
#include "analyze/solute_flow.h"
#include "analyze/tensor.h"
#include "common/json_number.h"
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
    {"aavatsmark",
     "Aavatsmark I, Barkve T, Boe O, Mannseth T (1996). Discretization on non-orthogonal, "
     "quadrilateral grids for inhomogeneous, anisotropic media. J. Comput. Phys. 127, 2-14."},
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
/* The paragraph as it grows, and the references cited so far. */
struct prose {
  FILE *stream;
  size_t count, reference[REFERENCES];
};

static size_t cite(struct prose *prose, const char *key, size_t length) {
  size_t n = 0;
  while (n < prose->count && strncmp(references[prose->reference[n]].key, key, length) != 0) n++;
  for (size_t i = 0; n == prose->count && i < REFERENCES; i++)
    if (strncmp(references[i].key, key, length) == 0) prose->reference[prose->count++] = i;
  return n + 1;
}

/* Writes text, in which [key] becomes the number of that reference. */
__attribute__((format(printf, 2, 3))) static void say(struct prose *prose, const char *format,
                                                      ...) {
  char text[600];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  for (const char *at = text; *at != '\0';) {
    const size_t plain = strcspn(at, "[");
    fwrite(at, 1, plain, prose->stream);
    at += plain;
    if (*at == '\0') break;
    const size_t length = strcspn(at + 1, "]");
    fprintf(prose->stream, "[%zu]", cite(prose, at + 1, length));
    at += length + 2;
  }
}

/* Reynolds number above which inertia is mentioned: creeping flow has none. */
#define INERTIA_REYNOLDS 0.1

/* Axes along which the sample is mirrored, and closed sides. The mirrored sides of a model are
 * those along x and y. */
static void write_sides(const struct run *run, const struct page_model *model,
                        struct prose *prose) {
  bool sides = strcmp(model->sides, "mirrored") == 0;
  char axes[3] = "";
  size_t count = 0;
  for (int d = 0; d < 3; d++)
    if (model->mirror_axis[0] == "xyz"[d] || (sides && d < 2) || run->mirrored[d])
      axes[count++] = "xyz"[d];
  for (size_t i = 0; i < count; i++)
    say(prose, "%s%c",
        i == 0           ? "; it is mirrored along "
        : i + 1 == count ? " and "
                         : ", ",
        axes[i]);
  if (strcmp(model->sides, "closed") == 0) say(prose, "; its sides are walls");
}

/* Origin of the geometry, as far as the model file describes it. */
static void write_geometry(const struct run *run, const struct page_model *model,
                           struct prose *prose) {
  if (!model->named) return;
  if (!model->found) {
    say(prose, model->other ? ", from a model file that was changed or replaced after the run"
                            : ", from a model file that could not be read when this page was made");
    return;
  }
  if (!model->scanned) {
    say(prose, ", from a voxel model");
    return;
  }
  say(prose, ", made by ct2model from an image");
  switch (model->rule) {
  case RULE_MATCHED:
    say(prose,
        " whose grey threshold (%.4g) was set so that the model has the void ratio measured on "
        "the specimen, %.4g",
        model->threshold, model->void_ratio_measured);
    if (fabs(model->void_ratio / model->void_ratio_measured - 1.0) > 0.01)
      say(prose, " (it has %.4g)", model->void_ratio);
    break;
  case RULE_OTSU:
    say(prose,
        " at the grey threshold of Otsu's method [otsu], %.4g, which gives a void ratio of %.4g",
        model->threshold, model->void_ratio);
    break;
  case RULE_GIVEN:
    say(prose, " at a given grey threshold of %.4g, which gives a void ratio of %.4g",
        model->threshold, model->void_ratio);
    break;
  case RULE_LABELS:
    say(prose, " that was segmented before; the model has a void ratio of %.4g", model->void_ratio);
    break;
  default:
    say(prose, "; it has a void ratio of %.4g", model->void_ratio);
  }
  if ((model->rule == RULE_OTSU || model->rule == RULE_GIVEN || model->rule == RULE_LABELS)) {
    if (isfinite(model->void_ratio_measured))
      say(prose, "; %.4g was measured on the specimen", model->void_ratio_measured);
    else
      say(prose, "; no measured void ratio was given");
  }
  write_sides(run, model, prose);
}

/* Smoothing of the grain surface before the run, as needed to repeat it. */
static void write_surface(const struct page_model *model, struct prose *prose) {
  if (model->rule == RULE_LABELS && model->smoothing > 0.0) {
    say(prose,
        "Walls are drawn through the labels smoothed by a Gaussian with a standard deviation of "
        "%.4g µm",
        1e6 * model->smoothing);
    if (model->smoothing_even > 0.0)
      say(prose, ", where they are even enough of %.4g µm without its second moment",
          1e6 * model->smoothing_even);
    say(prose, ", at the volume of their pores. ");
  }
  if (model->blur_removed)
    say(prose,
        "The scanner's blur, by the edges of the scan a Gaussian with a standard "
        "deviation of %.4g µm, was taken out of the surface. ",
        1e6 * model->blur);
}

static void write_solver(const struct run *run, struct prose *prose) {
  if (strcmp(run->method, "stokes") == 0) {
    say(prose, "The steady creeping flow was solved with the smoothed particle hydrodynamics "
               "operators of [morris] on the lattice itself. ");
    if (run->reynolds > INERTIA_REYNOLDS)
      say(prose, "Inertia is left out, at a Reynolds number of %.2g. ", run->reynolds);
  } else if (strcmp(run->method, "isph") == 0) {
    say(prose, "The unified Navier-Stokes and extended Darcy equations were integrated by "
               "stabilised incompressible smoothed particle hydrodynamics [morimoto] [akbari]. ");
  } else if (strcmp(run->method, "darcy") == 0) {
    say(prose,
        "Darcy's law, with Forchheimer's term where a soil has one, was solved for soil that "
        "stays full of water by multi-point finite volumes on fixed points [aavatsmark]. ");
  } else if (strcmp(run->method, "richards") == 0) {
    say(prose, "The equation of Richards for water in soil that is not full [richards] was solved "
               "in its mass-conserving form [celia] on fixed points, with the curves of van "
               "Genuchten [genuchten] and Mualem [mualem]. ");
  } else if (strcmp(run->method, "wcsph") == 0) {
    say(prose,
        "Weakly compressible smoothed particle hydrodynamics with a %s and the viscosity of "
        "[morris] was "
        "integrated in time. ",
        /* The default of older runs. */
        kernel_in_words(*run->kernel ? run->kernel : "quintic"));
  }
}

static void write_walls(const struct run *run, const struct page_model *model,
                        struct prose *prose) {
  if (strcmp(run->wall, "adami") == 0) {
    say(prose, "Grain surfaces carry dummy velocities [adami]. ");
  } else if (strcmp(run->wall, "subvoxel") == 0) {
    say(prose, "No slip holds at the wall itself, by image velocities from the distance to it, "
               "after [basa]");
    if (model->found)
      say(prose, "; walls are %s",
          model->wall_distance    ? "the model's signed distances to the grain surface"
          : model->grain_fraction ? "found from the grain fraction of the voxels"
                                  : "the faces of the voxels");
    say(prose, ". ");
  } else if (strcmp(run->wall, "frozen") == 0) {
    say(prose, "Grains are frozen fluid particles after [saomoto], which widens every gap by one "
               "spacing. ");
  }
}

/* Lattices of a single run that solved several. */
static void write_lattices(const struct run *run, struct prose *prose) {
  const struct run_levels *l = &run->levels;
  say(prose,
      "The error of resolution is that of the limit of %zu lattices with spacings from %.4g to "
      "%.4g µm, averaged over the orders of convergence",
      l->count, 1e6 * l->spacing[0], 1e6 * l->spacing[l->count - 1]);
  say(prose, " [hoeting]");
  say(prose, strcmp(run->method, "stokes") == 0 ? "; the permeability is that limit. " : ". ");
}

static void write_result(const struct run *run, const struct methods_facts *facts,
                         struct prose *prose) {
  if (!facts->permeable) return;
  if (facts->averaged) {
    say(prose, "The Darcy velocity was averaged after the start-up, whose end is given by the "
               "marginal standard error rule [white]; its error is from batch means [flegal]. ");
  }
  say(prose,
      facts->fitted
          ? "Permeability is the slope of the superficial velocity against the hydraulic gradient"
          : "Permeability is the superficial velocity over the hydraulic gradient");
  if (facts->extrapolated) say(prose, ", extrapolated over the spacings of the runs");
  say(prose, "; errors are 95 %% half widths. ");
  if (facts->index) say(prose, "The error of resolution is a grid convergence index [celik]. ");
  if (facts->lattices && run->levels.count > 1) write_lattices(run, prose);
}

/* Method by which the dispersion coefficients of solutes were determined. */
static void write_solutes(const struct subject *subject, struct prose *prose) {
  const bool closure = solute_any_has(subject->solutes, subject->solute_count, "/solute/closure");
  const bool walk = solute_any_has(subject->solutes, subject->solute_count, SOLUTE_WALK);
  if (subject->solute_count == 0) return;
  say(prose, "How a solute disperses in the flow was found ");
  if (closure) say(prose, "from the closure problem of its transport [brenner] on finite volumes");
  if (walk) say(prose, closure ? ", and by random walks [bijeljic]" : "by random walks [bijeljic]");
  say(prose, ". ");
}

/* Whether the sites are cubic; lattices with their own spacings fit the body in each direction
 * separately. */
static bool run_is_cubic(const struct run *run) {
  bool cubic = true;
  for (int d = 1; d < 3; d++)
    cubic = cubic && (run->size[d] <= 1 || fabs(run->spacing[d] / run->spacing[0] - 1.0) < 5e-4);
  return cubic;
}

static enum status write_all(const struct subject *subject, const struct page_model *model,
                             const struct methods_facts *facts, struct prose *prose) {
  enum status status = STATUS_OK;
  struct tensor tensor;
  bool has_tensor;
  const struct run *run = &subject->runs[0];
  const bool coarse = run->spacing[0] > 1e-3;
  const double unit = coarse ? 1e3 : 1e6;
  say(prose,
      "Flow was computed with Tosui %s [tosui] on a lattice of %zu × %zu × %zu points of %.4g",
      TOSUI_VERSION, run->size[0], run->size[1], run->size[2], unit * run->spacing[0]);
  if (!run_is_cubic(run))
    say(prose, " × %.4g × %.4g", unit * run->spacing[1], unit * run->spacing[2]);
  say(prose, coarse ? " mm" : " µm");
  write_geometry(run, model, prose);
  say(prose, ". ");
  write_surface(model, prose);
  say(prose, "The fluid had a density of %g kg/m³ and a viscosity of %g Pa s. ", run->density,
      run->viscosity);
  write_solver(run, prose);
  write_walls(run, model, prose);
  if (model->soil)
    say(prose,
        "Soil with pores below the voxel is solved together with the open pores, as a porous "
        "medium with a drag of its own permeability. ");
  if (subject->n > 1)
    say(prose, "%zu runs entered this page; lattice, model and fluid are the first's. ",
        subject->n);
  write_result(run, facts, prose);
  TRY(tensor_read(run, &tensor, &has_tensor));
  if (has_tensor)
    say(prose,
        "The tensor of permeability is from three flows, each driven along one of x, y and z. ");
  write_solutes(subject, prose);
cleanup:
  return status;
}

enum status page_methods(const struct subject *subject, const struct page_model *model,
                         const struct methods_facts *facts, json_t **methods) {
  enum status status = STATUS_OK;
  struct text text = {0};
  struct prose prose = {0};
  json_t *list = json_array();
  TRY(text_start(&text));
  prose.stream = text.stream;
  TRY(write_all(subject, model, facts, &prose));
  TRY(text_finish(&text));
  for (size_t i = 0; i < prose.count; i++)
    json_array_append_new(list, json_string(references[prose.reference[i]].text));
  *methods = json_pack("{s:o,s:O}", "text", json_text(text.data), "references", list);
cleanup:
  json_decref(list);
  text_free(&text);
  return status;
}
