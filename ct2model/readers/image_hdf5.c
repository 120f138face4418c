#include "ct2model/readers/image.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "common/hdf5_file.h"
#include "common/memory.h"
#include "ct2model/readers/constants.h"
#include "ct2model/readers/dataset_name.h"
#include "ct2model/readers/image_shape.h"
#include "ct2model/readers/length_unit.h"

/* Pages are read several at a time, as a chunk may hold many; HDF5 is not thread-safe. */
#define BLOCK_BYTES 64e6
enum { BLOCK_MOST = 64 };

struct image_dataset {
  struct h5_file *file;
  char *name;
  enum h5_type type;
  int rank, z_axis;          /* -1: one page */
  size_t first, count, most; /* pages in `block` */
  char *block;
};

static pthread_mutex_t one_thread = PTHREAD_MUTEX_INITIALIZER;

/* MATLAB (-v7.3) puts 512 bytes of text before the signature. */
static bool hdf5_claims(const char *path, const unsigned char *head, size_t n) {
  static const char SIGNATURE[] = "\x89HDF\r\n\x1a\n";
  (void)path;
  return (n >= 8 && memcmp(head, SIGNATURE, 8) == 0) ||
         (n >= 520 && memcmp(head + 512, SIGNATURE, 8) == 0);
}

/* Lists the contents of a group, for the message. */
static void list_group(struct h5_file *file, const char *group, char list[200]) {
  size_t count = 0;
  char **names = NULL;
  list[0] = '\0';
  if (h5_list(file, group, &count, &names) != STATUS_OK) error_clear(); /* it is no group */
  for (size_t i = 0; i < count; i++)
    snprintf(list + strlen(list), 200 - strlen(list), " %s/%s", strcmp(group, "/") ? group : "",
             names[i]);
  h5_free_texts(count, &names);
}

/* Finds the dataset of a file for which none is named: the only array in it. */
static enum status find_dataset(struct h5_file *file, struct image *image, char **name) {
  enum status status = STATUS_OK;
  char list[200] = "", **names = NULL;
  size_t count = 0;
  if (h5_exists(file, "/run"))
    return FAIL(STATUS_INPUT, "%s: a run, no image: analyze reads it", h5_path(file));
  if (h5_exists(file, "/model"))
    return FAIL(STATUS_INPUT,
                "%s: a model already, no image: sphsolve solves the flow in it, ct2model export "
                "writes its slices",
                h5_path(file));
  TRY(h5_list_arrays(file, &count, &names));
  if (count == 1) {
    *name = names[0];
    names[0] = NULL;
    image_note(image, "its one array, %s, is taken", *name);
    goto cleanup;
  }
  for (size_t i = 0; i < count; i++)
    snprintf(list + strlen(list), sizeof list - strlen(list), " %s", names[i]);
  if (count == 0) list_group(file, "/", list);
  TRY_FAIL(STATUS_INPUT, "%s: an HDF5 file; name the dataset, as %s:/dataset (it has%s)",
           h5_path(file), h5_path(file), list);
cleanup:
  h5_free_texts(count, &names);
  return status;
}

/* Whether netCDF's attribute says that integers have a sign, or none, other than they are stored
 * with (NetCDF Users Guide, Attribute Conventions, _Unsigned). */
static bool sign_is_other(struct h5_file *file, const char *name, char format) {
  char *text = NULL;
  if (!h5_attribute_exists(file, name, "_Unsigned")) return false;
  if (h5_read_attribute_text(file, name, "_Unsigned", &text) != STATUS_OK) error_clear();
  const bool other = text != NULL && ((format == 'i' && strcasecmp(text, "true") == 0) ||
                                      (format == 'u' && strcasecmp(text, "false") == 0));
  memory_free(&text);
  return other;
}

/* The type of a pixel, and that in which numbers are read: the HDF5 layer below has no others.
 * `stored`: the format with which they are stored, other than `format` where sign_is_other. */
static void choose_types(int bits, char stored, char format, enum pixel_type *pixel,
                         enum h5_type *type) {
  const bool whole = format != 'f';
  if (!whole || bits > 32 || !pixel_type_of(bits, format, pixel))
    *pixel = !whole && bits <= 32 ? PIXEL_F32 : PIXEL_F64;
  *type = *pixel == PIXEL_U8    ? H5_U8
          : *pixel == PIXEL_U32 ? H5_U32
          : *pixel == PIXEL_F32 ? H5_F32
          : *pixel == PIXEL_F64 ? H5_F64
                                : H5_I32;
  if (stored != format) *type = bits == 32 && stored == 'u' ? H5_U32 : H5_I32; /* see narrow */
}

