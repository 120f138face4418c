#define _GNU_SOURCE /* qsort_r */ // NOLINT: the name is the library's
#include "ct2model/readers/stack.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/units.h"
#include "ct2model/readers/byte_order.h"
#include "ct2model/readers/dataset_name.h"
#include "ct2model/readers/slice_names.h"

/* Largest number of voxels along an axis: more are a mistyped size. */
#define VOXELS_PER_AXIS_MOST (1 << 20)
/* Fraction to which distances of slices, and the components of their directions, are alike. */
#define ALIKE 0.1

struct name_list {
  char **names;
  size_t count, room;
};

static void names_free(struct name_list *list) {
  for (size_t i = 0; i < list->count; i++) memory_free(&list->names[i]);
  memory_free(&list->names);
}

static enum status names_add(struct name_list *list, const char *folder, const char *name) {
  if (list->count == list->room) {
    size_t room = list->room == 0 ? 64 : 2 * list->room;
    enum status status = memory_resize(&list->names, room, sizeof *list->names, "file names");
    if (status != STATUS_OK) return status;
    list->room = room;
  }
  size_t size = strlen(folder) + strlen(name) + 2;
  char *path;
  enum status status = memory_allocate(&path, size, 1, "a file name");
  if (status != STATUS_OK) return status;
  bool plain = folder[0] == '\0' || folder[strlen(folder) - 1] == '/';
  snprintf(path, size, "%s%s%s", folder, plain ? "" : "/", name);
  list->names[list->count++] = path;
  return STATUS_OK;
}

static int by_name(const void *a, const void *b, void *order) {
  return name_compare(*(char *const *)a, *(char *const *)b, order);
}

static void sort_names(char **names, size_t count) {
  struct name_order order = name_order_find(names, count);
  qsort_r(names, count, sizeof *names, by_name, &order);
}

/* Lists the images of a folder. Files of other kinds are left out, and counted for a message. A
 * header with its pixels beside it (x.mhd, x.raw) is one image. */
static enum status list_folder(const char *folder, bool raw, struct name_list *list) {
  enum status status = STATUS_OK;
  size_t before = list->count, ignored = 0;
  DIR *handle = opendir(folder);
  if (handle == NULL) TRY_FAIL(STATUS_INPUT, "%s: %s", folder, strerror(errno));
  for (struct dirent *entry; (entry = readdir(handle)) != NULL;) {
    if (entry->d_name[0] == '.') continue;
    if (entry->d_type == DT_DIR) {
      log_warning(
          "%s/%s: a folder within the folder, not looked into: name both if it holds slices",
          folder, entry->d_name);
      continue;
    }
    if (raw || image_name_known(entry->d_name))
      TRY(names_add(list, folder, entry->d_name));
    else
      ignored++;
  }
  if (list->count == before)
    TRY_FAIL(STATUS_INPUT,
             "%s: no .tif, .png, .bmp, .dcm, .mhd, .nrrd, .vti or .npy files in this folder; name "
             "files with other endings or none, as of DICOM, by FOLDER/*; for headerless ones give "
             "--raw",
             folder);
  if (ignored > 0) log_verbose("%s: %zu other files left out", folder, ignored);
  sort_names(list->names + before, list->count - before);
cleanup:
  if (handle != NULL) closedir(handle);
  return status;
}

static enum status list_files(const char *const *paths, size_t count, bool raw,
                              struct name_list *list) {
  enum status status = STATUS_OK;
  for (size_t i = 0; i < count; i++) {
    struct stat info;
    if (dataset_name(paths[i]) != NULL) {
      TRY(names_add(list, "", paths[i]));
      continue;
    }
    if (stat(paths[i], &info) != 0)
      TRY_FAIL(STATUS_INPUT, "%s: %s%s", paths[i], strerror(errno),
               strpbrk(paths[i], "*?[") != NULL
                   ? "; the shell puts names in the place of * and ?: write them without quotes"
                   : "");
    if (S_ISDIR(info.st_mode))
      TRY(list_folder(paths[i], raw, list));
    else
      TRY(names_add(list, "", paths[i]));
  }
  /* A shell lists slice_10 before slice_9. */
  if (count > 1) sort_names(list->names, list->count);
  for (size_t i = 1; i < list->count; i++) {
    if (strcmp(list->names[i - 1], list->names[i]) == 0)
      TRY_FAIL(STATUS_INPUT, "%s: given twice; name it once", list->names[i]);
  }
cleanup:
  return status;
}

