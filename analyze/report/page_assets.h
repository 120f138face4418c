/* Files that are part of the program: style and script of the page, and the libraries that were
 * installed when the program was built (size 0 if not). They are not terminated by a zero byte. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_ASSETS_H
#define TOSUI_ANALYZE_REPORT_PAGE_ASSETS_H

#include <stddef.h>

struct asset {
  const char *data;
  size_t size;
};

enum asset_name {
  ASSET_STYLE,
  ASSET_SCRIPT,
  ASSET_DYGRAPH,
  ASSET_DYGRAPH_STYLE,
  ASSET_THREE,
  ASSET_ORBIT
};
/* The data are static and must not be freed. */
struct asset asset_get(enum asset_name name);

#endif
