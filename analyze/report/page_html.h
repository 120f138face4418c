/* Output of HTML. Everything that comes from a file is passed through html_text. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_HTML_H
#define TOSUI_ANALYZE_REPORT_PAGE_HTML_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "common/error.h"

/* Writes `text` with & < > " ' escaped, control characters removed and invalid UTF-8 replaced. */
void html_text(FILE *stream, const char *text);
void html_base64(FILE *stream, const void *data, size_t size);
/* Writes a script for the inside of <script>, escaped such that it cannot end the element. */
void html_script(FILE *stream, const char *data, size_t size);
/* Writes JSON for the inside of <script>: every < as \u003c, which JSON parsers read back. */
void html_json(FILE *stream, const char *json);

/* Writes an 8-bit picture as a PNG in a data URL, row 0 at the top: one channel with a palette of
 * 256 colours 0xRRGGBB, or three channels (palette NULL). */
enum status html_png(FILE *stream, const uint8_t *pixels, size_t channels, size_t width,
                     size_t height, const uint32_t palette[256]);
/* The same as an <img>; `alt` is escaped. */
enum status html_picture(FILE *stream, const uint8_t *pixels, size_t channels, size_t width,
                         size_t height, const uint32_t palette[256], const char *alt);
/* Palette from black to white. */
void html_palette_grey(uint32_t palette[256]);

#endif
