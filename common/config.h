/* Scene files: libconfig behind a layer of typed reads, whose errors name file, line and key. Which
 * keys there are, sphsolve/scene/keys.def says. */
#ifndef TOSUI_COMMON_CONFIG_H
#define TOSUI_COMMON_CONFIG_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "common/units.h"

struct config;                               /* an open file */
typedef struct config_setting_t config_node; /* a group, list or value in it; owned by the file */

/* Reads `path`, then applies `overrides` ("isph.tau=0.05 s", "regions.[1].porosity=0.4"; created
 * where missing; count n). Free with config_close. */
enum status config_open(const char *path, const char *const *overrides, size_t n,
                        struct config **config);
void config_close(struct config *config);
config_node *config_root(struct config *config);
/* The file's text with overrides appended as comments, for /run/scene. Owned by `config`. */
const char *config_text(const struct config *config);
/* Folder of the file ("" for the current), for paths inside it. */
const char *config_folder(const struct config *config);

/* The child with that name, or NULL, as for a `parent` that is NULL or no group. */
config_node *config_child(config_node *parent, const char *name);
/* Name of a node in its group; NULL for an item of a list. */
const char *config_name(const config_node *node);
/* The i-th item of a list, and the number of items of a list or group. */
config_node *config_item(config_node *list, size_t i);
size_t config_count(const config_node *node);
bool config_is_list(const config_node *node); /* list or array */
bool config_is_group(const config_node *node);
bool config_is_text(const config_node *node);
bool config_is_number(const config_node *node);
/* Values of a node that is known to be a boolean or a text. config_line: its line in the file, 0
 * for a node from an override. */
bool config_boolean_value(const config_node *node);
const char *config_text_value(const config_node *node);
int config_line(const config_node *node);

/* An input error at `node`: "scene.cfg:12: wcsph.dt: MESSAGE". */
enum status config_error(const struct config *config, const config_node *node, const char *format,
                         ...) __attribute__((format(printf, 3, 4)));

/* Typed reads of a child `name` of `group`. `group` may be NULL, which counts as a missing key.
 * When the key is missing *value is unchanged and *given is false; `given` may be NULL. */
enum status config_quantity(struct config *config, config_node *group, const char *name,
                            struct dimension dimension, double *value, bool *given);
enum status config_number(struct config *config, config_node *group, const char *name,
                          double *value, bool *given);
enum status config_bool(struct config *config, config_node *group, const char *name, bool *value,
                        bool *given);
enum status config_string(struct config *config, config_node *group, const char *name,
                          const char **value, bool *given);
/* A string that must be one of `choices` (NULL-terminated); *value is its index. The error message
 * names the nearest choice. */
enum status config_choice(struct config *config, config_node *group, const char *name,
                          const char *const *choices, int *value, bool *given);
/* An array or list of `min` to `max` quantities; *count is their number. */
enum status config_quantities(struct config *config, config_node *group, const char *name,
                              struct dimension dimension, int min, int max, double *values,
                              int *count, bool *given);
/* Either the word "auto", which sets *automatic, or a quantity. */
enum status config_auto_quantity(struct config *config, config_node *group, const char *name,
                                 struct dimension dimension, double *value, bool *automatic,
                                 bool *given);

#endif
