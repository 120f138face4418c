/* libFuzzer: any text as a quantity. */
#include <string.h>

#include "common/units.h"
#include "fuzz_input.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char *text = malloc(size + 1);
  double value;
  if (text == NULL) abort();
  if (size > 0) memcpy(text, data, size);
  text[size] = '\0';
  struct dimension dimensions[] = {DIM_LENGTH, DIM_NONE, DIM_VISCOSITY};
  for (int i = 0; i < 3; i++) (void)quantity_parse(text, dimensions[i], &value);
  free(text);
  return fuzz_end(NULL, 0);
}
