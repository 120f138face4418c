/* libFuzzer: any bytes as a DICOM file. */
#include "fuzz_image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  return fuzz_image(".dcm", NULL, data, size);
}
