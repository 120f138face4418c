#include "ct2model/model/export_tiff.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <tiffio.h>
#include <unistd.h>

#include "common/memory.h"
#include "common/output_file.h"
#include "common/output_guard.h"

static bool write_layer(TIFF *tiff, const struct voxel_model *model, size_t z, uint8_t *row) {
  const size_t nx = model->size[0], ny = model->size[1], nz = model->size[2];
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, (uint32_t)nx);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, (uint32_t)ny);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE); /* ImageJ maps such stacks */
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, (uint32_t)ny);
  TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
  TIFFSetField(tiff, TIFFTAG_XRESOLUTION, 0.01 / model->spacing[0]);
  TIFFSetField(tiff, TIFFTAG_YRESOLUTION, 0.01 / model->spacing[1]);
  TIFFSetField(tiff, TIFFTAG_SOFTWARE, TOSUI_MARK);
  if (z == 0) {
    char description[160];
    snprintf(description, sizeof description,
             "ImageJ=1.53t\nimages=%zu\nslices=%zu\nunit=cm\nspacing=%.9g\nloop=false\n", nz, nz,
             model->spacing[2] * 100);
    TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, description);
  }
  const uint8_t *solid = model->solid + z * nx * ny;
  for (size_t y = 0; y < ny; y++) {
    for (size_t x = 0; x < nx; x++) row[x] = solid[y * nx + x] ? 255 : 0;
    if (output_fails() || TIFFWriteScanline(tiff, row, (uint32_t)y, 0) != 1) return false;
  }
  return !output_fails() && TIFFWriteDirectory(tiff) == 1;
}

enum status export_tiff(const char *path, const struct voxel_model *model) {
  enum status status = STATUS_OK;
  uint8_t *row = NULL;
  TIFF *tiff = NULL;
  char target[OUTPUT_NAME_MAX], part[OUTPUT_NAME_MAX + 5];
  TRY(output_follow(path, target));
  snprintf(part, sizeof part, "%s.part", target);
  TRY(memory_allocate(&row, model->size[0], 1, "image row"));
  TIFFSetErrorHandler(NULL);
  errno = 0;
  tiff = output_fails() ? NULL
                        : TIFFOpen(part, model_site_count(model) > (size_t)INT_MAX ? "w8" : "w");
  if (tiff == NULL) TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  for (size_t z = 0; z < model->size[2]; z++)
    if (!write_layer(tiff, model, z, row))
      TRY_FAIL(STATUS_RUN, "%s: layer %zu cannot be written: %s", path, z, strerror(errno));
cleanup:
  if (tiff != NULL) TIFFClose(tiff);
  memory_free(&row);
  if (status == STATUS_OK) status = output_rename(part, target);
  if (status != STATUS_OK && tiff != NULL) unlink(part);
  return status;
}
