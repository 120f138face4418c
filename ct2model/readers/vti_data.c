#include "ct2model/readers/vti_data.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "common/memory.h"
#include "ct2model/readers/inflate.h"

enum { COPIED = 1 << 16, TOKEN_MOST = 64 };

/* Bytes of the file, or those that base64 stands for. */
struct source {
  FILE *file;
  bool base64;
  unsigned char left[3]; /* decoded, not yet taken */
  int count;
};

static int base64_digit(int c) {
  static const char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const char *at = c > 0 ? strchr(DIGITS, c) : NULL;
  return at != NULL ? (int)(at - DIGITS) : -1;
}

/* Decodes four characters; false if there are none. The padding '=' may stand within the array:
 * VTK encodes its head apart, other programs with the numbers. */
static bool decode_four(struct source *source) {
  int digit[4], used = 0;
  for (int i = 0; i < 4; i++) {
    int c;
    do c = getc(source->file);
    while (c == ' ' || c == '\t' || c == '\r' || c == '\n');
    digit[i] = base64_digit(c);
    if (digit[i] >= 0 && used == i)
      used++;
    else if (c != '=' || i < 2)
      return false;
    if (digit[i] < 0) digit[i] = 0;
  }
  const unsigned bits = (unsigned)digit[0] << 18 | (unsigned)digit[1] << 12 |
                        (unsigned)digit[2] << 6 | (unsigned)digit[3];
  for (int i = 0; i < 3; i++) source->left[i] = (unsigned char)(bits >> (16 - 8 * i) & 255);
  source->count = used - 1;
  return true;
}

static bool take(struct source *source, unsigned char *out, size_t n) {
  if (!source->base64) return fread(out, 1, n, source->file) == n;
  for (size_t i = 0; i < n; i++) {
    while (source->count == 0)
      if (!decode_four(source)) return false;
    out[i] = source->left[0];
    memmove(source->left, source->left + 1, 2);
    source->count--;
  }
  return true;
}

static enum status take_number(const struct vti_data *data, const char *path, struct source *source,
                               uint64_t *number) {
  unsigned char bytes[8];
  if (!take(source, bytes, data->wide ? 8 : 4))
    return FAIL(STATUS_INPUT, "%s: ends within its array, or this is no base64" EXPORT_AGAIN, path);
  *number = image_number(bytes, data->wide ? 8 : 4, data->big);
  return STATUS_OK;
}

static enum status store(const char *path, const void *bytes, size_t n, FILE *to) {
  if (fwrite(bytes, 1, n, to) == n) return STATUS_OK;
  return FAIL(STATUS_RUN, "%s: no room to unpack it in the temporary folder: %s", path,
              strerror(errno));
}

static enum status wrong_size(const char *path, double told, uint64_t wanted) {
  return FAIL(STATUS_INPUT,
              "%s: its array has %.0f bytes, but its extent promises %llu" EXPORT_AGAIN, path, told,
              (unsigned long long)wanted);
}

static enum status copy(const struct vti_data *data, const char *path, struct source *source,
                        uint64_t wanted, FILE *to) {
  enum status status = STATUS_OK;
  unsigned char bytes[COPIED];
  uint64_t told;
  TRY(take_number(data, path, source, &told));
  if (told != wanted) TRY(wrong_size(path, (double)told, wanted));
  for (uint64_t done = 0; done < wanted;) {
    const size_t n = wanted - done < COPIED ? (size_t)(wanted - done) : COPIED;
    if (!take(source, bytes, n))
      TRY_FAIL(STATUS_INPUT, "%s: ends within its array, or this is no base64" EXPORT_AGAIN, path);
    TRY(store(path, bytes, n, to));
    done += n;
  }
cleanup:
  return status;
}

/* Blocks of `size` bytes, the last of `rest` (0: whole): the number of blocks, `size`, `rest`, the
 * packed length of each, then the blocks. */
static enum status unpack_blocks(const struct vti_data *data, const char *path,
                                 struct source *source, uint64_t bytes, uint64_t wanted, FILE *to) {
  enum status status = STATUS_OK;
  uint64_t count, size, rest, *lengths = NULL;
  unsigned char *in = NULL, *out = NULL;
  TRY(take_number(data, path, source, &count));
  TRY(take_number(data, path, source, &size));
  TRY(take_number(data, path, source, &rest));
  if (count == 0 || count > bytes / 4 || size == 0 || rest > size)
    TRY_FAIL(STATUS_INPUT, "%s: its array does not begin with its compressed blocks" EXPORT_AGAIN,
             path);
  const double told = (double)(count - 1) * (double)size + (double)(rest > 0 ? rest : size);
  if (told != (double)wanted) TRY(wrong_size(path, told, wanted));
  TRY(memory_allocate(&lengths, count, sizeof *lengths, "the blocks of an array"));
  uint64_t most = 0;
  for (uint64_t i = 0; i < count; i++) {
    TRY(take_number(data, path, source, &lengths[i]));
    if (lengths[i] > bytes) TRY_FAIL(STATUS_INPUT, "%s: ends within its array" EXPORT_AGAIN, path);
    if (lengths[i] > most) most = lengths[i];
  }
  TRY(memory_allocate(&in, most, 1, "a compressed block"));
  TRY(memory_allocate(&out, size < wanted ? size : wanted, 1, "a block"));
  for (uint64_t i = 0; i < count; i++) {
    const size_t n = i + 1 < count || rest == 0 ? (size_t)size : (size_t)rest;
    uLongf got = n;
    if (!take(source, in, lengths[i]) || uncompress(out, &got, in, lengths[i]) != Z_OK || got != n)
      TRY_FAIL(STATUS_INPUT, "%s: block %llu of its array cannot be unpacked" EXPORT_AGAIN, path,
               (unsigned long long)i);
    TRY(store(path, out, n, to));
  }
cleanup:
  memory_free(&lengths);
  memory_free(&in);
  memory_free(&out);
  return status;
}

