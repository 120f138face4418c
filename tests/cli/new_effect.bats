#!/usr/bin/env bats
# An effect added as a newcomer would: a file, and a line of the registry. It is then in what explain tells, in the
# force, and in the budget, and nothing else was touched; nor is it by a term of pairs with a field of its own.

setup() {
  cd "$BATS_TEST_TMPDIR"
  root=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  build=${BUILD:-build}
  case $build in /*) ;; *) build=$root/$build ;; esac
}

# effect NAME DT HEADER...: the file wind.h as a newcomer would write it, on in 2-D scenes; its force comes from stdin.
effect() {
  local name=$1 dt=$2
  shift 2
  cat > wind.h <<END
#ifndef WIND_H
#define WIND_H
#include <math.h>
#include <stdio.h>
$(printf '#include "sphsolve/%s"\n' "$@")
static inline bool wind_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, "the wind blows");
  return context->scene->dimensions == 2;
}
static inline double wind_dt(const struct effect_context *context) {
  return $dt * context->spacing;
}
$(cat)
#endif
EFFECT($name, .model = "a push", .citation = "nobody", .wanted = wind_wanted, .dt_max = wind_dt, .force = wind_force)
END
}

# with_effect METHOD: a sphsolve whose METHOD has the effect of the file wind.h here, too.
with_effect() {
  mkdir -p "new/sphsolve/$1/effects"
  cp "$root/sphsolve/$1/effects/registry.def" "new/sphsolve/$1/effects/"
  mv wind.h "new/sphsolve/$1/effects/"
  echo "#include \"sphsolve/$1/effects/wind.h\"" >> "new/sphsolve/$1/effects/registry.def"
  ${CC:-gcc} -std=gnu11 -O1 -fopenmp -Inew -I"$root" -c "$root/sphsolve/$1/effects.c" -o effects.o
  # Its list comes before the library's, which is then not taken.
  ${CC:-gcc} -fopenmp -o sphsolve "$build/obj/sphsolve/sphsolve.c.o" effects.o "$build/lib/libsphsolve.a" \
    "$build/lib/libcommon.a" $(sed -n 's/^DEP_LIBS = //p' "$build/config.mk")
}

@test "isph: a file and a line make an effect: explain tells it, it moves the water, and the budget counts it" {
  effect isph_wind 0.01 isph/state.h plan/plan.h <<'END'
/* A steady push along x: dv/dt = .25 m/s^2. */
static inline void wind_force(const void *state, double (*acceleration)[3]) {
  const struct isph *s = state;
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    acceleration[i][0] = 0.25;
    acceleration[i][1] = acceleration[i][2] = 0;
  }
}
END
  with_effect isph
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

# Heat: each particle has a temperature, which goes from pair to pair and lifts the water.
@test "isph: a file and a line make a pair term with a field of its own, in snapshots and checkpoints" {
  cat > wind.h <<'END'
#ifndef WIND_H
#define WIND_H
#include <math.h>
#include <stdio.h>
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/own.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/plan/plan.h"
static const struct effect_field heat_fields[] = {{"temperature", "K", "above the mean"}, {NULL, NULL, NULL}};
static inline bool heat_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, "the water is warm");
  return context->scene->dimensions == 2;
}
static inline enum status heat_start(void *state, double dt) {
  struct isph *s = state;
  double *temperature = isph_own_field(s, "temperature");
  (void)dt;
  for (size_t i = 0; i < s->count; i++) temperature[i] = sin(2 * M_PI * s->position[i][0] / s->high[0]);
  return STATUS_OK;
}
/* dT/dt = kappa lap T, lap T = 2 sum_j V_j slope_ij (T_j - T_i). */
static inline enum status heat_begin(void *state, double dt) {
  struct isph *s = state;
  double *temperature = isph_own_field(s, "temperature"), *change = s->work[0];
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(temperature)});
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      change[i] = 0;
      for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
        const uint32_t j = s->chunks[c].pair[p] & PAIR_MASK;
        change[i] += 2 * s->volume[j] * (double)s->chunks[c].slope[p] * (temperature[j] - temperature[i]);
      }
    }
  for (size_t i = s->local.begin; i < s->local.end; i++) temperature[i] += 1e-3 * dt * change[i];
  return STATUS_OK;
}
static inline void heat_force(const void *state, double (*acceleration)[3]) {
  const struct isph *s = state;
  const double *temperature = isph_own_field(s, "temperature");
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    acceleration[i][0] = acceleration[i][1] = 0;
    acceleration[i][2] = 0.01 * temperature[i];
  }
}
#endif
EFFECT(isph_heat, .model = "kappa lap T, and a lift", .citation = "nobody", .wanted = heat_wanted,
       .fields = heat_fields, .start = heat_start, .begin = heat_begin, .force = heat_force)
END
  with_effect isph
  cat > box.cfg <<'END'
