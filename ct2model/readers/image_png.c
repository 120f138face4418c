#include "ct2model/readers/image.h"

#include <errno.h>
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"

/* libpng reports errors by longjmp; all that must be freed is in this struct. */
struct png_session {
  FILE *file;
  png_structp png;
  png_infop info;
  unsigned char *pixels;
  png_bytep *rows;
  char message[120];
};

static void on_error(png_structp png, png_const_charp text) {
  struct png_session *session = png_get_error_ptr(png);
  snprintf(session->message, sizeof session->message, "%s", text);
  longjmp(png_jmpbuf(png), 1);
}

static void on_warning(png_structp png, png_const_charp text) {
  (void)png;
  (void)text;
}

static void session_end(struct png_session *session) {
  if (session->png != NULL)
    png_destroy_read_struct(&session->png, session->info != NULL ? &session->info : NULL, NULL);
  if (session->file != NULL) fclose(session->file);
  memory_free(&session->pixels);
  memory_free(&session->rows);
}

static enum status session_start(struct png_session *session, const char *path) {
  memset(session, 0, sizeof *session);
  session->file = fopen(path, "rb");
  if (session->file == NULL) return FAIL(STATUS_INPUT, "%s: %s", path, strerror(errno));
  session->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, session, on_error, on_warning);
  if (session->png != NULL) session->info = png_create_info_struct(session->png);
  if (session->info == NULL) return FAIL(STATUS_RUN, "%s: out of memory", path);
  /* Texts and profiles, for which libpng allocates as much memory as the file claims, up to 2 GB,
   * are skipped. */
  png_set_keep_unknown_chunks(session->png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
  png_set_keep_unknown_chunks(session->png, PNG_HANDLE_CHUNK_AS_DEFAULT,
                              (png_const_bytep) "pHYs\0oFFs", 2);
  png_set_keep_unknown_chunks(session->png, PNG_HANDLE_CHUNK_ALWAYS,
                              (png_const_bytep) "acTL\0pCAL\0sCAL\0eXIf", 4);
  return STATUS_OK;
}

static bool png_claims(const char *path, const unsigned char *head, size_t n) {
  (void)path;
  return n >= 8 && png_sig_cmp(head, 0, 8) == 0;
}

/* Reads the palette, three values a colour, and returns the number of colours. */
static size_t read_palette(struct png_session *session, uint16_t colours[3 * 256]) {
  png_colorp palette;
  int count = 0;
  if (!png_get_PLTE(session->png, session->info, &palette, &count)) return 0;
  for (int i = 0; i < count && i < 256; i++) {
    colours[3 * i] = palette[i].red;
    colours[3 * i + 1] = palette[i].green;
    colours[3 * i + 2] = palette[i].blue;
  }
  return (size_t)count;
}

/* Turns numbers of a palette's colours into its greys; where it has colours they are kept. */
static enum status palette_to_grey(struct png_session *session, const struct image *image,
                                   unsigned char *pixels) {
  uint16_t colours[3 * 256] = {0};
  const size_t size = read_palette(session, colours);
  png_bytep told = NULL;
  int count = 0;
  unsigned char alpha[256];
  memset(alpha, UINT8_MAX, sizeof alpha);
  if (png_get_tRNS(session->png, session->info, &told, &count, NULL) && told != NULL)
    memcpy(alpha, told, (size_t)count);
  const unsigned char first = alpha[pixels[0]];
  for (size_t i = 0; i < image->size[0] * image->size[1]; i++) {
    if (pixels[i] >= size)
      return FAIL(STATUS_INPUT, "%s: pixel %zu,%zu is colour %d of a palette of %zu" EXPORT_AGAIN,
                  image->path, i % image->size[0], i / image->size[0], pixels[i], size);
    if (alpha[pixels[i]] != first)
      return FAIL(STATUS_INPUT,
                  "%s: its palette makes some pixels transparent and others not (pixel %zu,%zu), "
                  "as of a mask; save the scan alone, as grey",
                  image->path, i % image->size[0], i / image->size[0]);
    if (image->palette == NULL) pixels[i] = (unsigned char)colours[3 * pixels[i]];
  }
  return STATUS_OK;
}

/* Copies a chunk that was kept as it is, with zeros behind it that end any texts in it; returns its
 * length, 0 if there is none. */
