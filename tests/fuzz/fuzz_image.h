/* Any bytes as a file of a stack: header, all pages, the stack round it. */
#ifndef TOSUI_FUZZ_IMAGE_H
#define TOSUI_FUZZ_IMAGE_H

#include "ct2model/readers/stack.h"
#include "fuzz_input.h"

/* `inside`: what of the file is the image, "" where all of it is. */
static inline int fuzz_image_inside(const char *ending, const char *inside,
                                    const struct raw_layout *raw, const uint8_t *data,
                                    size_t size) {
  const char *path = fuzz_file(ending, data, size);
  char whole[160];
  const char *image = whole;
  struct stack stack;
  float *slice = NULL;
  snprintf(whole, sizeof whole, "%s%s", path, inside);
  if (stack_open(&image, 1, raw, &stack) == STATUS_OK) {
    size_t pixels = stack.size[0] * stack.size[1], first = 0;
    char name[64];
    stack_slice_name(&stack, stack.size[2] - 1, name, sizeof name);
    if (pixels <= (size_t)1 << 20 && stack_keep_labels(&stack, 0) == STATUS_OK &&
        memory_allocate(&slice, pixels, sizeof *slice, "a slice") == STATUS_OK)
      while (first < stack.size[2] && first < 4 && stack_read(&stack, first, slice) == STATUS_OK &&
             (!stack.has_levels || stack_read_stored(&stack, first, slice) == STATUS_OK))
        first++;
    memory_free(&slice);
    stack_close(&stack);
  }
  return fuzz_end(path, 0);
}

static inline int fuzz_image(const char *ending, const struct raw_layout *raw, const uint8_t *data,
                             size_t size) {
  return fuzz_image_inside(ending, "", raw, data, size);
}

#endif
