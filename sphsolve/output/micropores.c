#include "sphsolve/output/micropores.h"

#include <math.h>
#include <stdio.h>

#include "common/hdf5_table.h"
#include "common/json_number.h"
#include "common/units.h"

void micropores_add(struct micropores *m, const struct micropores_point *point) {
  int at = m->count++;
  for (; at > 0 && m->curve[at - 1].factor > point->factor; at--) m->curve[at] = m->curve[at - 1];
  m->curve[at] = *point;
}

void micropores_print(const struct micropores *m) {
  char sites[32], flux[32];
  printf("soil       %s %% of the points, k_micro %.3g m^2: %s %% of the flux goes through it\n",
         percent_format(m->sites, sites), m->permeability, percent_format(m->own.flux, flux));
  printf("           its drag takes %s %% of the power: 10 %% more k_micro is %s %% more k\n",
         percent_format(m->own.slope, sites), percent_format(0.1 * m->own.slope, flux));
  if (m->count == 0) return;
  printf("              k_micro      k      flux through  10 %% more\n");
  printf("                m^2       cm/s        soil      k_micro\n");
  for (int i = 0; i < m->count; i++) {
    const struct micropores_point *p = &m->curve[i];
    printf("           %10.3g %10.4g %8s %% %+9.2g %%\n", p->factor * m->permeability, 100 * p->k,
           percent_format(p->flux, flux), 10 * p->slope);
  }
}

static json_t *point_json(const struct micropores *m, const struct micropores_point *p) {
  return json_pack("{s:f, s:f, s:o, s:o, s:o}", "factor", p->factor, "permeability",
                   p->factor * m->permeability, "k", json_number(p->k), "flux_share",
                   json_number(p->flux), "dlnk_dlnk_micro", json_number(p->slope));
}

json_t *micropores_json(const struct micropores *m) {
  json_t *curve = json_array();
  for (int i = 0; i < m->count; i++) json_array_append_new(curve, point_json(m, &m->curve[i]));
  return json_pack("{s:f, s:o, s:f, s:f, s:o, s:o, s:o}", "sites", m->sites, "connected",
                   json_number(m->own.connected), "porosity", m->porosity, "permeability",
                   m->permeability, "flux_share", json_number(m->own.flux), "dlnk_dlnk_micro",
                   json_number(m->own.slope), "curve", curve);
}

enum status micropores_write(const struct micropores *m, struct h5_file *file) {
  enum status status = STATUS_OK;
  static const char group[] = "/run/micro";
  const struct micropores_point *p = m->curve;
  const struct h5_number facts[] = {
      {"sites", H5_F64, 1, &m->sites},         {"connected", H5_F64, 1, &m->own.connected},
      {"porosity", H5_F64, 1, &m->porosity},   {"permeability", H5_F64, 1, &m->permeability},
      {"flux_share", H5_F64, 1, &m->own.flux}, {"dlnk_dlnk_micro", H5_F64, 1, &m->own.slope}};
  const struct h5_column columns[] = {{"factor", H5_F64, 1, &p->factor},
                                      {"k", H5_F64, 1, &p->k},
                                      {"flux_share", H5_F64, 1, &p->flux},
                                      {"dlnk_dlnk_micro", H5_F64, 1, &p->slope}};
  TRY(h5_make_group(file, group));
  TRY(h5_write_numbers(file, group, sizeof facts / sizeof *facts, facts));
  if (m->count > 0) TRY(h5_write_columns(file, group, (size_t)m->count, sizeof *p, 4, columns));
cleanup:
  return status;
}