scene  = { name = "box"; method = "isph"; end_time = "0.1 s"; };
domain = { size = ["0.1 m", "0.1 m"]; spacing = "2.5 mm"; periodic = [true, true]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "0.1 m", "0.1 m"]; } );
force  = { body_acceleration = ["0", "1e-3 m/s^2"]; };
isph   = { dt = "1 ms"; };
checkpoint = { interval = "1 us"; };
END
  ./sphsolve run box.cfg -o box > run.txt
  cp "$(ls box-0*.hdf | tail -1)" half.hdf
  /usr/bin/python3 -c 'import h5py; assert h5py.File("box.ckpt.hdf")["state/temperature"].shape == (1600,)'
  ./sphsolve run box.cfg -o box --resume --set 'scene.end_time="0.2 s"' > run.txt
  cp "$(ls box-0*.hdf | tail -1)" whole.hdf
  /usr/bin/python3 - <<'END'
import h5py
import numpy as np
for name, time in ("half", 0.1), ("whole", 0.2):
    points = h5py.File(name + ".hdf")["VTKHDF"]
    x, t = points["Points"][:, 0], points["PointData/temperature"][:]
    mode = 2 * np.mean(t * np.sin(2 * np.pi * x / 0.1))
    exact = np.exp(-1e-3 * (2 * np.pi / 0.1) ** 2 * time)  # of T = sin(2 pi x / L) at first
    assert abs(mode / exact - 1) < 0.02, (name, mode, exact)
budget = h5py.File("box.hdf")["run/ledger"]
terms = [t.decode() for t in budget["term"][:]]
assert budget["work"][terms.index("isph_heat")] > 0  # the warm half rises, the cold one sinks
assert budget.attrs["energy_open_share"] < 1e-9
END
}

# Of wcsph the push grows across the box, so that viscosity has something to do; it acts beside the body force.
@test "wcsph: a file and a line make an effect: explain tells it, it moves the water, and the budget counts it" {
  effect wind 0.1 geometry/lattice.h wcsph/scales.h wcsph/engine/engine.h <<'END'  # dt 12.5 us, of which .8 are taken
/* A push along x that varies across the box: dv/dt = a sin(2 pi z / L), a = .25 m/s^2. */
static inline void wind_force(const void *state, double (*acceleration)[3]) {
  const struct engine *engine = state;
  for (size_t i = engine_first_slot(engine); i < engine_end_slot(engine); i++) {
    double x[3];
    particles_position(&engine->particles, engine->lattice, i, x);
    acceleration[i][0] = 0.25 * sin(2 * M_PI * x[2] / engine->particles.frame.length[2]);
    acceleration[i][1] = acceleration[i][2] = 0;
  }
}
END
  with_effect wcsph
  cat > box.cfg <<'END'
scene  = { name = "box"; method = "wcsph"; end_time = "5 ms"; steady_tolerance = 0.0; };
domain = { size = ["1 mm", "4 mm"]; spacing = "0.125 mm"; periodic = [true, true]; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
regions = ( { type = "water"; box = ["0", "0", "1 mm", "4 mm"]; } );
force  = { body_acceleration = ["0.01 m/s^2", "0"]; };
wcsph  = { sound_speed = "0.1 m/s"; };
END
  ./sphsolve explain box.cfg > plan.txt
  grep -q 'on   wind  *the wind blows' plan.txt
  grep -q '12.5 us' plan.txt
  ./sphsolve run box.cfg -o box --threads 1 -v > run.txt # all terms of the budget
  grep -q 'wind' run.txt
  /usr/bin/python3 - <<'END'
import h5py
import numpy as np
run = h5py.File("box.hdf", "r")
budget = run["run/ledger"]
terms = [t.decode() for t in budget["term"][:]]
wind, force = terms.index("wind"), terms.index("force")
mass, time = 1000 * 1e-3 * 4e-3 * 0.125e-3, 5e-3
# A sine has no mean: it gives no momentum but work. Against the exact solution of the shear wave,
# u = a/(nu k^2) (1 - exp(-nu k^2 t)) sin kz, work = mean of a u over time and box.
k, nu, a = 2 * np.pi / 4e-3, 1e-6, 0.25
rate = nu * k * k
work = 0.5 * mass * a * a / rate * (time - (1 - np.exp(-rate * time)) / rate)
assert abs(budget["work"][wind] / work - 1) < 0.01, (budget["work"][wind], work)
assert abs(budget["impulse"][wind][0]) < 1e-3 * mass * a * time
assert abs(budget["impulse"][force][0] / (mass * 0.01 * time) - 1) < 1e-6
speed = run["history/kinetic_energy"][-1]
u = a / rate * (1 - np.exp(-rate * time))
exact = 0.5 * mass * (0.5 * u * u + (0.01 * time) ** 2)
assert abs(speed / exact - 1) < 0.01, (speed, exact)
assert budget.attrs["momentum_open_share"] < 1e-5 and budget.attrs["energy_open_share"] < 1e-2, dict(budget.attrs)
assert abs(run["history/dt"][1] - 10e-6) < 1e-7
assert b"wind" in [n for n in run["run/effects/name"][:]]
END
}