/* A number written as text, as the bytes of the image's stored type; 0: it is none. */
static size_t read_text(const char *text, const struct image *image, unsigned char bytes[8]) {
  const size_t n = image_stored_size(image);
  char *end;
  errno = 0;
  if (image->widened == WIDENED_U64) {
    const unsigned long long value = strtoull(text, &end, 10);
    memcpy(bytes, &value, n);
    return errno == 0 && text[0] != '-' && *end == '\0' ? n : 0;
  }
  if (image->widened == WIDENED_NOT && (image->type == PIXEL_F32 || image->type == PIXEL_F64)) {
    const double value = strtod(text, &end);
    const float narrow = (float)value;
    memcpy(bytes, image->type == PIXEL_F32 ? (const void *)&narrow : &value, n);
    return *end == '\0' ? n : 0;
  }
  const long long value = strtoll(text, &end, 10);
  const bool is_signed =
      image->type == PIXEL_I8 || image->type == PIXEL_I16 || image->type == PIXEL_I32;
  const long long top = n == 8 ? 0 : 1ll << (8 * n - (is_signed ? 1 : 0));
  if (errno != 0 || *end != '\0' || (n < 8 && (value >= top || value < (is_signed ? -top : 0))))
    return 0;
  memcpy(bytes, &value, n); /* the low bytes: of a little-endian machine, as DICOM is read */
  return n;
}

/* The next word; its end, '<' for that of the array. */
static bool next_word(FILE *file, char word[TOKEN_MOST]) {
  int c, n = 0;
  do c = getc(file);
  while (c == ' ' || c == '\t' || c == '\r' || c == '\n');
  while (c != EOF && c != '<' && !isspace(c) && n + 1 < TOKEN_MOST) {
    word[n++] = (char)c;
    c = getc(file);
  }
  word[n] = '\0';
  if (c == '<') ungetc(c, file);
  return n > 0;
}

static enum status read_numbers(const char *path, const struct image *image, FILE *from,
                                uint64_t count, FILE *to) {
  enum status status = STATUS_OK;
  char word[TOKEN_MOST];
  unsigned char bytes[8];
  for (uint64_t i = 0; i < count; i++) {
    if (!next_word(from, word))
      TRY_FAIL(STATUS_INPUT, "%s: %llu numbers, but its extent promises %llu" EXPORT_AGAIN, path,
               (unsigned long long)i, (unsigned long long)count);
    const size_t n = read_text(word, image, bytes);
    if (n == 0)
      TRY_FAIL(STATUS_INPUT, "%s: '%.20s' is no number of its array's type" EXPORT_AGAIN, path,
               word);
    TRY(store(path, bytes, n, to));
  }
  if (next_word(from, word))
    TRY_FAIL(STATUS_INPUT, "%s: more than the %llu numbers that its extent promises" EXPORT_AGAIN,
             path, (unsigned long long)count);
cleanup:
  return status;
}

enum status vti_data_unpack(const struct vti_data *data, struct image *image) {
  enum status status = STATUS_OK;
  const char *path = image->path;
  struct source source = {.file = data->file, .base64 = data->form == VTI_BASE64};
  uint64_t bytes;
  FILE *to = NULL;
  TRY(image_file_size(path, &bytes));
  const double numbers = (double)image->size[0] * (double)image->size[1] * (double)image->pages;
  const double wanted = numbers * (double)image_stored_size(image);
  /* A number of text takes two bytes at least; base64 has no more bytes than characters. */
  const uint64_t words = bytes / 2;
  const double most = data->form == VTI_TEXT ? (double)words * (double)image_stored_size(image)
                      : data->packed         ? INFLATE_MOST * (double)bytes
                                             : (double)bytes;
  if (!(wanted <= most))
    TRY_FAIL(
        STATUS_INPUT,
        "%s: its extent promises %.0f bytes of numbers, but it can hold at most %.0f" EXPORT_AGAIN,
        path, wanted, most);
  if (fseeko(data->file, (off_t)data->start, SEEK_SET) != 0)
    TRY_FAIL(STATUS_INPUT, "%s: ends before its array" EXPORT_AGAIN, path);
  to = tmpfile();
  if (to == NULL)
    TRY_FAIL(STATUS_RUN, "%s: cannot be unpacked: no temporary file: %s", path, strerror(errno));
  if (data->form == VTI_TEXT)
    TRY(read_numbers(path, image, data->file, (uint64_t)numbers, to));
  else if (data->packed)
    TRY(unpack_blocks(data, path, &source, bytes, (uint64_t)wanted, to));
  else
    TRY(copy(data, path, &source, (uint64_t)wanted, to));
  if (fflush(to) != 0)
    TRY_FAIL(STATUS_RUN, "%s: no room to unpack it in the temporary folder: %s", path,
             strerror(errno));
  TRY(inflate_adopt(path, to, &image->inflated));
  to = NULL;
  image->data_offset = 0;
  image->swap = data->big && data->form != VTI_TEXT;
cleanup:
  if (to != NULL) fclose(to);
  return status;
}
