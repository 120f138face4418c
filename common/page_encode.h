/* How data and files stand inside a page: bytes as base64 in JSON, JSON and scripts inside
 * <script>. */
#ifndef TOSUI_PAGE_ENCODE_H
#define TOSUI_PAGE_ENCODE_H

#include <jansson.h>
#include <stddef.h>
#include <stdio.h>

#include "common/error.h"

/* Bytes as base64 (RFC 4648), a new string; JSON null without memory. */
json_t *encode_bytes(const void *data, size_t size);
/* A field as {"low", "high", "bytes"}: a byte a value, 0 at `low`, 254 at `high`, 255 for NAN. */
json_t *encode_field(const float *values, size_t n, double low, double high);
/* Four bits a value of 0 to 1, the first in the low bits. */
json_t *encode_nibbles(const float *values, size_t n);

/* Writes JSON for the inside of <script>: every < as \u003c, which JSON parsers read back. */
void encode_json(FILE *stream, const char *json);
/* Writes a script for the inside of <script>, escaped such that it cannot end the element. */
void encode_script(FILE *stream, const char *data, size_t size);

#endif