enum { ZEROS = 4 };
static size_t find_chunk(struct png_session *session, const char *name, char *copy, size_t room) {
  png_unknown_chunkp chunks;
  const int count = png_get_unknown_chunks(session->png, session->info, &chunks);
  memset(copy, 0, room);
  for (int i = 0; i < count; i++)
    if (memcmp(chunks[i].name, name, 4) == 0 && chunks[i].size > 0) {
      const size_t n = chunks[i].size < room - ZEROS ? chunks[i].size : room - ZEROS;
      memcpy(copy, chunks[i].data, n);
      return n;
    }
  return 0;
}

/* The number of pictures of an animation, of which the first alone would be read (APNG, acTL). */
static uint32_t count_pictures(struct png_session *session) {
  char chunk[16];
  return find_chunk(session, "acTL", chunk, sizeof chunk) >= 4
             ? png_get_uint_32((png_const_bytep)chunk)
             : 1;
}

/* Lengths in metres (PNG, extensions, sCAL): a unit, and the two edges of a pixel as texts. */
static void take_scale(struct png_session *session, struct image *image) {
  char chunk[100];
  if (find_chunk(session, "sCAL", chunk, sizeof chunk) == 0 || chunk[0] != 1) return;
  const double x = strtod(chunk + 1, NULL), y = strtod(chunk + 2 + strlen(chunk + 1), NULL);
  if (!(x > 0.0 && y > 0.0 && isfinite(x) && isfinite(y))) return;
  image->voxel[0] = x;
  image->voxel[1] = y;
  image->voxel_source = "PNG sCAL";
}

/* What greys stand for (PNG, extensions, pCAL): a name, the greys from and to, the equation (0:
 * linear), the number of parameters, a unit, and the parameters as texts. */
static void take_calibration(struct png_session *session, struct image *image) {
  enum { ENDS = 8, LINEAR = 0 };
  char chunk[300];
  if (find_chunk(session, "pCAL", chunk, sizeof chunk) == 0) return;
  const char *at = chunk + strnlen(chunk, 80) + 1, *unit = at + ENDS + 2;
  const double from = png_get_int_32((png_const_bytep)at);
  const double to = png_get_int_32((png_const_bytep)at + 4);
  const char *first = unit + strlen(unit) + 1, *second = first + strlen(first) + 1;
  if (at[ENDS] == LINEAR && to > from && second < chunk + sizeof chunk) {
    image->rescale[0] = strtod(second, NULL) / (to - from);
    image->rescale[1] = strtod(first, NULL) - image->rescale[0] * from;
  }
  image_note(image, "greys as stored, before its calibration (pCAL)");
}

/* The orientation of a photograph (Exif 2.32, tag 274): the first directory has it in itself. */
static void take_orientation(struct png_session *session, struct image *image) {
  enum { ENTRY = 12, ORIENTATION = 274 };
  unsigned char chunk[300];
  const size_t n = find_chunk(session, "eXIf", (char *)chunk, sizeof chunk);
  const bool motorola = chunk[0] == 'M';
  size_t at = n > ENTRY ? image_number(chunk + (motorola ? 6 : 4), 2, motorola) : n;
  const size_t entries = at + 2 < n ? image_number(chunk + at, 2, motorola) : 0;
  at += 2;
  for (size_t i = 0; i < entries && at + ENTRY <= n; i++, at += ENTRY)
    if (image_number(chunk + at, 2, motorola) == ORIENTATION)
      image->orientation = (unsigned)image_number(chunk + at + 8, 2, motorola);
  image_tell_orientation(image);
}

