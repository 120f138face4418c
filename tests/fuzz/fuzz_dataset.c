/* libFuzzer: any bytes as an HDF5 file whose dataset /image is an image. */
#include "fuzz_image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  return fuzz_image_inside(".h5", ":/image", NULL, data, size);
}
