/* Runs a fuzz target over the files of its corpus, or of the folder given, as `make check` does:
 * what fuzzing found once must stay mended. Speaks TAP; replay_NAME replays tests/fuzz/corpus/NAME.
 */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* No file of the corpora may take more, those that once took gigabytes included. */
#define MOST_MEGABYTES 1024

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int replay(const char *path) {
  FILE *file = fopen(path, "rb");
  if (file == NULL || fseek(file, 0, SEEK_END) != 0) return 1;
  long size = ftell(file);
  uint8_t *bytes = size >= 0 ? malloc((size_t)size + 1) : NULL;
  rewind(file);
  if (bytes == NULL || fread(bytes, 1, (size_t)size, file) != (size_t)size) return 1;
  fclose(file);
  LLVMFuzzerTestOneInput(bytes, (size_t)size);
  free(bytes);
  return 0;
}

int main(int argc, char **argv) {
  char folder[512], path[1024];
  const char *name = strrchr(argv[0], '/');
  name = strstr(name != NULL ? name : argv[0], "replay_");
  int files = 0, unread = 0;
  snprintf(folder, sizeof folder, "tests/fuzz/corpus/%s", name != NULL ? name + 7 : "");
  if (argc > 1) snprintf(folder, sizeof folder, "%s", argv[1]);
  DIR *handle = opendir(folder);
  for (struct dirent *entry; handle != NULL && (entry = readdir(handle)) != NULL;) {
    if (entry->d_name[0] == '.') continue;
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    unread += replay(path);
    files++;
  }
  if (handle != NULL) closedir(handle);
  struct rusage usage = {0};
  getrusage(RUSAGE_SELF, &usage);
  const long megabytes = usage.ru_maxrss / 1024;
  int bad = files == 0 || unread > 0 || megabytes > MOST_MEGABYTES;
  /* stderr too speaks TAP here: a target may close stdout. */
  fprintf(stderr, "%sok 1 - %s: %d files replayed in %ld MB\n1..1\n", bad ? "not " : "", folder,
          files, megabytes);
  return bad;
}
