#include <jansson.h>
#include <math.h>
#include <stdio.h>

#include "common/json_number.h"
#include "common/units.h"
#include "sphsolve/solute/result.h"

/* Dispersivity D_L / U, m; NAN without flow. `over_diffusion`: D_L / D. */
static double dispersivity(const struct solute_result *r, int i, double over_diffusion) {
  return r->peclet[i] > 0 ? over_diffusion * r->length / r->peclet[i] : NAN;
}

/* Relative uncertainty due to the size of the sample; known if the closure problem was solved. */
static double sample_error(const struct solute_result *r, int i, int across) {
  return r->by_closure ? r->closure[i].sample[across] : NAN;
}

static void add(json_t *object, const char *name, double value) {
  json_array_append_new(json_object_get(object, name), json_number(value));
}

enum status solute_result_print_json(const struct scene *scene, const struct solute_flow *flow,
                                     const struct solute_result *r) {
  static const char *const lists[] = {"peclet",
                                      "longitudinal",
                                      "transverse",
                                      "longitudinal_error",
                                      "transverse_error",
                                      "longitudinal_sample",
                                      "transverse_sample",
                                      "longitudinal_dispersivity",
                                      "transverse_dispersivity"};
  json_t *object = json_object();
  for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
    json_object_set_new(object, lists[i], json_array());
  for (int i = 0; i < r->count; i++) {
    const struct solute_estimate *e = &r->best[i];
    add(object, "peclet", r->peclet[i]);
    add(object, "longitudinal", e->longitudinal);
    add(object, "transverse", e->transverse);
    add(object, "longitudinal_error", e->longitudinal_error);
    add(object, "transverse_error", e->transverse_error);
    add(object, "longitudinal_sample", sample_error(r, i, 0));
    add(object, "transverse_sample", sample_error(r, i, 1));
    add(object, "longitudinal_dispersivity", dispersivity(r, i, e->longitudinal));
    add(object, "transverse_dispersivity", dispersivity(r, i, e->transverse));
  }
  if (r->by_closure && r->by_walk)
    for (int w = 0; w < 2; w++) {
      static const char *const parts[] = {"longitudinal", "transverse", "longitudinal_error",
                                          "transverse_error"};
      json_t *way = json_object();
      for (size_t p = 0; p < sizeof parts / sizeof *parts; p++)
        json_object_set_new(way, parts[p], json_array());
      for (int i = 0; i < r->count; i++) {
        const struct solute_estimate *e = w ? &r->walk[i].value : &r->closure[i].value;
        add(way, "longitudinal", e->longitudinal);
        add(way, "transverse", e->transverse);
        add(way, "longitudinal_error", e->longitudinal_error);
        add(way, "transverse_error", e->transverse_error);
      }
      json_object_set_new(object, w ? "walk" : "closure", way);
    }
  const struct {
    const char *name;
    double value;
  } numbers[] = {{"length", r->length},
                 {"diffusion", r->diffusion},
                 {"porosity", flow->porosity},
                 {"isolated", flow->isolated},
                 {"mean_velocity", flow->speed},
                 {"formation_factor", r->formation},
                 {"formation_factor_error", r->formation_error},
                 {"formation_factor_sample", r->formation_sample},
                 {"tortuosity", r->tortuosity},
                 {"velocity_correlation_along", r->correlation[0]},
                 {"velocity_correlation_across", r->correlation[1]},
                 {"flow_correction", flow->correction},
                 {"wall_time", r->wall_time}};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    json_put_number(object, numbers[i].name, numbers[i].value);
  json_object_set_new(object, "mirrored", json_boolean(flow->mirrored));
  json_object_set_new(object, "status", json_string(r->status));
  json_object_set_new(object, "flow", json_string(scene->flow_path));
  json_dumpf(object, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
  putchar('\n');
  json_decref(object);
  return STATUS_OK;
}

/* Prints like "8.322 +- 1.2". */
static void print_value(double value, double error) {
  if (isfinite(error))
    printf("  %10.4g +- %-7.2g", value, 100 * error);
  else
    printf("  %10.4g +- ?      ", value);
}

static void print_sample(double error) {
  if (isfinite(error))
    printf("  %6.*f", 100 * error >= 10 ? 0 : 100 * error >= 1 ? 1 : 2, 100 * error);
  else
    printf("  %6s", "?");
}

static void print_row(const struct solute_result *r, int i, const struct solute_estimate *e) {
  printf("%10.4g", r->peclet[i]);
  print_value(e->longitudinal, e->longitudinal_error);
  print_value(e->transverse, e->transverse_error);
  for (int across = 0; across < 2; across++) print_sample(sample_error(r, i, across));
  if (r->peclet[i] > 0) printf("  %.3g", dispersivity(r, i, e->longitudinal));
}

/* Length of the box along the mean flow, m. */
static double flow_length(const struct solute_flow *flow) {
  double length = 0;
  for (int a = 0; a < 3; a++)
    length += fabs(flow->mean_velocity[a]) / flow->speed * flow->n[a] * flow->spacing[a];
  return length;
}

void solute_result_print(const struct scene *scene, const struct solute_flow *flow,
                         const struct solute_result *r, const char *prefix) {
  char text[32];
  printf(
      "flow       %s: U = %.4g m/s in pores of porosity %.4f, of cells that neither gain nor lose "
      "water\n",
      scene->flow_path, flow->speed, flow->porosity);
  if (isfinite(r->formation))
    printf("formation  F = %.4g +- %s %%: D*/D = %.4g without flow\n", r->formation,
           percent_format(r->formation_error, text), 1 / r->tortuosity);
  printf("length     %.4g m, of Pe = U length / D\n", r->length);
  if (isfinite(r->correlation[0]))
    printf("sample     %.3g mm along the flow; its velocity forgets itself in %.2g mm, across in "
           "%.2g mm\n",
           1e3 * flow_length(flow), 1e3 * r->correlation[0], 1e3 * r->correlation[1]);
  printf("%10s  %10s    %-7s  %10s    %-7s  %-14s  %s\n", "Pe", "D_L/D", "%", "D_T/D", "%",
         "others: %", "dispersivity D_L/U, m");
  for (int i = 0; i < r->count; i++) {
    print_row(r, i, &r->best[i]);
    putchar('\n');
    if (!r->by_closure || !r->by_walk) continue;
    print_row(r, i, &r->closure[i].value);
    puts("  closure");
    print_row(r, i, &r->walk[i].value);
    puts("  walk");
  }
  if (r->by_closure)
    printf(
        "others     by how much D_L and D_T of another sample, or of a larger one, may differ\n");
  printf("files      %s.hdf", prefix);
  if (r->by_walk) printf(", %s-tracks-*.hdf (ways of 64 walkers, for ParaView)", prefix);
  printf("\nnext       analyze dispersion %s.hdf -o results\n", prefix);
}
