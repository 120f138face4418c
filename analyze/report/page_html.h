/* Pieces of HTML. Whatever comes from a file passes through html_text. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_HTML_H
#define TOSUI_ANALYZE_REPORT_PAGE_HTML_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "common/error.h"

/* `text` with & < > " ' escaped, control characters dropped and bytes that are no UTF-8 replaced.
 */
void html_text(FILE *stream, const char *text);
void html_base64(FILE *stream, const void *data, size_t size);
/* A script for the inside of <script>: nothing in it ends the element. */
void html_script(FILE *stream, const char *data, size_t size);
/* JSON for the inside of <script>: every < as \u003c, which JSON reads back. */
void html_json(FILE *stream, const char *json);

/* A picture of 8 bits as a PNG in a data URL, row 0 on top: one channel through a palette of 256
 * colours 0xRRGGBB, or three channels (palette NULL). */
enum status html_png(FILE *stream, const uint8_t *pixels, size_t channels, size_t width,
                     size_t height, const uint32_t palette[256]);
/* The same as an <img>. `alt` is escaped. */
enum status html_picture(FILE *stream, const uint8_t *pixels, size_t channels, size_t width,
                         size_t height, const uint32_t palette[256], const char *alt);
/* Black to white. */
void html_palette_grey(uint32_t palette[256]);

#endif
