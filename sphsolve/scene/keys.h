/* Every key of a scene file stands once, in keys.def: its type, unit, range, default, whose it is
 * and what it means. From that table come the reader of plain values, the check for unknown and
 * misspelt keys, `sphsolve keys` and docs/reference/scene.md. Keys whose value has a form of its
 * own (boxes, tables of time, tensors) are read by the file that knows them; the table names them.
 */
#ifndef TOSUI_SPHSOLVE_SCENE_KEYS_H
#define TOSUI_SPHSOLVE_SCENE_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "common/config.h"
#include "sphsolve/scene/scene.h"

enum key_kind {
  KEY_GROUP,  /* { ... } */
  KEY_LIST,   /* ( { ... }, ... ) */
  KEY_TEXT,   /* in quotes */
  KEY_BOOL,   /* true or false */
  KEY_CHOICE, /* one of `choices` */
  KEY_NUMBER, /* a number, or a quantity with its unit */
  KEY_VECTOR, /* a quantity for each dimension of the scene */
  KEY_FORM    /* its own form, described by `form` */
};

struct scene_key {
  const char *group; /* "" for the file itself; "regions[]" for an item of the list */
  const char *name;
  enum key_kind kind;
  bool or_auto; /* "auto" is a value, too */
  struct dimension dimension;
  const char *const *choices; /* ended by NULL */
  const char *form;
  double low, high;  /* the range; without one low > high */
  bool above, below; /* the limit itself lies outside */
  const char *hint;  /* added where a value is out of range */
  double preset;     /* value of a key that is not given; a choice's index */
  const char *told;  /* the default in words; NULL: `preset` */
  const char *needs; /* an example of a key that must be given; NULL: it may be left out */
  unsigned types;    /* regions: bit i for region type i; 0: all */
  const char *with;  /* it needs one of these keys beside it, "corners centre"; NULL: none */
  bool stored;       /* read from the table into the member at `offset` */
  size_t offset, size;
  const char *owner; /* "scene", a method or an effect; several with ", " */
  const char *text;
};

/* The table in the order of the file; *count rows. */
const struct scene_key *keys_all(size_t *count);
/* Range of a key in words ("above 0", "from 0 to below 1"); "" without one. */
void keys_range(const struct scene_key *key, char *text, size_t size);

/* Reads the stored keys of `group` (path as in the table; NULL: no such group in the file, which
 * sets the defaults) into `target`: the scene, or the region, gauge, ... of that path. `types`: bit
 * of the region's type, else 0. */
enum status keys_read(struct config *config, config_node *group, const char *path, unsigned types,
                      const struct scene *scene, void *target);
/* Reads one number of the table by its path and name; a missing key leaves *value as it is. */
enum status keys_read_number(struct config *config, config_node *group, const char *path,
                             const char *name, double *value);
/* Reads a vector of the scene's dimensions: [x, z] of a 2-D scene, else [x, y, z]. */
enum status keys_read_vector(struct config *config, config_node *group, const char *name,
                             const struct scene *scene, struct dimension dimension,
                             double vector[3]);
/* Moves the two values of a 2-D vector to x and z. */
void keys_spread(const struct scene *scene, int count, double vector[3]);

/* Checks the names in a file, and that groups are groups and lists are lists. `misspelt_only`: only
 * names that resemble a known one; to be called first, since a misspelt key is often the reason why
 * another seems to be missing. */
enum status keys_check_names(struct config *config, bool misspelt_only);

#endif