static enum status png_open(const char *path, struct image *image) {
  struct png_session session;
  enum status status = session_start(&session, path);
  if (status != STATUS_OK) goto cleanup;
  if (setjmp(png_jmpbuf(session.png))) {
    status = FAIL(STATUS_INPUT, "%s: not a readable PNG: %s" EXPORT_AGAIN, path, session.message);
    goto cleanup;
  }
  png_init_io(session.png, session.file);
  png_read_info(session.png, session.info);
  image->size[0] = png_get_image_width(session.png, session.info);
  image->size[1] = png_get_image_height(session.png, session.info);
  image->pages = 1;
  const uint32_t pictures = count_pictures(&session);
  if (pictures > 1) {
    status = FAIL(STATUS_INPUT, "%s: an animation of %u pictures; save each as a file of its own",
                  path, pictures);
    goto cleanup;
  }
  image->plain = true;
  image->type = png_get_bit_depth(session.png, session.info) == 16 ? PIXEL_U16 : PIXEL_U8;
  const int colour = png_get_color_type(session.png, session.info);
  const int bits = png_get_bit_depth(session.png, session.info);
  if (bits < 8) image->top = (unsigned char)((1 << bits) - 1);
  if (colour == PNG_COLOR_TYPE_PALETTE) {
    uint16_t colours[3 * 256];
    const size_t size = read_palette(&session, colours);
    status = image_keep_palette(image, colours, size);
    if (status != STATUS_OK) goto cleanup;
    if (image->palette == NULL) image->top = 0;
  }
  if (image->palette != NULL)
    image_note(image, IMAGE_NUMBERS_OF_COLOURS);
  else if (colour != PNG_COLOR_TYPE_GRAY && colour != PNG_COLOR_TYPE_GRAY_ALPHA)
    image_note(image, IMAGE_STORED_IN_COLOUR);
  png_color_16p clear;
  const bool grey = colour == PNG_COLOR_TYPE_GRAY;
  if ((grey || colour == PNG_COLOR_TYPE_RGB) &&
      (png_get_tRNS(session.png, session.info, NULL, NULL, &clear) & PNG_INFO_tRNS) != 0 &&
      (grey || (clear->red == clear->green && clear->red == clear->blue))) {
    const uint16_t value = grey ? clear->gray : clear->red;
    image_no_data(image, value, value, "transparent grey (tRNS)");
  }
  take_calibration(&session, image);
  take_orientation(&session, image);
  take_scale(&session, image);
  png_int_32 offset[2];
  png_uint_32 x, y;
  int unit;
  if (png_get_oFFs(session.png, session.info, &offset[0], &offset[1], &unit))
    for (int axis = 0; axis < 2; axis++) image->at[axis] = offset[axis];
  const bool told = png_get_pHYs(session.png, session.info, &x, &y, &unit) && x > 0 && y > 0;
  if (told && (unit != PNG_RESOLUTION_METER || image_is_screen_resolution(x))) {
    image_tell_edges(image, 1.0 / x, 1.0 / y, NAN, "pHYs");
  } else if (told) {
    image->voxel[0] = 1.0 / x;
    image->voxel[1] = 1.0 / y;
    image->voxel_source = "PNG pHYs";
  }
cleanup:
  session_end(&session);
  return status;
}

static enum status png_read(const struct image *image, size_t page, void *out) {
  struct png_session session;
  enum status status = session_start(&session, image->path);
  (void)page;
  if (status != STATUS_OK) goto cleanup;
  if (setjmp(png_jmpbuf(session.png))) {
    status =
        FAIL(STATUS_INPUT, "%s: cannot be decoded: %s" EXPORT_AGAIN, image->path, session.message);
    goto cleanup;
  }
  png_init_io(session.png, session.file);
  png_read_info(session.png, session.info);
  const bool palette = png_get_color_type(session.png, session.info) == PNG_COLOR_TYPE_PALETTE;
  png_set_packing(session.png); /* samples of less than a byte, as they are */
  (void)png_set_interlace_handling(session.png);
  png_read_update_info(session.png, session.info);
  size_t row = png_get_rowbytes(session.png, session.info);
  size_t channels = png_get_channels(session.png, session.info);
  if (png_get_image_width(session.png, session.info) != image->size[0] ||
      png_get_image_height(session.png, session.info) != image->size[1] ||
      row != image->size[0] * channels * pixel_size(image->type)) {
    status = FAIL(STATUS_INPUT, "%s: changed while it was being read; run again", image->path);
    goto cleanup;
  }
  status = memory_allocate(&session.pixels, image->size[1], row, "a PNG slice");
  if (status == STATUS_OK)
    status = memory_allocate(&session.rows, image->size[1], sizeof *session.rows, "PNG rows");
  if (status != STATUS_OK) goto cleanup;
  for (size_t y = 0; y < image->size[1]; y++) session.rows[y] = session.pixels + y * row;
  png_read_image(session.png, session.rows);
  png_read_end(session.png, NULL);
  const size_t pixels = image->size[0] * image->size[1];
  if (channels == 1)
    memcpy(out, session.pixels, pixels * pixel_size(image->type));
  else
    status = image_take_greys(image, session.pixels, pixels, channels, 0, session.pixels, out);
  if (palette && status == STATUS_OK) status = palette_to_grey(&session, image, out);
  pixels_swap(out, pixels, image->type); /* PNG is big-endian */
cleanup:
  session_end(&session);
  return status;
}

const struct image_reader image_png_reader = {
    .name = "PNG", .endings = {".png"}, .claims = png_claims, .open = png_open, .read = png_read};
