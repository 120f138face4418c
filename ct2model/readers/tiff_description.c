#include "ct2model/readers/tiff_description.h"

#include <math.h>
#include <stdint.h>
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

/* Texts of lines "key=value", of ImageJ and of its successor. */
static bool is_imagej(const char *description) {
  return strncmp(description, "ImageJ=", 7) == 0 || strncmp(description, "SCIFIO=", 7) == 0;
}

/* The first letter of the value of the first attribute `key` of an XML text, in quotes of either
 * kind; NULL if there is none. */
static const char *xml_value(const char *xml, const char *key) {
  static const char SPACE[] = " \t\r\n";
  for (const char *at = xml; (at = strstr(at, key)) != NULL;) {
    const bool begins = at > xml && strchr(SPACE, at[-1]) != NULL;
    at += strlen(key);
    const char *equals = at + strspn(at, SPACE);
    const char *quote = *equals == '=' ? equals + 1 + strspn(equals + 1, SPACE) : equals;
    if (begins && *equals == '=' && (*quote == '"' || *quote == '\'')) return quote + 1;
  }
  return NULL;
}

/* A number that is all of a text, to a quote if it ends in one; NAN of any other, as of "5,83". */
static double whole_number(const char *text) {
  char *end;
  const double value = strtod(text, &end);
  end += strspn(end, " \t\r");
  return end > text && (*end == '\0' || *end == '"' || *end == '\'') ? value : NAN;
}

/* PhysicalSizeX="5.83" PhysicalSizeXUnit="um" of OME-XML; micrometres if no unit is given. */
static double ome_size(const char *xml, char axis) {
  char key[32], unit[16] = "um";
  snprintf(key, sizeof key, "PhysicalSize%c", axis);
  const char *at = xml_value(xml, key);
  snprintf(key, sizeof key, "PhysicalSize%cUnit", axis);
  const char *unit_at = xml_value(xml, key);
  if (unit_at != NULL) (void)sscanf(unit_at, "%15[^\"']", unit);
  const double size = at != NULL ? whole_number(at) * length_unit(unit) : NAN;
  return size > 0.0 ? size : NAN;
}

double tiff_spacing(const char *description) {
  char text[40];
  const bool told = description != NULL && is_imagej(description) &&
                    tiff_description_value(description, "spacing", text, sizeof text);
  return told ? fabs(whole_number(text)) : NAN;
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
  const bool imagej = description != NULL && is_imagej(description);
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
  voxel[2] = isfinite(voxel[0]) ? tiff_spacing(description) * unit[2] : NAN;
  if (!(voxel[2] > 0.0)) voxel[2] = NAN;
  if (!isfinite(voxel[0])) *source = NULL;
}

/* Whether it is OME's XML, with a prefix of its names or not. */
static bool is_ome(const char *description) {
  return strstr(description, "<OME") != NULL || strstr(description, ":OME ") != NULL;
}

const char *tiff_json_value(const char *description, const char *key) {
  char quoted[24];
  snprintf(quoted, sizeof quoted, "\"%s\"", key);
  const char *at = strstr(description, quoted);
  if (at == NULL) return NULL;
  at += strlen(quoted);
  return at + strspn(at, " \t:[\"");
}

/* The text after `key`; NULL if it is not there. */
static const char *after(const char *text, const char *key) {
  const char *at = strstr(text, key);
  return at != NULL ? at + strlen(key) : NULL;
}

enum status tiff_refuse_hyperstack(const char *path, unsigned long long count, const char *kind) {
  return FAIL(STATUS_INPUT,
              "%s: a hyperstack of %llu %s; save one of them as a stack, or if they are slices "
              "say so (Fiji: Image > Properties) and save again",
              path, count, kind);
}

/* ScanImage: "SI.hChannels.channelSave = [1;2]", older "numberOfChannelsSave=2". */
enum status tiff_told_channels(const char *path, const char *text) {
  static const char *const LISTS[] = {"hannelSave", "hannelsSave"}, DIGITS[] = "0123456789";
  const char *number = text != NULL ? after(text, "numberOfChannelsSave=") : NULL;
  unsigned long long count = number != NULL ? strtoull(number, NULL, 10) : 0;
  for (size_t i = 0; i < 2 && text != NULL && count == 0; i++) {
    const char *list = after(text, LISTS[i]);
    if (list != NULL) list += strspn(list, " =");
    if (list == NULL || *list != '[') continue;
    const char *end = list + strcspn(list, "]\n");
    for (list += strcspn(list, DIGITS); list < end; list += strcspn(list, DIGITS), count++)
      list += strspn(list, DIGITS);
  }
  return count > 1 ? tiff_refuse_hyperstack(path, count, "channels") : STATUS_OK;
}

/* The array of tifffile, {"shape": [57, 1, 256, 256], "axes": "ZCYX"}: pages are of its last axes,
 * the samples among them; those before are slices, or something else. */
