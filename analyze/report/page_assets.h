/* Files that are part of the program: the page, its style and script, and the libraries that were
 * installed when the program was built (size 0 if not). They are not terminated by a zero byte. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_ASSETS_H
#define TOSUI_ANALYZE_REPORT_PAGE_ASSETS_H

#include <stddef.h>

struct asset {
  const char *name; /* of the file, "page.css"; NULL: there is none of that name */
  const char *data; /* static, must not be freed */
  size_t size;
};

/* The file whose name is the `length` first characters of `name`. */
struct asset asset_get(const char *name, size_t length);

#endif
