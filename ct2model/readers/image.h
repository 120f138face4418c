/* One image file: its header, which is read before its pixels, and its pages.
 *
 * A reader consists of three functions; readers.def lists them. Reading opens the file anew, so
 * that several threads can read pages at once. */
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

enum { NO_DATA_MOST = 6 };

struct image {
  char *path;
  const struct image_reader *reader;
  size_t size[2]; /* x, y */
  size_t pages;
  enum pixel_type type;
  double voxel[3];          /* m; x, y, z; NAN if the file does not tell */
  const char *voxel_source; /* "TIFF resolution tags"; NULL if none */
  char note[320];           /* messages to the user about this file; "" if none */
  /* for use by the reader */
  char **data_files;      /* files with the pixels, if these are not in `path` */
  size_t data_file_count; /* each holds as many pages as the others */
  uint64_t data_offset;   /* of page 0, for contiguous pixels; 0 otherwise; in every data file */
  bool placed;            /* the header says by a number where contiguous pixels begin */
  struct inflated
      *inflated;          /* compressed contiguous pixels; data_offset then counts unpacked bytes */
  uint64_t packed_offset; /* where compressed data begin in their file */
  struct image_dataset *dataset; /* dataset of an HDF5 file */
  bool swap;                     /* contiguous pixels have reversed bytes */
  enum {
    WIDENED_NOT,
    WIDENED_HALF,
    WIDENED_I64,
    WIDENED_U64
  } widened;              /* stored so, read as type */
  bool columns;           /* contiguous pixels are ordered with z first, then y (as in
                             Fortran) */
  uint64_t *page_offsets; /* of a multi-page TIFF: offsets of the directories; of DICOM: numbers of
                             the frames, where their order is not that in the file */
  unsigned orientation;   /* of TIFF and Exif: position of its first row and column */
  bool invert;            /* white is zero */
  unsigned char top;      /* highest of samples of less than a byte; 0: those of `type` */
  uint16_t *palette;      /* colours, by three, whose numbers the pixels are: labels */
  size_t palette_size;    /* number of colours */
  unsigned used_bits;     /* of a DICOM pixel; 0: all */
  struct {
    float from, to; /* both included */
    const char *name;
  } no_data[NO_DATA_MOST]; /* stored values that are no measurement, and the field that says so */
  size_t no_data_count;
  double axes[6];    /* unit vectors along a row and a column; NAN if the file does not tell */
  double at[3];      /* first pixel along the row, the column and their normal, m; likewise; of
                        pictures in a larger one, along the row and the column, in its unit */
  double number;     /* of the slice in its series; NAN if the file does not tell */
  char series[160];  /* to which the slice belongs, as of DICOM; "" if the file does not tell */
  double rescale[2]; /* slope and intercept that make other numbers of the greys */
  bool plain;        /* every pixel is a value of `type` */
};

struct image_reader {
  const char *name;       /* "TIFF" */
  const char *endings[5]; /* file name extensions, then NULL: ".tif", ... */
  bool (*claims)(const char *path, const unsigned char *head, size_t n);
  enum status (*open)(const char *path, struct image *image);
  /* Reads a page as values of the image's type in native byte order, or as float if it is not
   * `plain`. */
  enum status (*read)(const struct image *image, size_t page, void *out);
  void (*close)(struct image *image); /* frees what only this reader keeps; NULL: nothing */
};

#define READER(name) extern const struct image_reader image_##name##_reader;
#include "ct2model/readers/readers.def"
#undef READER

/* Layout of headerless files, from --raw. */
struct raw_layout {
  bool given;
  size_t size[3];
  enum pixel_type type;
  bool big_endian;
  uint64_t offset; /* bytes before the pixels of each file */
};

/* Parses "NXxNYxNZ:u8|u16le|...[:OFFSET]"; usage errors. */
enum status raw_layout_parse(const char *text, struct raw_layout *layout);

/* Reads the header. `raw` is NULL or not `given` for files that describe themselves. Free with
 * image_close. */
