#include "common/image_file.h"

enum status image_file_begin(struct h5_file *file, const size_t size[3], const double spacing[3],
                             const double origin[3]) {
  enum status status = STATUS_OK;
  const int version[2] = {1, 0};
  const int extent[6] = {0, (int)size[0] - 1, 0, (int)size[1] - 1, 0, (int)size[2] - 1};
  const double direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  TRY(h5_make_group(file, "/VTKHDF"));
  TRY(h5_write_attribute(file, "/VTKHDF", "Version", H5_I32, 2, version));
  TRY(h5_write_attribute_text(file, "/VTKHDF", "Type", "ImageData"));
  TRY(h5_write_attribute(file, "/VTKHDF", "WholeExtent", H5_I32, 6, extent));
  TRY(h5_write_attribute(file, "/VTKHDF", "Origin", H5_F64, 3, origin));
  TRY(h5_write_attribute(file, "/VTKHDF", "Spacing", H5_F64, 3, spacing));
  TRY(h5_write_attribute(file, "/VTKHDF", "Direction", H5_F64, 9, direction));
cleanup:
  return status;
}