/* The voxel size of the first slice is used; a slice that disagrees is reported. */
static void warn_of_other_voxels(const struct stack *stack) {
  const struct image *first = &stack->files[0];
  for (size_t i = 1; i < stack->file_count; i++) {
    const struct image *image = &stack->files[i];
    for (int a = 0; a < 3; a++) {
      if (!(fabs(image->voxel[a] / first->voxel[a] - 1.0) > 0.01)) continue;
      log_warning(
          "%s: its %s say %.4g um along %c, those of %s %.4g um; the first slice's is taken",
          image->path, image->voxel_source, image->voxel[a] * 1e6, 'x' + a, base_name(first->path),
          first->voxel[a] * 1e6);
      return;
    }
  }
}

/* Warns of slices that lie beside each other, as their files place them in a larger picture. */
static void warn_of_places(const struct stack *stack) {
  const struct image *first = &stack->files[0];
  for (size_t i = 1; i < stack->file_count && !stack->ordered; i++) {
    const struct image *image = &stack->files[i];
    if (!(fabs(image->at[0] - first->at[0]) + fabs(image->at[1] - first->at[1]) > 0.0)) continue;
    log_warning(
        "%s: its file puts it %g, %g aside of %s (oFFs, XPosition): read one above the other",
        image->path, image->at[0] - first->at[0], image->at[1] - first->at[1],
        base_name(first->path));
    return;
  }
}

/* Skips a number, with its sign and point if it has them. */
static const char *after_number(const char *at) {
  if ((*at == '-' || *at == '+') && isdigit((unsigned char)at[1])) at++;
  while (isdigit((unsigned char)*at) || (*at == '.' && isdigit((unsigned char)at[1]))) at++;
  return at;
}

/* Whether two names differ only in their numbers. */
static bool is_named_alike(const char *a, const char *b) {
  for (a = base_name(a), b = base_name(b);; a++, b++) {
    a = after_number(a);
    b = after_number(b);
    if (*a != *b) return false;
    if (*a == '\0') return true;
  }
}

/* Warns of masks, a preview or another scan among the slices: all files whose names differ from
 * those of the majority. False if there is none, or if nearly all names differ. The majority is
 * found by the vote of Boyer and Moore (MJRTY, 1981), in one pass. */
static bool warn_of_other_names(const struct name_list *list) {
  const char *majority = NULL, *other = NULL;
  size_t votes = 0, owns = 0;
  for (size_t i = 0; i < list->count; i++) {
    if (votes == 0) majority = list->names[i];
    votes = is_named_alike(list->names[i], majority) ? votes + 1 : votes - 1;
  }
  for (size_t i = 0; i < list->count; i++) {
    const char *name = list->names[i];
    if (is_named_alike(name, majority))
      majority = owns++ == 0 ? name : majority;
    else if (other == NULL)
      other = name;
  }
  if (other == NULL || 2 * owns < list->count) return false;
  log_warning(
      "%zu of %zu files, such as %s, are not named as %s: if they are masks or of another scan, "
      "name the slices alone, with a * for their numbers",
      list->count - owns, list->count, base_name(other), base_name(majority));
  return true;
}

/* Warns of a name that no number puts in order among others. */
static void warn_of_letters(const struct name_list *list) {
  for (size_t i = 0; i < list->count && list->count > 1; i++) {
    const char *name = base_name(list->names[i]);
    if (strpbrk(name, "0123456789") != NULL) continue;
    log_warning("%s: no number (0 to 9) puts it in order among the others: it is taken in that of "
                "letters",
                name);
    return;
  }
}

