#include "sphsolve/scene/scene_names.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

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

enum status scene_file_find(struct config *config, config_node *group, const char *name,
                            const char *example, const char *made, char path[4096]) {
  enum status status = STATUS_OK;
  config_node *node = config_child(group, name);
  const char *file = "";
  TRY(config_string(config, group, name, &file, NULL));
  if (!*file) TRY(config_error(config, group, "%s is missing, like %s = %s", name, name, example));
  const char *folder = *file == '/' ? "" : config_folder(config);
  if (snprintf(path, 4096, "%s%s", folder, file) >= 4096)
    TRY(config_error(config, node, "the path is too long"));
  if (access(path, R_OK) != 0 && access(file, R_OK) == 0) snprintf(path, 4096, "%s", file);
  if (access(path, R_OK) != 0)
    TRY(config_error(config, node, "%s cannot be read%s%s%s%s", path,
                     *made ? "; make it with " : "", made, *made ? " " : "", *made ? file : ""));
cleanup:
  return status;
}
