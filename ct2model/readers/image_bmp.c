#include "ct2model/readers/image.h"

#include <stdio.h>
#include <string.h>

#include "common/input_file.h"
#include "common/memory.h"

/* Windows bitmap, uncompressed (Microsoft, BITMAPFILEHEADER and BITMAPINFOHEADER; OS/2's core
 * header too): a header of 14 bytes, one of 12 to 124, a palette, then rows from below, each padded
 * to four bytes. SkyScan writes such slices, of 8 bits with a palette of greys. */

enum { FILE_HEADER = 14, CORE_HEADER = 12, INFO_HEADER = 40, HEADER_MOST = 124 };

struct bmp {
  size_t width, height, stride; /* stride: bytes of a row */
  unsigned bits;
  bool top_down;
  uint64_t pixels;           /* their offset */
  uint32_t resolution[2];    /* pixels per metre; 0: not given */
  size_t colours;            /* of the palette */
  uint16_t palette[3 * 256]; /* red, green, blue */
};

static bool bmp_claims(const char *path, const unsigned char *head, size_t n) {
  (void)path;
  return n >= FILE_HEADER + CORE_HEADER && head[0] == 'B' && head[1] == 'M' && head[6] == 0 &&
         head[7] == 0 && head[8] == 0 && head[9] == 0;
}

static uint32_t number(const unsigned char *at, size_t bytes) {
  return (uint32_t)image_number(at, bytes, false);
}

static enum status read_size(const char *path, const unsigned char *info, bool core,
                             struct bmp *bmp) {
  const int64_t width = core ? (int64_t)number(info + 4, 2) : (int32_t)number(info + 4, 4);
  int64_t height = core ? (int64_t)number(info + 6, 2) : (int32_t)number(info + 8, 4);
  const uint32_t planes = number(info + (core ? 8 : 12), 2);
  bmp->bits = number(info + (core ? 10 : 14), 2);
  bmp->top_down = height < 0;
  if (bmp->top_down) height = -height;
  if (width < 1 || height < 1 || planes != 1)
    return FAIL(STATUS_INPUT, "%s: a bitmap of %lld x %lld pixels in %u planes" EXPORT_AGAIN, path,
                (long long)width, (long long)height, planes);
  if (bmp->bits != 1 && bmp->bits != 4 && bmp->bits != 8 && bmp->bits != 24 && bmp->bits != 32)
    return FAIL(STATUS_INPUT, "%s: bitmaps of %u bits a pixel are not read; save as 8 bits", path,
                bmp->bits);
  bmp->width = (size_t)width;
  bmp->height = (size_t)height;
  bmp->stride = (bmp->width * bmp->bits + 31) / 32 * 4;
  return STATUS_OK;
}

static enum status read_header(const char *path, FILE *file, struct bmp *bmp) {
  enum status status = STATUS_OK;
  unsigned char head[FILE_HEADER + HEADER_MOST] = {0}, entry[4];
  memset(bmp, 0, sizeof *bmp);
  if (fread(head, 1, FILE_HEADER + 4, file) != FILE_HEADER + 4)
    TRY_FAIL(STATUS_INPUT, "%s: ends within its header" EXPORT_AGAIN, path);
  const unsigned char *info = head + FILE_HEADER;
  const uint32_t length = number(info, 4);
  const bool core = length == CORE_HEADER;
  if (!core && (length < INFO_HEADER || length > HEADER_MOST))
    TRY_FAIL(STATUS_INPUT, "%s: a bitmap with a header of %u bytes is not read; save it anew", path,
             length);
  if (fread(head + FILE_HEADER + 4, 1, length - 4, file) != length - 4)
    TRY_FAIL(STATUS_INPUT, "%s: ends within its header" EXPORT_AGAIN, path);
  TRY(read_size(path, info, core, bmp));
  if (!core && number(info + 16, 4) != 0)
    TRY_FAIL(STATUS_INPUT, "%s: compression %u of bitmaps is not read; save it uncompressed", path,
             number(info + 16, 4));
  bmp->pixels = number(head + 10, 4);
  for (int a = 0; a < 2 && !core; a++) bmp->resolution[a] = number(info + 24 + 4 * a, 4);
  if (bmp->bits > 8) goto cleanup;
  const size_t most = (size_t)1 << bmp->bits, used = core ? 0 : number(info + 32, 4);
  bmp->colours = used > 0 && used < most ? used : most;
  for (size_t i = 0; i < bmp->colours; i++) {
    const size_t bytes = core ? 3 : 4;
    if (fread(entry, 1, bytes, file) != bytes)
      TRY_FAIL(STATUS_INPUT, "%s: ends within its palette" EXPORT_AGAIN, path);
    for (int c = 0; c < 3; c++) bmp->palette[3 * i + (size_t)c] = entry[2 - c];
  }
  if (bmp->pixels < (uint64_t)ftello(file))
    TRY_FAIL(STATUS_INPUT, "%s: its pixels are said to begin within its header" EXPORT_AGAIN, path);
cleanup:
  return status;
}

