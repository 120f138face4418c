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
  bool has_levels; /* every slice has (image_has_levels): stack_read_stored may be called */
  double voxel[3]; /* m; NAN where no file says */
  const char *voxel_source;
  size_t file_count;
  struct image *files;
  size_t *first_slice; /* of each file; file_count + 1 values */
  long long stride;    /* between the numbers of the files' names; 0: none, or not the same */
};

/* Opens files and folders (their images in natural order), reads all headers, checks that all
 * slices agree and warns of gaps in the numbering. Free with stack_close. */
enum status stack_open(const char *const *paths, size_t count, const struct raw_layout *raw,
                       struct stack *stack);
void stack_close(struct stack *stack);
/* Slice z into out[size[1]][size[0]]; may be called from several threads. */
enum status stack_read(const struct stack *stack, size_t z, float *out);
/* Of a stack that has levels: slice z as `type`, native byte order. */
enum status stack_read_stored(const struct stack *stack, size_t z, void *out);
/* Warns if the files say that a voxel is not as large as `given` (m; x, y, z; NAN: nothing is
 * given), and if their numbers come in steps of more than two while nobody gave a distance of
 * slices for itself. */
void stack_compare_voxel(const struct stack *stack, const double given[3], bool has_slice_distance);
/* Files that say "white is zero" are inverted, unless slice `z` holds the two labels of a segmented
 * image: labels are no brightness and count as stored. */
enum status stack_keep_labels(struct stack *stack, size_t z);
/* The name for messages: "slice_0123.tif" or "stack.tif[12]"; truncated to `size`. */
void stack_slice_name(const struct stack *stack, size_t z, char *name, size_t size);

/* Natural order of names: numbers by value ("slice_9" before "slice_10"). As strcmp. */
int natural_compare(const char *a, const char *b);

#endif
