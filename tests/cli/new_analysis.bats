#!/usr/bin/env bats
# An analysis added as a newcomer would: a file, and a line of analyses.def. analyze then has its command, with its
# option, in help; its files; and its section on the page.

load programs
setup_file() { programs_setup; }

# bats test_tags=long
@test "a file and a line make an analysis: command, option, files, section of the report" {
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  mkdir -p new/analyze
  cp "$ROOT/analyze/analyses.def" new/analyze/
  echo "ANALYSIS(tortuosity)" >> new/analyze/analyses.def
  cat > tortuosity.c <<'C'
/* Hydraulic tortuosity (Duda, Koza, Matyka 2011, eq. 8): sum of |v| over that along the force. */
#include <math.h>

#include "analyze/analysis.h"

static enum status applies(const struct subject *subject, bool *applies) {
  *applies = subject->flowing > 0 && subject->snapshots;
  return STATUS_OK;
}

static enum status analyze(const struct subject *subject, const struct options *options, struct product *product) {
  enum status status = STATUS_OK;
  struct particles p = {0};
  double speeds = 0, along = 0, digits = 6;
  if (options != NULL) TRY(options_number(options, "digits", &digits));
  TRY(run_last_snapshot(&subject->runs[0], &p));
  for (size_t i = 0; i < p.count; i++) {
    const double *v = &p.velocity[3 * i], *e = subject->runs[0].direction;
    speeds += sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    along += v[0] * e[0] + v[1] * e[1] + v[2] * e[2];
  }
  json_put_number(product->json, "tortuosity", speeds / along);
  fprintf(product->csv.stream, "tortuosity\n%g\n", speeds / along);
  fprintf(product->summary.stream, "tortuosity %.*f\n", (int)digits, speeds / along);
  fprintf(product->plot.stream, "plot x\n");
  product->width = product->height = 200;
cleanup:
  particles_free(&p);
  return status;
}

const struct analysis tortuosity_analysis = {
    .name = "tortuosity",
    .command = {"tortuosity", "RUN [-o DIR]", "how far water goes round grains", "analyze tortuosity run.hdf", 1, 1},
    .options = {{"digits", 0, "N", 0, "of the number (6)"}},
    .heading = "Hydraulic tortuosity",
    .contents = "Tortuosity",
    .caption = "Path over way.",
    .applies = applies,
    .analyze = analyze};
C
  local files
  files=$(cd "$ROOT" && ls analyze/analyze.c analyze/analysis.c analyze/report/page.c)
  for file in $files; do
    ${CC:-gcc} -std=gnu11 -O1 -fopenmp -Inew -I"$ROOT" -I"$build" -DTOSUI_VERSION='"0"' -DTOSUI_COMPILER='"cc"' -c "$ROOT/$file" -o "$(basename "$file").o"
  done
  ${CC:-gcc} -std=gnu11 -O1 -Inew -I"$ROOT" -c tortuosity.c -o tortuosity.o
  # Their functions come before the libraries', which are then not taken.
  ${CC:-gcc} -fopenmp -o analyze ./*.o "$build/lib/libanalyze.a" "$build/lib/libcommon.a" \
    $(sed -n 's/^DEP_LIBS = //p' "$build/config.mk")
  sphsolve run "$ROOT/data-samples/scenes/poiseuille.cfg" -o slit > /dev/null
  ./analyze --help | grep -q "tortuosity *how far water goes round grains"
  ./analyze tortuosity --help | grep -q -e "--digits"
  ./analyze tortuosity slit.hdf --digits 3 -o found > told
  grep -q "tortuosity 1.000" told
  grep -q '"tortuosity": 1' found/tortuosity.json
  [ -s found/tortuosity.csv ]
  ./analyze report slit.hdf -o page.html > /dev/null
  page page.html '[(s["heading"], s["contents"]) for s in page["sections"] if s["name"] == "tortuosity"] == [("Hydraulic tortuosity", "Tortuosity")]'
  run analyze tortuosity slit.hdf
  [ "$status" -eq 2 ]
  run ./analyze darcy slit.hdf --digits 3
  [ "$status" -eq 2 ]
}
