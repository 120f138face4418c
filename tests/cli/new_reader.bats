#!/usr/bin/env bats
# An image format added as a newcomer would: a file, and a line of readers.def. ct2model then reads a folder of it.

load programs
setup_file() { programs_setup; }

@test "a file and a line make an image format" {
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  mkdir -p new/ct2model/readers slices
  cp "$ROOT/ct2model/readers/readers.def" new/ct2model/readers/
  echo "READER(pgm)" >> new/ct2model/readers/readers.def
  cat > image_pgm.c <<'C'
/* PGM of 8 bits: "P5 WIDTH HEIGHT 255", then the pixels. */
#include <stdio.h>

#include "ct2model/readers/image.h"

static bool pgm_claims(const char *path, const unsigned char *head, size_t n) {
  (void)path;
  return n > 2 && head[0] == 'P' && head[1] == '5';
}

static enum status pgm_open(const char *path, struct image *image) {
  FILE *file = fopen(path, "rb");
  bool good = file != NULL && fscanf(file, "P5 %zu %zu 255", &image->size[0], &image->size[1]) == 2;
  if (file != NULL) fclose(file);
  if (!good || !pixel_type_of(8, 'u', &image->type))
    return FAIL(STATUS_INPUT, "%s: no PGM file of 8 bits", path);
  image->pages = 1;
  image->plain = true;
  image->data_offset = PIXELS_AT_END;
  return image_claim_pixels(image, false);
}

const struct image_reader image_pgm_reader = {"PGM", {".pgm"}, pgm_claims, pgm_open, image_read_contiguous};
C
  for file in "$ROOT/ct2model/readers/image.c" image_pgm.c; do
    ${CC:-gcc} -std=gnu11 -O1 -Inew -I"$ROOT" -c "$file" -o "$(basename "$file").o"
  done
  # Its list comes before the library's, which is then not taken.
  ${CXX:-g++} -fopenmp -o ct2model "$build/obj/ct2model/ct2model.c.o" image.c.o image_pgm.c.o "$build/lib/libct2model.a" \
    "$build/lib/libcommon.a" $(sed -n 's/^DEP_LIBS = //p' "$build/config.mk") -lopencv_photo -lopencv_imgproc -lopencv_core
  for z in 0 1 2; do
    printf 'P5 4 3 255\n\001\001\000\000\001\001\000\000\001\001\000\000' > slices/$z.pgm
  done
  ./ct2model info slices > told
  grep -q "4x3x3" told
  ./ct2model build slices --segmented 0 --voxel-size 1um --mirror none -o model.hdf --json > model.json
  grep -q '"void_ratio": 1\.0' model.json
  run ct2model info slices
  [ "$status" -eq 3 ]
}
