#include "analyze/report/page_html.h"

#include <string.h>
#include <strings.h>
#include <zlib.h>

#include "common/memory.h"
#include "common/text.h"

void html_text(FILE *stream, const char *text) {
  const char *c = text;
  uint32_t code;
  while (*c != '\0') {
    const int n = text_character(c, &code);
    if (n == 0) {
      fputs("\xef\xbf\xbd", stream); /* U+FFFD */
      c++;
      continue;
    }
    switch (*c) {
    case '&':
      fputs("&amp;", stream);
      break;
    case '<':
      fputs("&lt;", stream);
      break;
    case '>':
      fputs("&gt;", stream);
      break;
    case '"':
      fputs("&quot;", stream);
      break;
    case '\'':
      fputs("&#39;", stream);
      break;
    default:
      if (!text_is_hidden(code) || *c == '\n' || *c == '\t') fwrite(c, 1, (size_t)n, stream);
    }
    c += n;
  }
}

void html_base64(FILE *stream, const void *data, size_t size) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const uint8_t *b = data;
  for (size_t i = 0; i < size; i += 3) {
    uint32_t v = (uint32_t)b[i] << 16;
    if (i + 1 < size) v |= (uint32_t)b[i + 1] << 8;
    if (i + 2 < size) v |= b[i + 2];
    char out[4] = {digits[v >> 18], digits[v >> 12 & 63], digits[v >> 6 & 63], digits[v & 63]};
    if (i + 1 >= size) out[2] = '=';
    if (i + 2 >= size) out[3] = '=';
    fwrite(out, 1, 4, stream);
  }
}

void html_script(FILE *stream, const char *data, size_t size) {
  for (size_t i = 0; i < size; i++) {
    fputc(data[i], stream);
    if (data[i] != '<') continue;
    if ((i + 7 < size && strncasecmp(data + i + 1, "/script", 7) == 0) ||
        (i + 3 < size && strncmp(data + i + 1, "!--", 3) == 0))
      /* Has no effect within a string, the only place where these characters can occur. */
      fputc('\\', stream);
  }
}

void html_json(FILE *stream, const char *json) {
  for (; *json != '\0'; json++) {
    if (*json == '<')
      fputs("\\u003c", stream);
    else
      fputc(*json, stream);
  }
}

static void put32(uint8_t *at, size_t value) { /* big-endian, as in PNG */
  for (int i = 0; i < 4; i++) at[i] = (uint8_t)(value >> (24 - 8 * i));
}

/* Writes one chunk of a PNG (length, type, data, checksum) at `at`; returns its end. */
static uint8_t *chunk(uint8_t *at, const char *type, const uint8_t *data, size_t size) {
  put32(at, size);
  memcpy(at + 4, type, 4);
  if (size > 0 && data != at + 8) memcpy(at + 8, data, size);
  put32(at + 8 + size, crc32(crc32(0, NULL, 0), at + 4, (uInt)(size + 4)));
  return at + 12 + size;
}

enum status html_png(FILE *stream, const uint8_t *pixels, size_t channels, size_t width,
                     size_t height, const uint32_t palette[256]) {
  enum status status = STATUS_OK;
  static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  const size_t row = 1 + channels * width;
  uint8_t *rows = NULL, *file = NULL, head[13] = {0}, colours[768];
  uLongf packed = compressBound((uLong)(row * height));
  TRY(memory_allocate(&rows, row * height, 1, "a picture"));
  TRY(memory_allocate(&file, packed + 1024, 1, "a picture"));
  for (size_t y = 0; y < height; y++) /* each row starts with its filter, 0 for none */
    memcpy(rows + y * row + 1, pixels + y * channels * width, channels * width);
  memcpy(file, signature, sizeof signature);
  put32(head, width);
  put32(head + 4, height);
  head[8] = 8;                     /* bits per channel */
  head[9] = channels == 1 ? 3 : 2; /* palette, or red, green and blue */
  uint8_t *at = chunk(file + 8, "IHDR", head, sizeof head);
  if (channels == 1) {
    for (size_t i = 0; i < 768; i++) colours[i] = (uint8_t)(palette[i / 3] >> (16 - 8 * (i % 3)));
    at = chunk(at, "PLTE", colours, sizeof colours);
  }
  if (compress2(at + 8, &packed, rows, (uLong)(row * height), 9) != Z_OK)
    TRY_FAIL(STATUS_RUN, "out of memory for a picture");
  at = chunk(at, "IDAT", at + 8, packed);
  at = chunk(at, "IEND", NULL, 0);
  fputs("data:image/png;base64,", stream);
  html_base64(stream, file, (size_t)(at - file));
cleanup:
  memory_free(&rows);
  memory_free(&file);
  return status;
}

enum status html_picture(FILE *stream, const uint8_t *pixels, size_t channels, size_t width,
                         size_t height, const uint32_t palette[256], const char *alt) {
  enum status status = STATUS_OK;
  fprintf(stream, "<img width=\"%zu\" height=\"%zu\" alt=\"", width, height);
  html_text(stream, alt);
  fputs("\" src=\"", stream);
  TRY(html_png(stream, pixels, channels, width, height, palette));
  fputs("\">", stream);
cleanup:
  return status;
}

void html_palette_grey(uint32_t palette[256]) {
  for (uint32_t i = 0; i < 256; i++) palette[i] = i * 0x010101u;
}