/* Warns of axes that are as short as those of colours, channels or times, which nobody named. */
static void warn_of_channels(const struct stack *stack) {
  enum { CHANNELS_MOST = 4 };
  const struct image *first = &stack->files[0];
  if (first->pages > 1 && first->size[0] > 1 && first->size[0] <= CHANNELS_MOST)
    log_warning("%s: only %zu voxels along x, as many as an image has colours or channels: are "
                "they such? save the greys alone",
                first->path, first->size[0]);
  if (first->pages > 1 && first->pages <= CHANNELS_MOST && stack->file_count > first->pages)
    log_warning("%s: each of the %zu files holds %zu slices, which are taken one behind the other: "
                "if they are channels, masks or times, save the greys alone",
                first->path, stack->file_count, first->pages);
}

/* Warns of gaps in the numbering. A uniform stride is no gap, as some scanners number every second
 * slice; it is returned where numbers are whole, otherwise 0. */
static long long warn_of_gaps(const struct name_list *list) {
  const struct name_order order = name_order_find(list->names, list->count);
  long long stride = 0, a, b;
  if (list->count < 3) return 0;
  for (size_t i = 1; i < list->count; i++) {
    if (!name_number(list->names[i - 1], &order, &a) || !name_number(list->names[i], &order, &b))
      return 0;
    if (b > a && (stride == 0 || b - a < stride)) stride = b - a;
  }
  size_t gaps = 0;
  for (size_t i = 1; i < list->count; i++) {
    (void)name_number(list->names[i - 1], &order, &a);
    (void)name_number(list->names[i], &order, &b);
    if (b - a == stride) continue;
    if (gaps++ > 4) continue;
    if (b == a)
      log_warning("%s and %s carry the same number; both are used", base_name(list->names[i - 1]),
                  base_name(list->names[i]));
    else
      log_warning("the numbering jumps from %s to %s: slices missing?",
                  base_name(list->names[i - 1]), base_name(list->names[i]));
  }
  if (gaps > 5) log_warning("%zu jumps in the numbering in all", gaps);
  return gaps == 0 && !order.fractions ? stride : 0;
}

static void look_for_levels(struct stack *stack) {
  stack->has_levels = true;
  for (size_t i = 0; i < stack->file_count; i++)
    stack->has_levels &= image_has_levels(&stack->files[i]);
}

static enum status check_agreement(const struct image *first, const struct image *image) {
  if (image->reader != first->reader)
    return FAIL(STATUS_INPUT, "%s: %s, but the first slice is %s; name one kind, e.g. FOLDER/*.tif",
                image->path, image->reader->name, first->reader->name);
  if (image->size[0] != first->size[0] || image->size[1] != first->size[1])
    return FAIL(STATUS_INPUT,
                "%s: %zux%zu, but the first slice is %zux%zu; leave it out or crop all alike",
                image->path, image->size[0], image->size[1], first->size[0], first->size[1]);
  if (image->type != first->type)
    return FAIL(STATUS_INPUT, "%s: %s, but the first slice is %s; save all as one type",
                image->path, pixel_name(image->type), pixel_name(first->type));
  if (image->top != first->top)
    return FAIL(STATUS_INPUT,
                "%s: greys of 0 to %d, but the first slice has 0 to %d; save all as "
                "one type",
                image->path, image->top > 0 ? image->top : 255, first->top > 0 ? first->top : 255);
  if (image->rescale[0] != first->rescale[0] || image->rescale[1] != first->rescale[1])
    return FAIL(STATUS_INPUT,
                "%s: its greys are to be scaled by %g and %g, those of the first slice by %g "
                "and %g: the same number means other densities; export all alike",
                image->path, image->rescale[0], image->rescale[1], first->rescale[0],
                first->rescale[1]);
  if (!image_palettes_agree(first, image))
    return FAIL(STATUS_INPUT,
                "%s: its palette is not that of the first slice, so that its numbers "
                "mean other colours; save all with one palette",
                image->path);
  for (int i = 0; i < 6; i++)
    if (fabs(image->axes[i] - first->axes[i]) > ALIKE)
      return FAIL(STATUS_INPUT,
                  "%s: a slice in another direction than %s (ImageOrientation): a localizer? leave "
                  "it out",
                  image->path, first->path);
  if (image->orientation != first->orientation)
    return FAIL(STATUS_INPUT,
                "%s: orientation %u, but the first slice has %u; save all in one orientation",
                image->path, image->orientation, first->orientation);
  return STATUS_OK;
}

