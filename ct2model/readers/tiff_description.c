#include "ct2model/readers/tiff_description.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ct2model/readers/length_unit.h"

bool tiff_description_value(const char *description, const char *key, char *value, size_t size) {
  size_t length = strlen(key);
  for (const char *line = description; line != NULL && *line != '\0';) {
    const char *end = strchr(line, '\n');
    size_t n = end != NULL ? (size_t)(end - line) : strlen(line);
    if (n > length && strncmp(line, key, length) == 0 && line[length] == '=') {
      snprintf(value, size, "%.*s", (int)(n - length - 1), line + length + 1);
      return true;
    }
    line = end != NULL ? end + 1 : NULL;
  }
  return false;
}

/* PhysicalSizeX="5.83" PhysicalSizeXUnit="um" of OME-XML; micrometres if no unit is given. */
static double ome_size(const char *xml, char axis) {
  char key[32], value[40], unit[16] = "um";
  snprintf(key, sizeof key, "PhysicalSize%c=\"", axis);
  const char *at = strstr(xml, key);
  if (at == NULL || sscanf(at + strlen(key), "%39[^\"]", value) != 1) return NAN;
  snprintf(key, sizeof key, "PhysicalSize%cUnit=\"", axis);
  const char *unit_at = strstr(xml, key);
  if (unit_at != NULL) (void)sscanf(unit_at + strlen(key), "%15[^\"]", unit);
  return strtod(value, NULL) * length_unit(unit);
}

void tiff_voxel_size(const char *description, const float resolution[2], double metres,
                     double voxel[3], const char **source) {
  char text[40], other[40];
  if (description != NULL && strstr(description, "PhysicalSizeX") != NULL) {
    voxel[0] = ome_size(description, 'X');
    voxel[1] = ome_size(description, 'Y');
    voxel[2] = ome_size(description, 'Z');
    if (voxel[0] > 0.0) *source = "OME metadata";
    return;
  }
  const bool imagej = description != NULL && strncmp(description, "ImageJ=", 7) == 0;
  double unit[3] = {metres, metres, metres};
  if (imagej && tiff_description_value(description, "unit", text, sizeof text)) {
    static const char *const OF_AXIS[] = {"unit", "yunit", "zunit"};
    for (int axis = 0; axis < 3; axis++) {
      unit[axis] = length_unit(text);
      if (tiff_description_value(description, OF_AXIS[axis], other, sizeof other))
        unit[axis] = length_unit(other);
    }
    *source = "ImageJ metadata";
  } else if (isfinite(metres)) {
    *source = "TIFF resolution tags";
  }
  for (int axis = 0; axis < 2; axis++) {
    double edge = unit[axis] / (double)resolution[axis];
    /* A coarse resolution, of 600 dpi (42 um) or less, is that of a page, unless the unit is one of
     * microscopy. */
    bool page = unit[axis] >= 0.0254 * 0.39 && (double)resolution[axis] / unit[axis] < 24000.0;
    voxel[axis] = resolution[axis] > 0.0f && isfinite(edge) && !page ? edge : NAN;
  }
  if (imagej && isfinite(voxel[0]) &&
      tiff_description_value(description, "spacing", text, sizeof text))
    voxel[2] = fabs(strtod(text, NULL)) * unit[2];
  if (!(voxel[2] > 0.0)) voxel[2] = NAN;
  if (!isfinite(voxel[0])) *source = NULL;
}

enum status tiff_refuse_hyperstack(const char *path, const char *description) {
  static const char *const KEYS[] = {"channels", "frames"}, *const OME[] = {"SizeC=\"", "SizeT=\""};
  char text[40];
  if (description == NULL) return STATUS_OK;
  bool imagej = strncmp(description, "ImageJ=", 7) == 0;
  bool ome = strstr(description, "<OME") != NULL;
  for (size_t i = 0; i < sizeof KEYS / sizeof *KEYS; i++) {
    const char *at = ome ? strstr(description, OME[i]) : NULL;
    int count = at != NULL ? atoi(at + strlen(OME[i])) : 1;
    if (imagej && tiff_description_value(description, KEYS[i], text, sizeof text))
      count = atoi(text);
    if (count > 1)
      return FAIL(STATUS_INPUT,
                  "%s: a hyperstack of %d %s; save one of them as a stack, or if they are slices "
                  "say so (Fiji: Image > Properties) and save again",
                  path, count, KEYS[i]);
  }
  return STATUS_OK;
}
