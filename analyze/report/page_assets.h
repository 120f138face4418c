/* Files that are part of the program: the page's own style and script, and the libraries that were
 * installed when it was built (size 0: they were not). They end without a zero byte. */
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
/* Not to be freed. */
struct asset asset_get(enum asset_name name);

#endif
