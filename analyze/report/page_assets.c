#include "analyze/report/page_assets.h"

#include <stdint.h>

/* The assembler includes the files unchanged ($(BUILD)/assets, see the Makefile); as arrays in C
 * they would take seconds and gigabytes to compile. */
#define ASSET(symbol, file)                                                                        \
  __asm__(".pushsection .rodata\n"                                                                 \
          ".balign 16\n"                                                                           \
          "asset_" #symbol ": .incbin \"assets/" file "\"\n"                                       \
          "asset_" #symbol "_end: .byte 0\n"                                                       \
          ".balign 8\n"                                                                            \
          "asset_" #symbol "_size: .quad asset_" #symbol "_end - asset_" #symbol "\n"              \
          ".popsection\n");                                                                        \
  extern const char asset_##symbol[];                                                              \
  extern const uint64_t asset_##symbol##_size

ASSET(style, "page.css");
ASSET(script, "page.js");
ASSET(dygraph, "dygraph.min.js");
ASSET(dygraph_style, "dygraph.min.css");
ASSET(three, "three.min.js");
ASSET(orbit, "OrbitControls.js");

#define WHOLE(symbol)                                                                              \
  (struct asset) {                                                                                 \
    asset_##symbol, (size_t)asset_##symbol##_size                                                  \
  }

struct asset asset_get(enum asset_name name) {
  switch (name) {
  case ASSET_STYLE:
    return WHOLE(style);
  case ASSET_SCRIPT:
    return WHOLE(script);
  case ASSET_DYGRAPH:
    return WHOLE(dygraph);
  case ASSET_DYGRAPH_STYLE:
    return WHOLE(dygraph_style);
  case ASSET_THREE:
    return WHOLE(three);
  case ASSET_ORBIT:
    return WHOLE(orbit);
  }
  return (struct asset){"", 0};
}
