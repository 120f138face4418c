/* Compiles a loop for several instruction sets, one of which is chosen when the program is loaded.
 * clang 14 (used for the sanitizers) exports such a function under another name, so there is only
 * one version with it. */
#ifndef TOSUI_COMMON_VARIANTS_H
#define TOSUI_COMMON_VARIANTS_H

#ifdef __clang__
#define TARGETS
#else
#define TARGETS __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif

#endif
