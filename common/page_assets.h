/* Included by one file of a program, after it has defined ASSETS as ASSET(symbol, "file") for each
 * file of its page: defines `assets`, an array of struct asset. The assembler includes the files
 * unchanged ($(BUILD)/assets, see the Makefile); as arrays in C they would take seconds and
 * gigabytes to compile. */
#include <stdint.h>

#include "common/page.h"

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

#define ASSET(symbol, file) {file, asset_##symbol, (size_t)asset_##symbol##_size},