static enum status read_shape(const char *path, const char *description, const size_t page[3],
                              unsigned long long *slices) {
  enum { MOST = 8 };
  unsigned long long n[MOST + 3], all = 1;
  int rank = 0, of_page = 2, longer = 0;
  const char *at = tiff_json_value(description, "shape");
  const char *axes = tiff_json_value(description, "axes");
  while (at != NULL && rank < MOST + 3) {
    char *end;
    n[rank] = strtoull(at, &end, 10);
    if (end == at || n[rank] == 0 || n[rank] > UINT32_MAX) return STATUS_OK;
    rank++;
    if (*end == ']') break;
    at = end + strspn(end, ", ");
  }
  if (page[2] > 1) of_page = 3;
  if (at == NULL || rank > MOST || rank <= of_page)
    return STATUS_OK; /* one page: of one appended */
  const unsigned long long *last = n + rank - of_page;
  const bool agrees = of_page == 2
                          ? last[0] == page[1] && last[1] == page[0]
                          : (last[0] == page[1] && last[1] == page[0] && last[2] == page[2]) ||
                                (last[0] == page[2] && last[1] == page[1] && last[2] == page[0]);
  if (!agrees) return STATUS_OK; /* of another series */
  const size_t named = axes != NULL ? strcspn(axes, "\"") : 0;
  for (int i = 0; i < rank - of_page; i++) {
    const char axis = axes != NULL && named == (size_t)rank ? axes[i] : 'Z';
    all = all < UINT32_MAX ? all * n[i] : all;
    if (n[i] > 1) longer++;
    if (n[i] > 1 && (axis == 'C' || axis == 'T'))
      return tiff_refuse_hyperstack(path, n[i], axis == 'C' ? "channels" : "frames");
  }
  if (longer > 1)
    return FAIL(STATUS_INPUT,
                "%s: an array of %d axes, %llu x %llu ... pages; 3 are read: save one volume", path,
                rank, n[0], n[1]);
  *slices = all;
  return STATUS_OK;
}

/* OME may put the slices on pages in any order (<TiffData FirstZ="2" IFD="0"/>), and into several
 * files (a UUID with a FileName follows): what is read is the pages as they come. */
static enum status check_order(const char *path, const char *xml) {
  static const char UUID[] = "><UUID FileName=\"";
  enum { MOST = 200 };
  char tag[MOST], name[MOST], last[MOST] = "";
  unsigned long long before = 0;
  bool first = true;
  const char *end = strstr(xml, "Pixels>"); /* of further images */
  for (const char *at = after(xml, "TiffData "); at != NULL && (end == NULL || at < end);
       at = after(at, "TiffData ")) {
    const size_t length = strcspn(at, ">");
    snprintf(tag, sizeof tag, " %.*s", (int)(length < MOST ? length : MOST), at);
    const char *on_page = xml_value(tag, "IFD"), *slice = xml_value(tag, "FirstZ");
    if (on_page == NULL) continue;
    const unsigned long long page = strtoull(on_page, NULL, 10);
    const unsigned long long z = slice != NULL ? strtoull(slice, NULL, 10) : 0;
    const char *child = at + length;
    const bool named = strncmp(child, UUID, strlen(UUID)) == 0;
    const char *of = named ? child + strlen(UUID) : "";
    const size_t letters = strcspn(of, "\"");
    snprintf(name, sizeof name, "%.*s", (int)(letters < MOST ? letters : MOST), of);
    if (!first && strcmp(name, last) == 0 && z - page != before)
      return FAIL(STATUS_INPUT,
                  "%s: its text (OME) puts slice %llu on page %llu, and others in another order; "
                  "save it again with the slices in order",
                  path, z, page);
    before = z - page;
    first = false;
    memcpy(last, name, sizeof last);
  }
  return STATUS_OK;
}

enum status tiff_told_slices(const char *path, const char *description, const size_t page[3],
                             unsigned long long *slices, bool *follow) {
  static const char *const KEYS[] = {"channels", "frames"}, *const OME[] = {"SizeC", "SizeT"};
  char text[40];
  *slices = 0;
  *follow = false;
  if (description == NULL) return STATUS_OK;
  const bool imagej = is_imagej(description);
  const bool ome = is_ome(description);
  for (size_t i = 0; i < sizeof KEYS / sizeof *KEYS; i++) {
    const char *at = ome ? xml_value(description, OME[i]) : NULL;
    unsigned long long count = at != NULL ? strtoull(at, NULL, 10) : 1;
    if (imagej && tiff_description_value(description, KEYS[i], text, sizeof text))
      count = strtoull(text, NULL, 10);
    if (count > 1) return tiff_refuse_hyperstack(path, count, KEYS[i]);
  }
  const char *ome_slices = ome ? xml_value(description, "SizeZ") : NULL;
  if (ome && check_order(path, description) != STATUS_OK) return STATUS_INPUT;
  if (ome_slices != NULL) *slices = strtoull(ome_slices, NULL, 10);
  *follow = imagej || description[0] == '{';
  if (imagej && tiff_description_value(description, "images", text, sizeof text) && text[0] != '-')
    *slices = strtoull(text, NULL, 10);
  return description[0] == '{' ? read_shape(path, description, page, slices) : STATUS_OK;
}