static int by_place(const void *a, const void *b) {
  const double x = ((const struct image *)a)->at[2], y = ((const struct image *)b)->at[2];
  return x < y ? -1 : x > y;
}

static int by_number(const void *a, const void *b) {
  const double x = ((const struct image *)a)->number, y = ((const struct image *)b)->number;
  return x < y ? -1 : x > y;
}

/* Slices one behind the other; those of a tilted gantry are shifted sideways, each more than the
 * one before, and in the stack the body is sheared. */
static enum status check_upright(const struct image *files, size_t n, double step) {
  for (size_t i = 1; i < n; i++) {
    const double aside = hypot(files[i].at[0] - files[0].at[0], files[i].at[1] - files[0].at[1]);
    if (aside > 0.5 * (files[0].voxel[0] > 0.0 ? files[0].voxel[0] : step))
      return FAIL(STATUS_INPUT,
                  "%s: its first pixel does not lie behind that of %s, but %g mm aside" SHEARED,
                  files[i].path, base_name(files[0].path), 1e3 * aside);
  }
  return STATUS_OK;
}

/* Puts slices that tell where they are in that order; their distance is that of the slices. */
static enum status order_by_place(struct stack *stack) {
  enum status status = STATUS_OK;
  struct image *files = stack->files;
  const size_t n = stack->file_count;
  qsort(files, n, sizeof *files, by_place);
  const double step = (files[n - 1].at[2] - files[0].at[2]) / (double)(n - 1);
  for (size_t i = 1; i < n; i++)
    if (!(files[i].at[2] - files[i - 1].at[2] > 0.01 * step))
      TRY_FAIL(STATUS_INPUT, "%s and %s are at the same place, %g mm; give one series",
               files[i - 1].path, base_name(files[i].path), 1e3 * files[i].at[2]);
  for (size_t i = 1; i < n; i++) {
    const double here = files[i].at[2] - files[i - 1].at[2];
    if (fabs(here - step) > ALIKE * step)
      TRY_FAIL(STATUS_INPUT,
               "%s is %g mm behind %s, but slices are %g mm apart in the mean: are some missing?",
               files[i].path, 1e3 * here, base_name(files[i - 1].path), 1e3 * step);
  }
  TRY(check_upright(files, n, step));
  if (fabs(files[0].voxel[2] / step - 1.0) > ALIKE)
    log_warning("%s says %g mm from slice to slice, but their positions are %g mm apart: these are "
                "taken",
                files[0].path, 1e3 * files[0].voxel[2], 1e3 * step);
  for (size_t i = 0; i < n; i++) {
    files[i].voxel[2] = step;
    if (files[i].voxel_source == NULL) files[i].voxel_source = "positions of the slices";
  }
cleanup:
  return status;
}

/* Puts slices that tell their number in its order. */
static enum status order_by_number(struct stack *stack) {
  struct image *files = stack->files;
  const size_t n = stack->file_count;
  qsort(files, n, sizeof *files, by_number);
  for (size_t i = 1; i < n; i++)
    if (files[i].number == files[i - 1].number)
      return FAIL(STATUS_INPUT, "%s and %s are both slice %g of their series; give one series",
                  files[i - 1].path, base_name(files[i].path), files[i].number);
  const double step = (files[n - 1].number - files[0].number) / (double)(n - 1);
  for (size_t i = 1; i < n; i++)
    if (files[i].number - files[i - 1].number != step) {
      log_warning("the numbers of the slices jump from %g (%s) to %g: slices missing?",
                  files[i - 1].number, base_name(files[i - 1].path), files[i].number);
      break;
    }
  return STATUS_OK;
}