/* Converts the numbers read to pixels: those of less than 32 bits were widened. */
static void narrow(const char *from, size_t n, enum pixel_type pixel, enum h5_type type,
                   void *out) {
  const size_t bytes = pixel_size(pixel);
  if (bytes == h5_type_size(type)) {
    memcpy(out, from, n * bytes);
    return;
  }
  for (size_t i = 0; i < n; i++) {
    int32_t value;
    memcpy(&value, from + i * sizeof value, sizeof value);
    const int8_t small = (int8_t)value;
    const int16_t wide = (int16_t)value; /* the low bits, signed or not */
    memcpy((char *)out + i * bytes, bytes == 1 ? (const void *)&small : (const void *)&wide, bytes);
  }
}

/* Values that are no measurement (CF conventions, 2.5.1), as pixels of `bits` and `format`;
 * `other`: these are stored with the other sign. */
static void read_no_data(struct h5_file *file, const char *name, int bits, char format, bool other,
                         struct image *image) {
  static const char *const NAMES[] = {"_FillValue", "missing_value", "valid_min", "valid_max",
                                      "valid_range"};
  const double span = ldexp(1.0, bits);
  for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
    const size_t count = i == 4 ? 2 : 1;
    double value[2];
    if (!h5_attribute_exists(file, name, NAMES[i])) continue;
    if (h5_read_attribute(file, name, NAMES[i], H5_F64, count, value) != STATUS_OK) {
      error_clear();
      image_note(image, "its attribute %s is not heeded: no single number", NAMES[i]);
      continue;
    }
    for (size_t k = 0; k < count; k++) { /* they have the sign that is stored */
      if (other && format == 'u' && value[k] < 0.0) value[k] += span;
      if (other && format == 'i' && value[k] >= 0.5 * span) value[k] -= span;
    }
    if (i < 2) image_no_data(image, value[0], value[0], NAMES[i]);
    if (i == 2 || i == 4)
      image_no_data(image, -INFINITY, (double)nextafterf((float)value[0], -INFINITY), NAMES[i]);
    if (i > 2)
      image_no_data(image, (double)nextafterf((float)value[count - 1], INFINITY), INFINITY,
                    NAMES[i]);
  }
}

/* Projections are no slices: in Data Exchange and NXtomo an angle, or the kind of picture, stands
 * for each beside them. */
static enum status check_slices(struct h5_file *file, const char *name, size_t pages) {
  static const char *const OF_EACH[] = {"theta", "rotation_angle", "image_key"};
  char beside[240];
  for (size_t i = 0; i < sizeof OF_EACH / sizeof *OF_EACH; i++) {
    size_t count;
    int rank;
    snprintf(beside, sizeof beside, "%.*s/%s", (int)(strrchr(name, '/') - name), name, OF_EACH[i]);
    if (pages < 2 || strlen(beside) + 1 == sizeof beside || !h5_exists(file, beside)) continue;
    if (h5_shape(file, beside, 1, &rank, &count) != STATUS_OK)
      error_clear();
    else if (rank == 1 && count == pages)
      return FAIL(STATUS_INPUT,
                  "%s: %s holds projections, as %s beside it tells, and no slices; reconstruct "
                  "them first",
                  h5_path(file), name, beside);
  }
  return STATUS_OK;
}

/* The names of the axes in EMD: of dim1, dim2 ... beside the array, slowest first. */
static enum status names_of_scales(struct h5_file *file, const char *group, char text[16]) {
  enum status status = STATUS_OK;
  char scale[240], *name = NULL;
  text[0] = '\0';
  for (int i = 1; i <= 3; i++) {
    snprintf(scale, sizeof scale, "%.200s/dim%d", group, i);
    if (!h5_exists(file, scale) || !h5_attribute_exists(file, scale, "name")) continue;
    TRY(h5_read_attribute_texts(file, scale, "name", &name));
    if (strlen(name) == 1) strcat(strcat(text, name), ":");
    memory_free(&name);
  }
cleanup:
  return status;
}

/* Takes where voxels are along an axis, by the array of places after which the axis is named, as in
 * netCDF and NXdata: at even distances, or no image. */
