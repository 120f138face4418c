#include "common/page_encode.h"

#include <math.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

#include "common/json_number.h"
#include "common/memory.h"

json_t *encode_bytes(const void *data, size_t size) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const uint8_t *b = data;
  char *text = NULL;
  if (memory_allocate(&text, size / 3 + 1, 4, "a picture") != STATUS_OK) {
    error_clear();
    return json_null();
  }
  size_t n = 0;
  for (size_t i = 0; i < size; i += 3) {
    uint32_t v = (uint32_t)b[i] << 16;
    if (i + 1 < size) v |= (uint32_t)b[i + 1] << 8;
    if (i + 2 < size) v |= b[i + 2];
    text[n++] = digits[v >> 18];
    text[n++] = digits[v >> 12 & 63];
    text[n++] = i + 1 < size ? digits[v >> 6 & 63] : '=';
    text[n++] = i + 2 < size ? digits[v & 63] : '=';
  }
  json_t *value = json_stringn(text, n);
  memory_free(&text);
  return value;
}

enum { FIELD = 254, NIBBLE = 15 }; /* highest value of a byte, and of four bits */

json_t *encode_field(const float *values, size_t n, double low, double high) {
  uint8_t *bytes = NULL;
  if (memory_allocate(&bytes, n + 1, 1, "a picture") != STATUS_OK) {
    error_clear();
    return json_null();
  }
  for (size_t i = 0; i < n; i++) {
    const double share = ((double)values[i] - low) / (high - low);
    bytes[i] =
        isnan(share) ? FIELD + 1 : (uint8_t)lrint((double)FIELD * fmin(fmax(share, 0.0), 1.0));
  }
  json_t *field = json_pack("{s:o,s:o,s:o}", "low", json_number(low), "high", json_number(high),
                            "bytes", encode_bytes(bytes, n));
  memory_free(&bytes);
  return field;
}

json_t *encode_nibbles(const float *values, size_t n) {
  uint8_t *bytes = NULL;
  if (memory_allocate(&bytes, n / 2 + 1, 1, "a picture") != STATUS_OK) {
    error_clear();
    return json_null();
  }
  for (size_t i = 0; i < n; i++)
    bytes[i / 2] |= (uint8_t)((unsigned)lrintf((float)NIBBLE * values[i]) << (i % 2 * 4));
  json_t *text = encode_bytes(bytes, (n + 1) / 2);
  memory_free(&bytes);
  return text;
}

void encode_json(FILE *stream, const char *json) {
  for (; *json != '\0'; json++) {
    if (*json == '<')
      fputs("\\u003c", stream);
    else
      fputc(*json, stream);
  }
}

void encode_script(FILE *stream, const char *data, size_t size) {
  for (size_t i = 0; i < size; i++) {
    fputc(data[i], stream);
    if (data[i] != '<') continue;
    if ((i + 7 < size && strncasecmp(data + i + 1, "/script", 7) == 0) ||
        (i + 3 < size && strncmp(data + i + 1, "!--", 3) == 0))
      /* Has no effect within a string, the only place where these characters can occur. */
      fputc('\\', stream);
  }
}