/* Slices of DICOM stand in the order that they tell, whatever their names. */
static enum status order_slices(struct stack *stack) {
  const size_t n = stack->file_count;
  size_t placed = 0, numbered = 0;
  for (size_t i = 0; i < n; i++) {
    const struct image *image = &stack->files[i];
    placed += isfinite(image->at[2]) && image->pages == 1;
    numbered += isfinite(image->number) && image->pages == 1;
  }
  for (size_t i = 1; i < n; i++)
    if (strcmp(stack->files[i].series, stack->files[0].series) != 0) {
      log_warning("%s is of another series than %s: if they are of two scans, give one",
                  stack->files[i].path, base_name(stack->files[0].path));
      break;
    }
  stack->ordered = n > 1 && (placed == n || numbered == n);
  if (n > 1 && !stack->ordered && placed + numbered > 0)
    log_warning("not all of the slices tell their place or their number: they are taken in the "
                "order of their names");
  return !stack->ordered ? STATUS_OK : placed == n ? order_by_place(stack) : order_by_number(stack);
}

static enum status open_files(const struct name_list *list, const struct raw_layout *raw,
                              struct stack *stack) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(&stack->files, list->count, sizeof *stack->files, "the list of slices"));
  TRY(memory_allocate(&stack->first_slice, list->count + 1, sizeof *stack->first_slice,
                      "the list of slices"));
  size_t noted = 0;
  for (size_t i = 0; i < list->count; i++) {
    struct image *image = &stack->files[i];
    TRY(image_open(list->names[i], raw, image));
    stack->file_count = i + 1;
    TRY(check_agreement(&stack->files[0], image));
    stack->first_slice[i + 1] = stack->first_slice[i] + image->pages;
    if (image->note[0] != '\0' && noted++ == 0)
      log_warning("%s: %s%s", image->path, image->note,
                  list->count > 1 ? " (and perhaps others)" : "");
  }
  TRY(order_slices(stack));
  const struct image *first = &stack->files[0];
  stack->size[0] = first->size[0];
  stack->size[1] = first->size[1];
  stack->size[2] = stack->first_slice[list->count];
  for (int a = 0; a < 3; a++)
    if (stack->size[a] > VOXELS_PER_AXIS_MOST)
      TRY_FAIL(STATUS_INPUT, "%s: %zu voxels along %c: up to %d are read; is the size right?",
               first->path, stack->size[a], 'x' + a, VOXELS_PER_AXIS_MOST);
  stack->type = first->type;
  memcpy(stack->voxel, first->voxel, sizeof stack->voxel);
  stack->voxel_source = first->voxel_source;
  look_for_levels(stack);
  if (raw != NULL && raw->given && stack->size[2] != raw->size[2])
    TRY_FAIL(STATUS_INPUT, "%s: %zu slices of %zux%zu, but --raw says %zu; correct it", first->path,
             stack->size[2], raw->size[0], raw->size[1], raw->size[2]);
  if (raw != NULL && raw->given) TRY(byte_order_check(&stack->files[list->count / 2]));
cleanup:
  return status;
}

enum status stack_open(const char *const *paths, size_t count, const struct raw_layout *raw,
                       struct stack *stack) {
  enum status status = STATUS_OK;
  struct name_list list = {0};
  memset(stack, 0, sizeof *stack);
  TRY(list_files(paths, count, raw != NULL && raw->given, &list));
  TRY(open_files(&list, raw, stack));
  if (!stack->ordered && !warn_of_other_names(&list)) stack->stride = warn_of_gaps(&list);
  if (!stack->ordered) warn_of_letters(&list);
  warn_of_channels(stack);
  warn_of_other_voxels(stack);
  warn_of_places(stack);
cleanup:
  names_free(&list);
  if (status != STATUS_OK) stack_close(stack);
  return status;
}

