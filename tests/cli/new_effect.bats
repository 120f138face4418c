#!/usr/bin/env bats
# An effect added as a newcomer would: a file, and a line of the registry. It is then in what explain tells, in the
# force, and in the budget, and nothing else was touched.

@test "a file and a line make an effect: explain tells it, it moves the water, and the budget counts it" {
  cd "$BATS_TEST_TMPDIR"
  local root=$BATS_TEST_DIRNAME/../.. build=${BUILD:-build}
  root=$(cd "$root" && pwd)
  case $build in /*) ;; *) build=$root/$build ;; esac
  mkdir -p new/sphsolve/isph/effects
  cp "$root/sphsolve/isph/effects/registry.def" new/sphsolve/isph/effects/
  echo '#include "sphsolve/isph/effects/wind.h"' >> new/sphsolve/isph/effects/registry.def
  cat > new/sphsolve/isph/effects/wind.h <<'END'
/* A steady push along x: dv/dt = .25 m/s^2. */
#ifndef WIND_H
#define WIND_H
#include <stdio.h>
#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"
static inline bool wind_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, "the wind blows");
  return context->scene->dimensions == 2;
}
static inline double wind_dt(const struct effect_context *context) {
  return 0.01 * context->spacing;
}
static inline void wind_force(const void *state, double (*acceleration)[3]) {
  const struct isph *s = state;
  for (size_t i = s->share.begin; i < s->share.end; i++) {
    acceleration[i][0] = 0.25;
    acceleration[i][1] = acceleration[i][2] = 0;
  }
}
#endif
EFFECT(isph_wind, .model = "a steady push", .citation = "nobody", .wanted = wind_wanted, .dt_max = wind_dt,
       .force = wind_force)
END
  ${CC:-gcc} -std=gnu11 -O1 -fopenmp -Inew -I"$root" -c "$root/sphsolve/isph/effects.c" -o effects.o
  # Its list comes before the library's, which is then not taken.
  ${CC:-gcc} -fopenmp -o sphsolve "$build/obj/sphsolve/sphsolve.c.o" effects.o "$build/lib/libsphsolve.a" \
    "$build/lib/libcommon.a" $(sed -n 's/^DEP_LIBS = //p' "$build/config.mk")
  cat > box.cfg <<'END'
scene  = { name = "box"; method = "isph"; end_time = "0.02 s"; };
domain = { size = ["0.1 m", "0.1 m"]; spacing = "1 cm"; periodic = [true, true]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0.1 m", "0.1 m"]; } );
force  = { body_acceleration = ["0", "1e-3 m/s^2"]; };
END
  ./sphsolve explain box.cfg > plan.txt
  grep -q 'on   isph_wind  *the wind blows' plan.txt
  grep -q 'dt at most 100 us' plan.txt
  ./sphsolve run box.cfg -o box > run.txt
  /usr/bin/python3 - <<'END'
import h5py
run = h5py.File("box.hdf", "r")
budget = run["run/ledger"]
terms = [t.decode() for t in budget["term"][:]]
mass, acceleration, time = 1000 * 0.1 * 0.1 * 1.0, 0.25, 0.02
impulse = budget["impulse"][terms.index("isph_wind")]
thickness = impulse[0] / (mass * acceleration * time)  # of the 2-D scene, in m
momentum = run["history/momentum"][-1]
assert abs(momentum[0] / impulse[0] - 1) < 1e-9, (momentum, impulse)
assert abs(run["history/darcy_velocity"][-1][0] / (acceleration * time) - 1) < 1e-9
assert budget["work"][terms.index("isph_wind")] > 0
assert budget.attrs["momentum_open_share"] < 1e-9 and budget.attrs["energy_open_share"] < 1e-9
assert run["history/dt"][1] <= 1.0001e-4
assert 0 < thickness <= 1
assert b"isph_wind" in [n for n in run["run/effects/name"][:]]
END
}
