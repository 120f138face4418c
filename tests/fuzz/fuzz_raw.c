/* libFuzzer: the first line as --raw, the rest as its pixels. */
#include <string.h>

#include "fuzz_image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const uint8_t *end = memchr(data, '\n', size);
  char text[64] = "";
  struct raw_layout raw;
  if (end == NULL || (size_t)(end - data) >= sizeof text) return 0;
  memcpy(text, data, (size_t)(end - data));
  if (raw_layout_parse(text, &raw) != STATUS_OK) return fuzz_end(NULL, 0);
  end++;
  return fuzz_image(".raw", &raw, end, size - (size_t)(end - data));
}
