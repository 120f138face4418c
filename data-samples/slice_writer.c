#include "data-samples/slice_writer.h"

#include <dirent.h>
#include <errno.h>
#include <png.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <tiffio.h>
#include <unistd.h>

#include "common/memory.h"

static unsigned quantise(float grey, float scale, unsigned most) {
  const float value = grey * scale + 0.5F;
  return value <= 0 ? 0 : value >= (float)most ? most : (unsigned)value;
}

static enum status write_tiff(const char *path, const float *grey, long nx, long ny, double voxel) {
  enum status status = STATUS_OK;
  uint16_t *row = NULL;
  char description[128];
  TIFF *tiff = TIFFOpen(path, "w");
  if (!tiff) return FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  TRY(memory_allocate(&row, (size_t)nx, sizeof *row, "image row"));
  const float per_cm = (float)(0.01 / voxel);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, (uint32_t)nx);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, (uint32_t)ny);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, (uint32_t)ny);
  TIFFSetField(tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
  TIFFSetField(tiff, TIFFTAG_XRESOLUTION, per_cm);
  TIFFSetField(tiff, TIFFTAG_YRESOLUTION, per_cm);
  snprintf(description, sizeof description, "grey value = quartz level * 256; voxel %.6g um",
           voxel * 1e6);
  TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, description);
  for (long y = 0; y < ny; y++) {
    for (long x = 0; x < nx; x++) row[x] = (uint16_t)quantise(grey[y * nx + x], 256, 65535);
    if (TIFFWriteScanline(tiff, row, (uint32_t)y, 0) != 1)
      TRY_FAIL(STATUS_RUN, "%s: writing failed: %s", path, strerror(errno));
  }
  if (TIFFFlush(tiff) != 1) TRY_FAIL(STATUS_RUN, "%s: writing failed: %s", path, strerror(errno));
cleanup:
  TIFFClose(tiff);
  memory_free(&row);
  return status;
}

/* False when libpng jumped back with an error. Nothing here changes between setjmp and the jump. */
static bool encode_png(png_structp png, png_infop info, FILE *file, png_byte *row,
                       const float *grey, long nx, long ny, double voxel) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_init_io(png, file);
  png_set_IHDR(png, info, (png_uint_32)nx, (png_uint_32)ny, 8, PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const png_uint_32 per_metre = (png_uint_32)(1 / voxel + 0.5);
  png_set_pHYs(png, info, per_metre, per_metre, PNG_RESOLUTION_METER);
  png_write_info(png, info);
  for (long y = 0; y < ny; y++) {
    for (long x = 0; x < nx; x++) row[x] = (png_byte)quantise(grey[y * nx + x], 1, 255);
    png_write_row(png, row);
  }
  png_write_end(png, info);
  return true;
}

static enum status write_png(const char *path, const float *grey, long nx, long ny, double voxel) {
  enum status status = STATUS_OK;
  png_byte *row = NULL;
  png_infop info = NULL;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  FILE *file = fopen(path, "wb");
  if (!file) TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  if (png) info = png_create_info_struct(png);
  if (!info) TRY_FAIL(STATUS_RUN, "%s: out of memory", path);
  TRY(memory_allocate(&row, (size_t)nx, 1, "image row"));
  if (!encode_png(png, info, file, row, grey, nx, ny, voxel))
    TRY_FAIL(STATUS_RUN, "%s: writing failed: %s", path, strerror(errno));
cleanup:
  if (png) png_destroy_write_struct(&png, &info);
  if (file && fclose(file) != 0 && status == STATUS_OK)
    status = FAIL(STATUS_RUN, "%s: writing failed: %s", path, strerror(errno));
  memory_free(&row);
  return status;
}

enum status slice_write(const char *folder, long index, enum slice_format format, const float *grey,
                        long nx, long ny, double voxel) {
  char path[4096];
  snprintf(path, sizeof path, "%s/slice_%04ld.%s", folder, index,
           format == SLICE_TIFF16 ? "tif" : "png");
  return format == SLICE_TIFF16 ? write_tiff(path, grey, nx, ny, voxel)
                                : write_png(path, grey, nx, ny, voxel);
}

enum status slice_folder_prepare(const char *folder) {
  if (mkdir(folder, 0777) != 0 && errno != EEXIST)
    return FAIL(STATUS_RUN, "%s: cannot be made: %s", folder, strerror(errno));
  DIR *entries = opendir(folder);
  if (!entries) return FAIL(STATUS_RUN, "%s: is no folder: %s", folder, strerror(errno));
  enum status status = STATUS_OK;
  for (struct dirent *entry = readdir(entries); entry; entry = readdir(entries)) {
    long index;
    char suffix[4] = "", path[4096];
    if (sscanf(entry->d_name, "slice_%ld.%3s", &index, suffix) != 2) continue;
    if (strcmp(suffix, "tif") != 0 && strcmp(suffix, "png") != 0) continue;
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    if (unlink(path) != 0)
      status = FAIL(STATUS_RUN, "%s: an old slice cannot be removed: %s", path, strerror(errno));
  }
  closedir(entries);
  return status;
}
