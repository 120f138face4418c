#include "sphsolve/scene/scene_file.h"

#include <stdio.h>
#include <unistd.h>

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
