/* Compressed pixels (gzip or zlib) after a header: unpacked once, into a temporary file, when the
 * first slice is read; or pixels that a reader has decoded itself. */
#ifndef TOSUI_CT2MODEL_READERS_INFLATE_H
#define TOSUI_CT2MODEL_READERS_INFLATE_H

#include <stdint.h>
#include <stdio.h>

#include "common/error.h"

/* Deflate expands to at most so many times its length. */
#define INFLATE_MOST 1032.0

struct inflated;

/* Stores the position of the packed bytes and their number when unpacked; nothing is read yet. Free
 * with inflate_end. */
enum status inflate_start(const char *path, uint64_t offset, uint64_t size,
                          struct inflated **inflated);
/* The same of bytes that the caller has unpacked into an unnamed temporary file, which is closed
 * with inflate_end. */
enum status inflate_adopt(const char *path, FILE *unpacked, struct inflated **inflated);
void inflate_end(struct inflated *inflated);
/* Reads the unpacked bytes offset .. offset + size - 1; may be called from several threads. */
enum status inflate_read(struct inflated *inflated, uint64_t offset, uint64_t size, void *out);

#endif
