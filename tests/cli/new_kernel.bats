#!/usr/bin/env bats
# A kernel of wcsph added as a newcomer would: its file for the pair loops, its exact form beside those of the others,
# its lines in the table of pair loops. Wendland's C4 function then moves water as viscosity says.

load programs
setup_file() { programs_setup; }

# bats test_tags=long
@test "four files make a kernel: one of its own, two of exact forms, a line of the pair loops" {
  local build=${BUILD:-build} isa flags
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  mkdir -p new/common new/sphsolve/wcsph/kernels new/sphsolve/wcsph/engine
  cat > new/sphsolve/wcsph/kernels/wendland_c4.h <<'C'
/* Wendland's C4 function (Dehnen, Aly 2012, table 1), s = r/h, t = 1 - s/2:
 *   W/alpha = t^6 (1 + 3 s + 35/12 s^2),   -(dW/ds)/alpha = 14/3 s t^5 (1 + 5/2 s). */
#include "sphsolve/wcsph/engine/simd.h"
#define KERNEL_NAME wendland_c4
#define KERNEL_AT_0 1.0
SIMD_INLINE vec kernel_vector_w(vec s) {
  vec t = vec_max(1.0f - 0.5f * s, vec_set(0.0f)), t2 = t * t;
  return t2 * t2 * t2 * (1.0f + 3.0f * s + (35.0f / 12.0f) * s * s);
}
SIMD_INLINE vec kernel_vector_slope(vec s) {
  vec t = vec_max(1.0f - 0.5f * s, vec_set(0.0f)), t2 = t * t;
  return (14.0f / 15.0f) * s * t2 * t2 * t * (1.0f + 2.5f * s);
}
C
  sed 's/KERNEL_WENDLAND, KERNELS/KERNEL_WENDLAND, KERNEL_WENDLAND_C4, KERNELS/' "$ROOT/common/kernel.h" > new/common/kernel.h
  sed -e 's/\[KERNEL_WENDLAND\] = "wendland", NULL/[KERNEL_WENDLAND] = "wendland", [KERNEL_WENDLAND_C4] = "wendland_c4", NULL/' \
    -e 's/^static double normalisation(.*/&\n  if (kernel == KERNEL_WENDLAND_C4) return dimensions == 2 ? 9 \/ (4 * M_PI * h * h) : 495 \/ (256 * M_PI * h * h * h);/' \
    -e '/^double kernel_w(/,/^}/ s/^  double s = .*/&\n  if (kernel == KERNEL_WENDLAND_C4) return alpha * pow(fmax(1 - s \/ 2, 0), 6) * (1 + 3 * s + 35.0 \/ 12 * s * s);/' \
    -e '/^double kernel_dw(/,/^}/ s/^  double s = .*/&\n  if (kernel == KERNEL_WENDLAND_C4) return -alpha * 14.0 \/ 3 * s * pow(fmax(1 - s \/ 2, 0), 5) * (1 + 2.5 * s);/' \
    "$ROOT/common/kernel.c" > new/common/kernel.c
  [ "$(grep -c KERNEL_WENDLAND_C4 new/common/kernel.c)" -eq 4 ]
  sed -e 's/^DECLARE(wendland)/&\nDECLARE(wendland_c4)/' -e 's/^    \[KERNEL_WENDLAND\] = .*/&\n    [KERNEL_WENDLAND_C4] = LIST(wendland_c4),/' \
    "$ROOT/sphsolve/wcsph/engine/pairs.c" > new/sphsolve/wcsph/engine/pairs.c
  for isa in baseline avx2 avx512; do # as the Makefile does for each file of kernels/
    case $isa in
      baseline) flags= ;;
      avx2) flags="-ffp-contract=fast -mavx2 -mfma" ;;
      avx512) flags="-ffp-contract=fast -mavx512f -mavx512vl -mavx512dq -mavx512bw -mavx2 -mfma" ;;
    esac
    # shellcheck disable=SC2086
    ${CC:-gcc} -std=gnu11 -O1 -fopenmp $flags -Inew -I"$ROOT" -include new/sphsolve/wcsph/kernels/wendland_c4.h \
      -c "$ROOT/sphsolve/wcsph/engine/pair_loops.c" -o $isa.o
  done
  for file in common/kernel sphsolve/wcsph/engine/pairs; do
    ${CC:-gcc} -std=gnu11 -O1 -fopenmp -Inew -I"$ROOT" -c new/$file.c -o "$(basename $file).o"
  done
  # Their functions come before the libraries', which are then not taken.
  ${CC:-gcc} -fopenmp -o sphsolve "$build/obj/sphsolve/sphsolve.c.o" kernel.o pairs.o baseline.o avx2.o avx512.o \
    "$build/lib/libsphsolve.a" "$build/lib/libcommon.a" $(sed -n 's/^DEP_LIBS = //p' "$build/config.mk")
  ./sphsolve explain "$ROOT/data-samples/scenes/poiseuille.cfg" --set 'wcsph.kernel="wendland_c4"' > explained
  grep -q wendland_c4 explained
  ./sphsolve run "$ROOT/data-samples/scenes/poiseuille.cfg" --set 'wcsph.kernel="wendland_c4"' -o slit > told
  # The mean velocity of a slit of gap b after the start-up, a b^2 / (12 nu).
  /usr/bin/python3 - <<'PY'
import h5py
velocity = h5py.File("slit.hdf", "r")["history/darcy_velocity"][-1][0]
exact = 1e-4 * 1e-3**2 / (12 * 1e-6)
assert abs(velocity / exact - 1) < 0.01, (velocity, exact)
PY
  run sphsolve run "$ROOT/data-samples/scenes/poiseuille.cfg" --set 'wcsph.kernel="wendland_c4"' -o other
  [ "$status" -eq 3 ]
}