static enum status take_places(struct h5_file *file, const char *places, size_t count, int axis,
                               struct image *image) {
  enum status status = STATUS_OK;
  double *at = NULL;
  char *unit = NULL;
  size_t found;
  int rank;
  if (count < 3 || !h5_exists(file, places)) return STATUS_OK;
  if (h5_shape(file, places, 1, &rank, &found) != STATUS_OK || rank != 1 || found != count ||
      h5_read(file, places, H5_F64, 1, &found, &at) != STATUS_OK) {
    error_clear();
    goto cleanup;
  }
  const double step = (at[count - 1] - at[0]) / (double)(count - 1);
  for (size_t i = 1; i < count; i++)
    if (!(fabs(at[i] - at[i - 1] - step) <= STEPS_ALIKE * fabs(step)) || step == 0.0)
      TRY_FAIL(STATUS_INPUT,
               "%s: its voxels along %c are at uneven distances, as %s tells (%g after %g); "
               "resample them",
               h5_path(file), 'x' + axis, places, at[i], at[i - 1]);
  if (step < 0.0)
    image_note(image, "%s falls: read as stored, mirrored along %c", places, 'x' + axis);
  if (h5_attribute_exists(file, places, "units") &&
      h5_read_attribute_text(file, places, "units", &unit) != STATUS_OK)
    error_clear();
  if (unit != NULL) image->voxel[axis] = fabs(step) * length_unit(unit);
  if (isfinite(image->voxel[axis])) image->voxel_source = "places of the voxels in HDF5";
cleanup:
  memory_free(&at);
  memory_free(&unit);
  return status;
}

/* The arrays of places of the axes, slowest first: `text` has their names. */
static enum status take_axes(struct h5_file *file, const char *group, const char *text,
                             struct image *image) {
  enum status status = STATUS_OK;
  const size_t sizes[3] = {image->size[0], image->size[1], image->pages};
  char places[240];
  for (int axis = 2; axis >= 0 && *text != '\0'; axis--) {
    const size_t n = strcspn(text, ":");
    snprintf(places, sizeof places, "%s%s%.*s", text[0] == '/' ? "" : group,
             text[0] == '/' || strcmp(group, "/") == 0 ? "" : "/", (int)n, text);
    TRY(take_places(file, places, sizes[axis], axis, image));
    text += n + (text[n] == ':');
  }
cleanup:
  return status;
}

/* MINC scales each slice by values beside it: image-min and image-max. */
static enum status check_minc(struct h5_file *file, const char *group, struct image *image) {
  enum status status = STATUS_OK;
  static const char *const NAMES[] = {"image-min", "image-max"};
  char beside[240];
  double *values = NULL;
  for (int i = 0; i < 2; i++) {
    size_t count = 0;
    int rank = 0;
    snprintf(beside, sizeof beside, "%.200s/%s", group, NAMES[i]);
    if (!h5_exists(file, beside)) continue;
    if (i == 0) image_note(image, "greys as stored, before image-min and image-max beside it");
    TRY(h5_shape(file, beside, 1, &rank, &count));
    if (rank != 1) continue;
    TRY(h5_read(file, beside, H5_F64, 1, &count, &values));
    for (size_t z = 1; z < count; z++)
      if (values[z] != values[0])
        TRY_FAIL(STATUS_INPUT,
                 "%s: its slices are scaled each in its own way (%s): the same number means other "
                 "densities; export them with one scale",
                 h5_path(file), beside);
    memory_free(&values);
  }
cleanup:
  memory_free(&values);
  return status;
}

/* Tells where the axes are named, slowest first, in another order than z, y, x: by attributes of
 * the array or of its group (those of NeXus, the keys of vigra's tags, HDF5's labels and its
 * scales, which are the dimensions of netCDF), or by the scales of EMD. */
static enum status tell_axes(struct h5_file *file, const char *name, const char *group,
                             struct image *image) {
  enum status status = STATUS_OK;
  static const char *const NAMES[] = {"axes", "axistags", "DIMENSION_LABELS", "DIMENSION_LIST"};
  char order[4], scales[16];
  for (int i = 0; i < 6; i++) {
    const char *of = i < 4 ? name : group, *attribute = NAMES[i % 4];
    char *text = NULL;
    if (!h5_attribute_exists(file, of, attribute)) continue;
    if (h5_read_attribute_texts(file, of, attribute, &text) != STATUS_OK) error_clear();
    if (text != NULL && image_names_other_order(text, false, order))
      image_note(image, "its axes are %s by its attribute %s: read as stored, as z, y, x", order,
                 attribute);
    else if (text != NULL)
      status = take_axes(file, group, text, image);
    memory_free(&text);
    if (status != STATUS_OK) goto cleanup;
  }
  if (names_of_scales(file, group, scales) != STATUS_OK) error_clear();
  if (image_names_other_order(scales, false, order))
    image_note(image, "its axes are %s by dim1, dim2 ... beside it: read as stored, as z, y, x",
               order);
cleanup:
  return status;
}