enum status image_open(const char *path, const struct raw_layout *raw, struct image *image);
void image_close(struct image *image);
/* Reads page `page` into out[size[1]][size[0]]; NAN where a value is no measurement. */
enum status image_read(const struct image *image, size_t page, float *out);
/* Whether all pixels are greys of an integer type with few levels (pixel_levels). */
bool image_has_levels(const struct image *image);
/* For an image with levels: reads page `page` as values of `type` in native byte order. */
enum status image_read_stored(const struct image *image, size_t page, void *out);
/* Whether one of the readers takes files with this extension. */
bool image_name_known(const char *name);

/* For readers: contiguous pixels have so many bits, in `format` 'u', 'i' or 'f'; false if these are
 * not read. */
bool image_take_type(struct image *image, int bits, char format);
/* For readers: bytes of a contiguous pixel in the file, which may be widened when it is read. */
size_t image_stored_size(const struct image *image);
/* For readers: screen resolutions (pixels per metre), which programs write by default, and coarser
 * ones are no voxel sizes. */
bool image_is_screen_resolution(double pixels_per_metre);
/* For readers: stored values `from` to `to` are no measurement, as the field `name` (static) says:
 * no data, fill, padding. NAN: nothing is said. */
void image_no_data(struct image *image, double from, double to, const char *name);
/* For readers: tells that the image is read as stored, where `orientation` is another. */
void image_tell_orientation(struct image *image);
/* For readers: what is told about images in colour. */
#define IMAGE_STORED_IN_COLOUR "stored in colour; build takes it only where it is grey"
#define IMAGE_COMPRESSED_WITH_LOSS                                                                 \
  "compressed with loss (JPEG, say): its greys, and its walls most, are not those of the scan; "   \
  "take "                                                                                          \
  "the slices before that"
#define IMAGE_NUMBERS_OF_COLOURS                                                                   \
  "a palette of colours: the numbers of the colours are taken, as of labels"
/* For readers: a palette of `size` colours, in the order red, green, blue. If all are grey, pixels
 * are those greys; otherwise they are the numbers of their colours, as of labels, and the image
 * keeps the palette. */
enum status image_keep_palette(struct image *image, const uint16_t *colours, size_t size);
/* Whether the numbers of two images mean the same colours, where they mean any. */
bool image_palettes_agree(const struct image *a, const struct image *b);
/* For readers: the greys of n pixels, from number `first` of the page on, of several samples each,
 * at `in`. Refused are colours, and further samples, as of a mask or of transparency, that are not
 * everywhere those of `reference`, a pixel of the page: they tell of pixels what is not heeded. */
enum status image_take_greys(const struct image *image, const unsigned char *in, size_t n,
                             size_t samples, size_t first, const unsigned char *reference,
                             void *out);
/* For readers: reads contiguous pixels of page `page` at data_offset. */
enum status image_read_contiguous(const struct image *image, size_t page, void *out);
/* For readers: data_offset of pixels that end with the end of the file, wherever they start. */
#define PIXELS_AT_END UINT64_MAX
/* For readers: checks that the files hold the pixels that the header describes, and no others about
 * whose place it is silent; with `compressed` they are gzip or zlib data from packed_offset on. */
enum status image_claim_pixels(struct image *image, bool compressed);
/* For readers: adds a message to the user. */
__attribute__((format(printf, 2, 3))) void image_note(struct image *image, const char *format, ...);
/* For readers: tells of edges of a voxel along x, y and z that differ, and whose unit `field` does
 * not say. NAN: not told. */
void image_tell_edges(struct image *image, double x, double y, double z, const char *field);
/* Advice about slices that lie aside of each other. */
#define SHEARED                                                                                    \
  " (a tilted gantry?): the body would be sheared; resample the slices upright, as by the tilt "   \
  "correction of 3D Slicer or dcm2niix"
/* For readers: advice about data that cannot be decoded. */
#define EXPORT_AGAIN "; the file is cut short or damaged: export it again"
/* For readers: a whole number of up to 8 bytes, the highest first if `big`. */
uint64_t image_number(const unsigned char *at, size_t bytes, bool big);
/* For readers: size of a file in bytes. */
enum status image_file_size(const char *path, uint64_t *size);

#endif
