#include "analyze/report/page_html.h"

#include <string.h>
#include <strings.h>

#include "common/memory.h"

/* Length of the well-formed UTF-8 sequence at `c`, 0 if there is none. */
static int utf8_length(const unsigned char *c) {
  static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  int n = c[0] < 0x80 ? 1 : c[0] >> 5 == 6 ? 2 : c[0] >> 4 == 14 ? 3 : c[0] >> 3 == 30 ? 4 : 0;
  if (n < 2) return n;
  uint32_t code = c[0] & (0x7fu >> n);
  for (int i = 1; i < n; i++) {
    if ((c[i] & 0xc0) != 0x80) return 0;
    code = code << 6 | (c[i] & 0x3fu);
  }
  return code < least[n] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000) ? 0 : n;
}

void html_text(FILE *stream, const char *text) {
  const unsigned char *c = (const unsigned char *)text;
  while (*c != '\0') {
    int n = utf8_length(c);
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
      if (n > 1 || *c >= 0x20 || *c == '\n' || *c == '\t') fwrite(c, 1, (size_t)n, stream);
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
      fputc('\\', stream); /* means nothing in a string, where alone these can stand */
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

static void put32(uint8_t *at, size_t value) {
  for (int i = 0; i < 4; i++) at[i] = (uint8_t)(value >> (8 * i));
}

enum status html_picture(FILE *stream, const uint8_t *pixels, size_t width, size_t height,
                         const uint32_t palette[256], const char *alt) {
  enum status status = STATUS_OK;
  uint8_t *file = NULL;
  const size_t head = 54 + 1024, row = (width + 3) / 4 * 4, size = head + row * height;
  TRY(memory_allocate(&file, size, 1, "a picture"));
  file[0] = 'B', file[1] = 'M';
  put32(file + 2, size);
  put32(file + 10, head);
  put32(file + 14, 40);
  put32(file + 18, width);
  put32(file + 22, height);
  file[26] = 1; /* plane */
  file[28] = 8; /* bits a pixel */
  put32(file + 46, 256);
  for (size_t i = 0; i < 256; i++) put32(file + 54 + 4 * i, palette[i]);
  for (size_t y = 0; y < height; y++)
    memcpy(file + head + (height - 1 - y) * row, pixels + y * width, width);
  fprintf(stream, "<img width=\"%zu\" height=\"%zu\" alt=\"", width, height);
  html_text(stream, alt);
  fputs("\" src=\"data:image/bmp;base64,", stream);
  html_base64(stream, file, size);
  fputs("\">", stream);
cleanup:
  memory_free(&file);
  return status;
}

void html_palette_grey(uint32_t palette[256]) {
  for (uint32_t i = 0; i < 256; i++) palette[i] = i * 0x010101u;
}
