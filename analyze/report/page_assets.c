#include "analyze/report/page_assets.h"

#include <stdint.h>
#include <string.h>

/* The assembler includes the files unchanged ($(BUILD)/assets, see the Makefile); as arrays in C
 * they would take seconds and gigabytes to compile. */
#define ASSETS                                                                                     \
  ASSET(page, "page.html")                                                                         \
  ASSET(style, "page.css")                                                                         \
  ASSET(script, "page.js")                                                                         \
  ASSET(pictures, "page_pictures.js")                                                              \
  ASSET(dygraph, "dygraph.min.js")                                                                 \
  ASSET(dygraph_style, "dygraph.min.css")                                                          \
  ASSET(three, "three.min.js")                                                                     \
  ASSET(orbit, "OrbitControls.js")

#define ASSET(symbol, file)                                                                        \
  __asm__(".pushsection .rodata\n"                                                                 \
          ".balign 16\n"                                                                           \
          "asset_" #symbol ": .incbin \"assets/" file "\"\n"                                       \
          "asset_" #symbol "_end: .byte 0\n"                                                       \
          ".balign 8\n"                                                                            \
          "asset_" #symbol "_size: .quad asset_" #symbol "_end - asset_" #symbol "\n"              \
          ".popsection\n");                                                                        \
  extern const char asset_##symbol[];                                                              \
  extern const uint64_t asset_##symbol##_size;
ASSETS
#undef ASSET

struct asset asset_get(const char *name, size_t length) {
#define ASSET(symbol, file) {file, asset_##symbol, (size_t)asset_##symbol##_size},
  const struct asset assets[] = {ASSETS};
#undef ASSET
  for (size_t i = 0; i < sizeof assets / sizeof *assets; i++)
    if (strlen(assets[i].name) == length && strncmp(assets[i].name, name, length) == 0)
      return assets[i];
  return (struct asset){NULL, "", 0};
}