static enum status bmp_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  struct bmp bmp;
  FILE *file = NULL;
  uint64_t bytes;
  TRY(input_open(path, &file));
  TRY(read_header(path, file, &bmp));
  TRY(image_file_size(path, &bytes));
  if ((double)bmp.pixels + (double)bmp.stride * (double)bmp.height > (double)bytes)
    TRY_FAIL(STATUS_INPUT, "%s: %llu bytes of pixels, but its header promises %zu" EXPORT_AGAIN,
             path, (unsigned long long)(bytes > bmp.pixels ? bytes - bmp.pixels : 0),
             bmp.stride * bmp.height);
  image->size[0] = bmp.width;
  image->size[1] = bmp.height;
  image->pages = 1;
  image->type = PIXEL_U8;
  image->plain = true;
  if (bmp.bits > 8) image_note(image, IMAGE_STORED_IN_COLOUR);
  if (bmp.bits <= 8) TRY(image_keep_palette(image, bmp.palette, bmp.colours));
  if (image->palette != NULL) image_note(image, IMAGE_NUMBERS_OF_COLOURS);
  if (image->palette != NULL && bmp.bits < 8) image->top = (unsigned char)((1 << bmp.bits) - 1);
  for (int a = 0; a < 2 && !image_is_screen_resolution(bmp.resolution[0]); a++)
    if ((int32_t)bmp.resolution[a] > 0) image->voxel[a] = 1.0 / bmp.resolution[a];
  if (image->voxel[0] > 0.0) image->voxel_source = "BMP resolution";
cleanup:
  if (file != NULL) fclose(file);
  return status;
}

static enum status decode_row(const struct image *image, const struct bmp *bmp,
                              const unsigned char *in, size_t y, const unsigned char *reference,
                              unsigned char *out) {
  if (bmp->bits > 8)
    return image_take_greys(image, in, bmp->width, bmp->bits / 8, y * bmp->width, reference, out);
  for (size_t x = 0; x < bmp->width; x++) {
    const size_t bit = x * bmp->bits;
    const unsigned entry =
        (unsigned)in[bit / 8] >> (8 - bmp->bits - bit % 8) & ((1u << bmp->bits) - 1u);
    if (entry >= bmp->colours)
      return FAIL(STATUS_INPUT, "%s: pixel %zu,%zu is colour %u of a palette of %zu" EXPORT_AGAIN,
                  image->path, x, y, entry, bmp->colours);
    out[x] = (unsigned char)(image->palette != NULL ? entry : bmp->palette[3 * entry]);
  }
  return STATUS_OK;
}

static enum status bmp_read(const struct image *image, size_t page, void *out) {
  enum status status = STATUS_OK;
  struct bmp bmp;
  unsigned char *row = NULL, reference[4];
  FILE *file = NULL;
  (void)page;
  TRY(input_open(image->path, &file));
  TRY(read_header(image->path, file, &bmp));
  if (bmp.width != image->size[0] || bmp.height != image->size[1] ||
      fseeko(file, (off_t)bmp.pixels, SEEK_SET) != 0)
    TRY_FAIL(STATUS_INPUT, "%s: changed while it was being read; run again", image->path);
  TRY(memory_allocate(&row, bmp.stride, 1, "a row of a bitmap"));
  for (size_t i = 0; i < bmp.height; i++) {
    const size_t y = bmp.top_down ? i : bmp.height - 1 - i;
    if (fread(row, 1, bmp.stride, file) != bmp.stride)
      TRY_FAIL(STATUS_INPUT, "%s: ends within its pixels; the file is cut short", image->path);
    if (i == 0) memcpy(reference, row, sizeof reference); /* rows are padded to four bytes */
    TRY(decode_row(image, &bmp, row, y, reference, (unsigned char *)out + y * bmp.width));
  }
cleanup:
  memory_free(&row);
  if (file != NULL) fclose(file);
  return status;
}

const struct image_reader image_bmp_reader = {
    .name = "BMP", .endings = {".bmp"}, .claims = bmp_claims, .open = bmp_open, .read = bmp_read};