/* Tells of attributes by which other programs take the numbers for other greys (CF conventions,
 * 8.1; HDF5 Image), and of those of Imaris that say which part of an array is the scan. */
static enum status tell_attributes(struct h5_file *file, const char *name, struct image *image) {
  enum status status = STATUS_OK;
  static const struct {
    const char *name;
    double idle; /* a value that changes nothing */
  } CHANGING[] = {
      {"scale_factor", 1.0}, {"add_offset", 0.0}, {"IMAGE_WHITE_IS_ZERO", 0.0}, {"PALETTE", 0.0}};
  for (size_t i = 0; i < sizeof CHANGING / sizeof *CHANGING; i++) {
    if (!h5_attribute_exists(file, name, CHANGING[i].name)) continue;
    const double value = h5_attribute_or_nan(file, name, CHANGING[i].name);
    if (value != CHANGING[i].idle)
      image_note(image, "greys as stored, not as its attribute %s says", CHANGING[i].name);
    if (i < 2) image->rescale[i] = value;
  }
  if (h5_attribute_exists(file, name, "DISPLAY_ORIGIN")) { /* HDF5 Image: "UL" is ours */
    char *origin = NULL;
    if (h5_read_attribute_text(file, name, "DISPLAY_ORIGIN", &origin) != STATUS_OK) error_clear();
    if (origin != NULL && strcmp(origin, "UL") != 0)
      image_note(image, "it is mirrored or turned by its attribute DISPLAY_ORIGIN: read as stored");
    memory_free(&origin);
  }
  if (h5_attribute_exists(file, name, "MATLAB_class"))
    image_note(image, "of MATLAB, whose first index is x here: rows and columns are exchanged");
  char group[200], scale[240];
  const int length = (int)(strrchr(name, '/') - name);
  snprintf(group, sizeof group, "%.*s", length, name);
  TRY(tell_axes(file, name, length > 0 ? group : "/", image));
  TRY(check_minc(file, group, image));
  snprintf(scale, sizeof scale, "%s/Spacing", group);
  if (h5_exists(file, scale)) image_note(image, "%s has no unit; --voxel-size decides", scale);
  double edges[3]; /* z, y, x, of ilastik and others */
  if (h5_attribute_exists(file, name, "element_size_um")) {
    if (h5_read_attribute(file, name, "element_size_um", H5_F64, 3, edges) == STATUS_OK) {
      for (int axis = 0; axis < 3; axis++) image->voxel[axis] = 1e-6 * edges[2 - axis];
      image->voxel_source = "HDF5 element_size_um";
    } else {
      error_clear();
    }
  }
  static const char *const BESIDE[] = {"_scaling_factor", "_offset"}; /* of NXdata */
  for (int i = 0; i < 2; i++) {
    snprintf(scale, sizeof scale, "%s%s", name, BESIDE[i]);
    if (strlen(scale) + 1 < sizeof scale && h5_exists(file, scale))
      image_note(image, "greys as stored, before %s", scale);
  }
  if (length > 0 && h5_attribute_exists(file, group, "ImageSizeX"))
    image_note(image,
               "beyond ImageSizeX, Y and Z of %s it is filled up, no scan: leave that out "
               "by --crop",
               group);
cleanup:
  return status;
}

