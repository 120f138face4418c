/* One image file: its header, read apart from its pixels, and its pages.
 *
 * A reader is three functions; image.c lists them. Reading opens the file anew, so pages may be
 * read from several threads at once. */
#ifndef TOSUI_CT2MODEL_READERS_IMAGE_H
#define TOSUI_CT2MODEL_READERS_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "ct2model/readers/pixels.h"

struct image_reader;
struct inflated;
struct image_dataset;

struct image {
  char *path;
  const struct image_reader *reader;
  size_t size[2]; /* x, y */
  size_t pages;
  enum pixel_type type;
  double voxel[3];          /* m; x, y, z; NAN where the file does not say */
  const char *voxel_source; /* "TIFF resolution tags"; NULL if none */
  char note[160];           /* what a user should hear about this file; "" if nothing */
  /* for the reader */
  char *data_path;      /* where the pixels are, if not in `path` */
  uint64_t data_offset; /* of page 0, for contiguous pixels; 0 otherwise */
  struct inflated
      *inflated; /* compressed contiguous pixels; data_offset then counts unpacked bytes */
  struct image_dataset *dataset; /* of an HDF5 file */
  bool swap;                     /* bytes of contiguous pixels */
  enum {
    WIDENED_NOT,
    WIDENED_HALF,
    WIDENED_I64,
    WIDENED_U64
  } widened;                     /* stored so, read as type */
  bool columns;                  /* of contiguous pixels z runs first, then y (Fortran's order) */
  uint64_t *page_offsets;        /* of the directories of a multi-page TIFF */
  unsigned orientation;          /* of a TIFF: where its first row and column are */
  bool invert;                   /* white is zero */
  bool plain;                    /* every pixel is a value of `type` */
};

struct image_reader {
  const char *name;       /* "TIFF" */
  const char *endings[5]; /* of its files' names in a folder, then NULL: ".tif", ... */
  bool (*claims)(const char *path, const unsigned char *head, size_t n);
  enum status (*open)(const char *path, struct image *image);
  /* A page as values of the image's type, native byte order; as float if it is not plain. */
  enum status (*read)(const struct image *image, size_t page, void *out);
};

#define READER(name) extern const struct image_reader image_##name##_reader;
#include "ct2model/readers/readers.def"
#undef READER

/* Layout of headerless files from --raw. */
struct raw_layout {
  bool given;
  size_t size[3];
  enum pixel_type type;
  bool big_endian;
};

/* "NXxNYxNZ:u8|u16le|..." */
enum status raw_layout_parse(const char *text, struct raw_layout *layout);

/* Reads the header. `raw` is NULL or not `given` for files that describe themselves. Free with
 * image_close. */
enum status image_open(const char *path, const struct raw_layout *raw, struct image *image);
void image_close(struct image *image);
/* Page `page` into out[size[1]][size[0]]. */
enum status image_read(const struct image *image, size_t page, float *out);
/* Whether all pixels are values of a type with levels. */
bool image_has_levels(const struct image *image);
/* Of an image that has levels: page `page` as `type`, native byte order. */
enum status image_read_stored(const struct image *image, size_t page, void *out);
/* True for names that one of the readers takes (by extension). */
bool image_name_known(const char *name);

/* For readers: reads contiguous pixels of page `page` at data_offset. */
enum status image_read_contiguous(const struct image *image, size_t page, void *out);
/* For readers: data_offset of pixels that end the file, wherever they start. */
#define PIXELS_AT_END UINT64_MAX
/* For readers: the header's line `line` says that the pixels are in the file `name` beside it;
 * names that lead out of the header's folder are refused. */
enum status image_data_beside(struct image *image, const char *name, int line);
/* For readers: checks that the pixels promised by the header are there; with `compressed` they are
 * gzip or zlib data from data_offset on. */
enum status image_claim_pixels(struct image *image, bool compressed);
/* For readers: what to do about what cannot be decoded. */
#define EXPORT_AGAIN "; the file is cut short or damaged: export it again"
/* For readers: size of a file in bytes. */
enum status image_file_size(const char *path, uint64_t *size);

#endif
