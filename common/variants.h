/* A loop compiled for several instruction sets, of which the loader picks one. clang 14 exports
 * such a function under another name, so that with it (the sanitizers' compiler) there is one. */
#ifndef TOSUI_COMMON_VARIANTS_H
#define TOSUI_COMMON_VARIANTS_H

#ifdef __clang__
#define TARGETS
#else
#define TARGETS __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif

#endif