static enum status hdf5_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  const char *name = dataset_name(path);
  const char *of_file = image->data_file_count > 0 ? image->data_files[0] : path;
  struct image_dataset *dataset = NULL;
  size_t dims[AXES_MOST], turned[AXES_MOST], page;
  int axis[3];
  int bits;
  char format;
  TRY(memory_allocate(&dataset, 1, sizeof *dataset, "a dataset"));
  image->dataset = dataset;
  TRY(h5_open(of_file, &dataset->file));
  char list[200];
  if (name == NULL) {
    TRY(find_dataset(dataset->file, image, &dataset->name));
  } else {
    TRY(memory_allocate(&dataset->name, strlen(name) + 2, 1, "a name"));
    sprintf(dataset->name, "%s%s", name[0] == '/' ? "" : "/", name);
  }
  name = dataset->name;
  if (!h5_exists(dataset->file, name)) {
    list_group(dataset->file, "/", list);
    TRY_FAIL(STATUS_INPUT,
             "%s: has no dataset %s; it has%s (a link into another file, or to nothing, is none)",
             of_file, name, list[0] != '\0' ? list : " none");
  }
  list_group(dataset->file, name, list);
  if (list[0] != '\0')
    TRY_FAIL(STATUS_INPUT, "%s: %s is a group; name a dataset in it (it has%s)", of_file, name,
             list);
  TRY(h5_shape(dataset->file, name, AXES_MOST, &dataset->rank, dims));
  for (int a = 0; a < dataset->rank; a++) turned[a] = dims[dataset->rank - 1 - a];
  if (!image_choose_axes(turned, dataset->rank, axis))
    TRY_FAIL(STATUS_INPUT, "%s: %s has %d axes; an image has 2 or 3, [z][y][x] (and others of one)",
             of_file, name, dataset->rank);
  TRY(h5_number_format(dataset->file, name, &bits, &format));
  const bool other = bits <= 32 && sign_is_other(dataset->file, name, format);
  const char meant = !other ? format : format == 'i' ? 'u' : 'i';
  choose_types(bits, format, meant, &image->type, &dataset->type);
  image->size[0] = turned[axis[0]];
  image->size[1] = turned[axis[1]];
  image->pages = axis[2] < 0 ? 1 : turned[axis[2]];
  dataset->z_axis = axis[2] < 0 ? -1 : dataset->rank - 1 - axis[2];
  read_no_data(dataset->file, name, bits, meant, other, image);
  TRY(check_slices(dataset->file, name, image->pages));
  TRY(tell_attributes(dataset->file, name, image));
  if (h5_is_partial(dataset->file, name))
    image_note(image, "%s was not written to its end: the rest is filled in", name);
  if (image->size[0] == 0 || image->size[1] == 0 || image->pages == 0 ||
      !size_multiply(image->size[0], image->size[1], &page) || page > ((size_t)1 << 32))
    TRY_FAIL(STATUS_INPUT, "%s: %s is %zux%zux%zu, which is no image", of_file, name,
             image->size[0], image->size[1], image->pages);
  const double fit = BLOCK_BYTES / ((double)page * (double)h5_type_size(dataset->type));
  dataset->most = fit < 1.0 ? 1 : fit > BLOCK_MOST ? BLOCK_MOST : (size_t)fit;
  image->plain = true;
cleanup:
  return status; /* image_close frees the rest */
}

static enum status read_block(const struct image *image, struct image_dataset *dataset,
                              size_t page) {
  size_t dims[AXES_MOST];
  const size_t left = image->pages - page, count = left < dataset->most ? left : dataset->most;
  memory_free(&dataset->block);
  dataset->count = 0;
  enum status status =
      dataset->z_axis < 0 ? h5_read(dataset->file, dataset->name, dataset->type, dataset->rank,
                                    dims, &dataset->block)
                          : h5_read_slab(dataset->file, dataset->name, dataset->type, dataset->rank,
                                         dataset->z_axis, page, count, &dataset->block);
  if (status != STATUS_OK) return status;
  dataset->first = page;
  dataset->count = dataset->z_axis < 0 ? 1 : count;
  return STATUS_OK;
}

static enum status hdf5_read(const struct image *image, size_t page, void *out) {
  enum status status = STATUS_OK;
  struct image_dataset *dataset = image->dataset;
  const size_t n = image->size[0] * image->size[1];
  pthread_mutex_lock(&one_thread);
  if (page < dataset->first || page >= dataset->first + dataset->count)
    status = read_block(image, dataset, page);
  if (status == STATUS_OK)
    narrow(dataset->block + (page - dataset->first) * n * h5_type_size(dataset->type), n,
           image->type, dataset->type, out);
  pthread_mutex_unlock(&one_thread);
  return status;
}

static void hdf5_close(struct image *image) {
  struct image_dataset *dataset = image->dataset;
  if (dataset == NULL) return;
  h5_close(dataset->file);
  memory_free(&dataset->name);
  memory_free(&dataset->block);
  memory_free(&image->dataset);
}

const struct image_reader image_hdf5_reader = {.name = "HDF5",
                                               .claims = hdf5_claims,
                                               .open = hdf5_open,
                                               .read = hdf5_read,
                                               .close = hdf5_close};
