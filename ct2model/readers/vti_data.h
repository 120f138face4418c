/* The numbers of an array of a VTI file that do not stand in the file byte by byte: as text, in
 * base64, or in blocks that are compressed with zlib ("VTK XML Formats"). */
#ifndef TOSUI_CT2MODEL_READERS_VTI_DATA_H
#define TOSUI_CT2MODEL_READERS_VTI_DATA_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "ct2model/readers/image.h"

struct vti_data {
  FILE *file;
  uint64_t start;                                /* of the array, with its head, in the file */
  enum { VTI_BYTES, VTI_BASE64, VTI_TEXT } form; /* in which it is written */
  bool packed;                                   /* in compressed blocks */
  bool wide, big; /* numbers of its head have 64 bits; they have the highest byte first */
};

/* Decodes the array into the store of `image`, whose size and type are known, as contiguous pixels;
 * the file then stands behind it. */
enum status vti_data_unpack(const struct vti_data *data, struct image *image);

#endif