void stack_compare_voxel(const struct stack *stack, const double given[3],
                         bool has_slice_distance) {
  char text[2][40];
  /* Slices that were left out are farther apart than pixels. */
  if (stack->stride > 2 && !has_slice_distance)
    log_warning("the slices are numbered in steps of %lld (%s, %s, ...): where those between were "
                "left out, give their distance too, as --voxel-size 5um,5um,10um",
                stack->stride, base_name(stack->files[0].path), base_name(stack->files[1].path));
  static const char *const NAMES[] = {"pixel", "pixel", "slice"};
  for (int d = 0; d < 3; d += 2) {
    if (!(fabs(stack->voxel[d] / given[d] - 1.0) > 0.01)) continue;
    quantity_format(stack->voxel[d], "m", text[0], sizeof text[0]);
    quantity_format(given[d], "m", text[1], sizeof text[1]);
    log_warning("the %s say %s from %s to %s; --voxel-size %s is used", stack->voxel_source,
                text[0], NAMES[d], NAMES[d], text[1]);
    return;
  }
}

void stack_close(struct stack *stack) {
  for (size_t i = 0; i < stack->file_count; i++) image_close(&stack->files[i]);
  memory_free(&stack->files);
  memory_free(&stack->first_slice);
  stack->file_count = 0;
}

static size_t file_of_slice(const struct stack *stack, size_t z) {
  size_t low = 0, high = stack->file_count;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (stack->first_slice[middle] <= z)
      low = middle;
    else
      high = middle;
  }
  return low;
}

enum status stack_read(const struct stack *stack, size_t z, float *out) {
  size_t file = file_of_slice(stack, z);
  return image_read(&stack->files[file], z - stack->first_slice[file], out);
}

const char *stack_no_data(const struct stack *stack, size_t z) {
  const struct image *image = &stack->files[file_of_slice(stack, z)];
  return image->no_data_count > 0 ? image->no_data[0].name : NULL;
}

enum status stack_read_stored(const struct stack *stack, size_t z, void *out) {
  size_t file = file_of_slice(stack, z);
  return image_read_stored(&stack->files[file], z - stack->first_slice[file], out);
}

enum status stack_keep_labels(struct stack *stack, size_t z) {
  enum status status = STATUS_OK;
  size_t pixels = stack->size[0] * stack->size[1], others = 0;
  float *slice = NULL;
  if (!stack->files[0].invert) return STATUS_OK;
  TRY(memory_allocate(&slice, pixels, sizeof *slice, "a slice"));
  TRY(stack_read(stack, z, slice));
  float low = slice[0], high = slice[0];
  for (size_t i = 0; i < pixels; i++) {
    low = fminf(low, slice[i]);
    high = fmaxf(high, slice[i]);
  }
  for (size_t i = 0; i < pixels; i++) others += slice[i] != low && slice[i] != high;
  if (others > 0) {
    log_info("%s says white is zero: its greys are read with white and black exchanged",
             stack->files[0].path);
    goto cleanup;
  }
  log_warning("%s says white is zero, but holds labels: they are used as stored, the higher one "
              "is bright",
              stack->files[0].path);
  for (size_t i = 0; i < stack->file_count; i++) stack->files[i].invert = false;
  look_for_levels(stack);
cleanup:
  memory_free(&slice);
  return status;
}

void stack_slice_name(const struct stack *stack, size_t z, char *name, size_t size) {
  size_t file = file_of_slice(stack, z);
  const char *base = base_name(stack->files[file].path);
  if (stack->files[file].pages == 1)
    snprintf(name, size, "%s", base);
  else
    snprintf(name, size, "%s[%zu]", base, z - stack->first_slice[file]);
}
