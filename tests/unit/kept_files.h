/* The files of a program in the middle of its run, kept while a copy of the process (fork) goes on
 * with them: afterwards names, bytes and places in open files are as they were. */
#ifndef TOSUI_TESTS_UNIT_KEPT_FILES_H
#define TOSUI_TESTS_UNIT_KEPT_FILES_H

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { KEPT_MOST = 64 };
#define KEPT_LINKS "kept" /* a folder whose names hold on to files that lose theirs */

struct kept_file {
  char name[520]; /* from this folder; empty: a file that has only its descriptor */
  int descriptor;
  ino_t number;
  char *bytes;
  size_t size;
};
static struct {
  int count;
  struct kept_file file[KEPT_MOST];
  int folders;
  char folder[KEPT_MOST][520];
  int opened;
  struct {
    int descriptor;
    off_t at;
  } place[KEPT_MOST];
} kept_all;

/* Outputs and what was said, those in folders too: nothing else changes. Folders come last. */
static void kept_each(void (*act)(const char *name, bool is_folder)) {
  DIR *folder = opendir(".");
  if (folder == NULL) abort();
  for (struct dirent *entry; (entry = readdir(folder)) != NULL;) {
    if (strncmp(entry->d_name, "out", 3) != 0 && strcmp(entry->d_name, "said") != 0) continue;
    DIR *inner = opendir(entry->d_name);
    for (struct dirent *file; inner != NULL && (file = readdir(inner)) != NULL;) {
      char name[520];
      snprintf(name, sizeof name, "%s/%s", entry->d_name, file->d_name);
      if (file->d_name[0] != '.') act(name, false);
    }
    act(entry->d_name, inner != NULL);
    if (inner != NULL) closedir(inner);
  }
  closedir(folder);
}
/* To be told from a time of change: no clock says so. */
static const struct timespec KEPT_TIMES[2] = {{1000000, 0}, {1000000, 0}};

static void kept_link(int i, char path[40]) {
  snprintf(path, 40, KEPT_LINKS "/%d", i);
}

static void kept_read(int descriptor, struct kept_file *file) {
  struct stat info;
  if (fstat(descriptor, &info) != 0) abort();
  file->number = info.st_ino;
  file->size = (size_t)info.st_size;
  file->bytes = malloc(file->size + 1);
  if (file->bytes == NULL || pread(descriptor, file->bytes, file->size, 0) != info.st_size) abort();
}

static struct kept_file *kept_next(void) {
  if (kept_all.count == KEPT_MOST) abort();
  return &kept_all.file[kept_all.count++];
}

/* Places in files that are open, and the bytes of those that have no name. */
static void kept_take_open(void) {
  DIR *folder = opendir("/proc/self/fd");
  if (folder == NULL) abort();
  kept_all.opened = 0;
  for (struct dirent *entry; (entry = readdir(folder)) != NULL;) {
    const int descriptor = atoi(entry->d_name);
    struct stat info;
    if (entry->d_name[0] == '.' || descriptor == dirfd(folder)) continue;
    if (fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode)) continue;
    if (kept_all.opened == KEPT_MOST) abort();
    kept_all.place[kept_all.opened].descriptor = descriptor;
    kept_all.place[kept_all.opened++].at = lseek(descriptor, 0, SEEK_CUR);
    if (info.st_nlink > 0 || (fcntl(descriptor, F_GETFL) & O_ACCMODE) == O_RDONLY) continue;
    struct kept_file *file = kept_next();
    file->name[0] = '\0';
    file->descriptor = descriptor;
    kept_read(descriptor, file);
  }
  closedir(folder);
}

/* Whether a file has come or changed since kept_take or kept_restore. */
static bool kept_changed(const char *name) {
  struct stat info;
  if (stat(name, &info) != 0) return false;
  for (int i = 0; i < kept_all.count; i++)
    if (strcmp(kept_all.file[i].name, name) == 0 && kept_all.file[i].number == info.st_ino)
      return info.st_mtim.tv_sec != KEPT_TIMES[1].tv_sec;
  return true;
}

static void kept_forget(void) {
  for (int i = 0; i < kept_all.count; i++) {
    char path[40];
    kept_link(i, path);
    unlink(path);
    free(kept_all.file[i].bytes);
  }
  kept_all.count = kept_all.folders = 0;
}

static void kept_take_one(const char *name, bool is_folder) {
  char path[40];
  if (is_folder) {
    if (kept_all.folders == KEPT_MOST) abort();
    snprintf(kept_all.folder[kept_all.folders++], sizeof kept_all.folder[0], "%s", name);
    return;
  }
  kept_link(kept_all.count, path);
  struct kept_file *file = kept_next();
  snprintf(file->name, sizeof file->name, "%s", name);
  const int descriptor = open(name, O_RDONLY);
  if (descriptor < 0 || link(name, path) != 0) abort();
  kept_read(descriptor, file);
  close(descriptor);
  utimensat(AT_FDCWD, path, KEPT_TIMES, 0);
}

/* Instead of what was kept before. */
static void kept_take(void) {
  kept_forget();
  mkdir(KEPT_LINKS, 0700);
  kept_each(kept_take_one);
  kept_take_open();
}

static void kept_drop(const char *name, bool is_folder) {
  if (is_folder ? rmdir(name) : unlink(name)) abort();
}

static void kept_restore(void) {
  kept_each(kept_drop);
  for (int i = 0; i < kept_all.folders; i++) mkdir(kept_all.folder[i], 0700);
  for (int i = 0; i < kept_all.count; i++) {
    const struct kept_file *file = &kept_all.file[i];
    char path[40];
    kept_link(i, path);
    const bool named = file->name[0] != '\0';
    const int descriptor = named ? open(path, O_WRONLY) : file->descriptor;
    if (descriptor < 0 || (named && link(path, file->name) != 0)) abort();
    if (ftruncate(descriptor, (off_t)file->size) != 0 ||
        pwrite(descriptor, file->bytes, file->size, 0) != (ssize_t)file->size)
      abort();
    futimens(descriptor, KEPT_TIMES);
    if (named) close(descriptor);
  }
  for (int i = 0; i < kept_all.opened; i++)
    lseek(kept_all.place[i].descriptor, kept_all.place[i].at, SEEK_SET);
}

#endif
