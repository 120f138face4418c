#include "sphsolve/scene/scene_names.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "common/text.h"

enum status scene_read_name(struct config *config, config_node *group, const char *title,
                            size_t number, char *name, size_t size) {
  const char *given = NULL;
  enum status status = config_string(config, group, "name", &given, NULL);
  if (status != STATUS_OK) return status;
  if (given == NULL) {
    snprintf(name, size, "%s_%zu", title, number);
    return STATUS_OK;
  }
  bool plain = *given != '\0' && strlen(given) < size && text_is_plain(given);
  for (const char *c = given; *c; c++)
    plain =
        plain && ((unsigned char)*c >= 0x80 || isalnum((unsigned char)*c) || strchr("-_+ ", *c));
  if (!plain)
    return config_error(config, config_child(group, "name"),
                        "names a column: 1 to %zu letters, digits, -, _, + or spaces are wanted",
                        size - 1);
  snprintf(name, size, "%s", given);
  return STATUS_OK;
}
