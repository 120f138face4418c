#include "ct2model/readers/inflate.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "common/memory.h"

enum { CHUNK = 1 << 18 }; /* bytes read or unpacked at a time */

struct inflated {
  char *path;
  uint64_t offset, size;
  pthread_mutex_t lock;
  FILE *unpacked; /* unnamed temporary file, deleted when closed */
};

enum status inflate_start(const char *path, uint64_t offset, uint64_t size,
                          struct inflated **inflated) {
  struct inflated *new = NULL;
  enum status status = memory_allocate(&new, 1, sizeof *new, "compressed pixels");
  if (status != STATUS_OK) return status;
  status = memory_copy_text(path, strlen(path), &new->path);
  if (status != STATUS_OK) {
    memory_free(&new);
    return status;
  }
  new->offset = offset;
  new->size = size;
  pthread_mutex_init(&new->lock, NULL);
  *inflated = new;
  return STATUS_OK;
}

enum status inflate_adopt(const char *path, FILE *unpacked, struct inflated **inflated) {
  const enum status status = inflate_start(path, 0, 0, inflated);
  if (status == STATUS_OK) (*inflated)->unpacked = unpacked;
  return status;
}

void inflate_end(struct inflated *inflated) {
  if (inflated == NULL) return;
  if (inflated->unpacked != NULL) fclose(inflated->unpacked);
  pthread_mutex_destroy(&inflated->lock);
  memory_free(&inflated->path);
  memory_free(&inflated);
}

/* The next compressed bytes; false at the end of the file. */
static bool feed(z_stream *stream, FILE *packed, unsigned char *in) {
  if (stream->avail_in > 0) return true;
  stream->next_in = in;
  stream->avail_in = (unsigned)fread(in, 1, CHUNK, packed);
  return stream->avail_in > 0;
}

/* Whether another gzip member follows, as of programs that compress in parallel or append. */
static bool follows_member(z_stream *stream, FILE *packed, unsigned char *in) {
  return feed(stream, packed, in) && stream->next_in[0] == 0x1f && inflateReset(stream) == Z_OK;
}

/* Unpacks all of the stream, so that its checksum is compared, but no more than is promised. */
static enum status unpack_stream(struct inflated *inflated, FILE *packed, z_stream *stream) {
  unsigned char *in = NULL, *out = NULL;
  enum status status = STATUS_OK;
  uint64_t done = 0;
  int code = Z_OK;
  TRY(memory_allocate(&in, CHUNK, 1, "compressed pixels"));
  TRY(memory_allocate(&out, CHUNK, 1, "unpacked pixels"));
  while (code != Z_STREAM_END || follows_member(stream, packed, in)) {
    if (!feed(stream, packed, in)) break;
    stream->next_out = out;
    stream->avail_out = CHUNK;
    code = inflate(stream, Z_NO_FLUSH);
    if (code != Z_OK && code != Z_STREAM_END && code != Z_BUF_ERROR)
      TRY_FAIL(STATUS_INPUT,
               "%s: the compressed pixels are damaged after %llu bytes; export it again",
               inflated->path, (unsigned long long)done);
    const size_t got = CHUNK - stream->avail_out;
    if (got > inflated->size - done)
      TRY_FAIL(STATUS_INPUT,
               "%s: more than the %llu bytes of pixels that the header promises; export it again",
               inflated->path, (unsigned long long)inflated->size);
    if (fwrite(out, 1, got, inflated->unpacked) != got)
      TRY_FAIL(STATUS_RUN, "%s: no room to unpack it in the temporary folder: %s", inflated->path,
               strerror(errno));
    done += got;
  }
  if (done < inflated->size || code != Z_STREAM_END)
    TRY_FAIL(STATUS_INPUT, "%s: %llu bytes of pixels, %s the header promises %llu; export it again",
             inflated->path, (unsigned long long)done,
             done < inflated->size ? "but" : "cut short where", (unsigned long long)inflated->size);
  if (fflush(inflated->unpacked) != 0)
    TRY_FAIL(STATUS_RUN, "%s: no room to unpack it in the temporary folder: %s", inflated->path,
             strerror(errno));
cleanup:
  memory_free(&in);
  memory_free(&out);
  return status;
}

static enum status unpack(struct inflated *inflated) {
  enum status status = STATUS_OK;
  z_stream stream = {0};
  bool started = false;
  FILE *packed = fopen(inflated->path, "rb");
  if (packed == NULL) TRY_FAIL(STATUS_INPUT, "%s: %s", inflated->path, strerror(errno));
  if (fseeko(packed, (off_t)inflated->offset, SEEK_SET) != 0)
    TRY_FAIL(STATUS_INPUT, "%s: cannot be read", inflated->path);
  started = inflateInit2(&stream, 15 + 32) == Z_OK; /* + 32: gzip or zlib, by the first bytes */
  if (!started) TRY_FAIL(STATUS_RUN, "out of memory");
  inflated->unpacked = tmpfile();
  if (inflated->unpacked == NULL)
    TRY_FAIL(STATUS_RUN, "%s: cannot be unpacked: no temporary file: %s", inflated->path,
             strerror(errno));
  TRY(unpack_stream(inflated, packed, &stream));
cleanup:
  if (started) inflateEnd(&stream);
  if (packed != NULL) fclose(packed);
  if (status != STATUS_OK && inflated->unpacked != NULL) {
    fclose(inflated->unpacked);
    inflated->unpacked = NULL;
  }
  return status;
}

enum status inflate_read(struct inflated *inflated, uint64_t offset, uint64_t size, void *out) {
  enum status status = STATUS_OK;
  pthread_mutex_lock(&inflated->lock);
  if (inflated->unpacked == NULL) status = unpack(inflated);
  pthread_mutex_unlock(&inflated->lock);
  for (uint64_t done = 0; status == STATUS_OK && done < size;) {
    ssize_t got = pread(fileno(inflated->unpacked), (char *)out + done, (size_t)(size - done),
                        (off_t)(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return FAIL(STATUS_RUN, "%s: the unpacked pixels cannot be read", inflated->path);
    done += (uint64_t)got;
  }
  return status;
}
