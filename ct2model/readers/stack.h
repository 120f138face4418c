/* A stack of slices from whatever files a user names, in natural order. */
#ifndef TOSUI_CT2MODEL_READERS_STACK_H
#define TOSUI_CT2MODEL_READERS_STACK_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "ct2model/readers/image.h"

struct stack {
  size_t size[3]; /* x, y, z */
  enum pixel_type type;
  bool has_levels; /* every slice has levels (image_has_levels), so that stack_read_stored may be
                      called */
  double voxel[3]; /* m; NAN if no file tells */
  const char *voxel_source;
  size_t file_count;
  struct image *files;
  size_t *first_slice; /* first slice of each file; file_count + 1 values */
  bool ordered;        /* slices stand in the order that they tell, not in that of their names */
  long long stride;    /* difference of the numbers in successive file names; 0: none, or not
                          uniform */
};

/* Opens files and folders (whose images are taken in natural order), reads all headers, checks that
 * all slices agree and warns of gaps in the numbering. Free with stack_close. */
enum status stack_open(const char *const *paths, size_t count, const struct raw_layout *raw,
                       struct stack *stack);
void stack_close(struct stack *stack);
/* Reads slice z into out[size[1]][size[0]]; may be called from several threads. */
enum status stack_read(const struct stack *stack, size_t z, float *out);
/* For a stack with levels: reads slice z as values of `type` in native byte order. */
enum status stack_read_stored(const struct stack *stack, size_t z, void *out);
/* The field by which the file of slice z says that some of its values are no measurement; NULL if
 * it has none. */
const char *stack_no_data(const struct stack *stack, size_t z);
/* Warns if the files contradict the voxel size `given` (m; x, y, z; NAN: not given), and if their
 * numbers come in steps of more than two while no distance of slices was given. */
void stack_compare_voxel(const struct stack *stack, const double given[3], bool has_slice_distance);
/* Inverts files that declare "white is zero", unless slice `z` holds the two labels of a segmented
 * image: labels are not brightness and are used as stored. */
enum status stack_keep_labels(struct stack *stack, size_t z);
/* The name of slice z for messages: "slice_0123.tif" or "stack.tif[12]"; truncated to `size`. */
void stack_slice_name(const struct stack *stack, size_t z, char *name, size_t size);

#endif
