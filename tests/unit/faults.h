/* Faults in the middle: a program run again and again in this process, while its n-th allocation,
 * or its n-th write, fails, for n = 1, 2, ... until a run meets no fault. Each must end with an
 * exit code and a message, hold no memory and no HDF5 object, and leave no part file and no damaged
 * file. */
#ifndef TOSUI_TESTS_UNIT_FAULTS_H
#define TOSUI_TESTS_UNIT_FAULTS_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <hdf5.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/output_file.h"

static char faults_folder[40]; /* in memory: each output is synced to its disk */

typedef int (*program)(int argc, char **argv);

/* In a folder of its own, with stderr in the file `said`; the exit code. */
static int faults_run(program run, const char *command) {
  char words[1024], *argv[40];
  int argc = 0;
  snprintf(words, sizeof words, "%s", command);
  for (char *word = strtok(words, " "); word != NULL && argc < 39; word = strtok(NULL, " "))
    argv[argc++] = word;
  argv[argc] = NULL;
  fflush(NULL);
  int out = dup(1), err = dup(2);
  if (freopen("/dev/null", "w", stdout) == NULL || freopen("said", "w", stderr) == NULL) abort();
  int code = run(argc, argv);
  fflush(NULL);
  dup2(out, 1);
  dup2(err, 2);
  close(out);
  close(err);
  error_clear();
  return code;
}

static bool ends_with(const char *name, const char *ending) {
  size_t n = strlen(name), m = strlen(ending);
  return n >= m && !strcmp(name + n - m, ending);
}

/* No part file; every HDF5 file under its final name that has changed since then opens. */
static void faults_check_files(const char *where, struct timespec since, const char *what, long n) {
  DIR *folder = opendir(where);
  for (struct dirent *entry; (entry = readdir(folder)) != NULL;) {
    struct h5_file *file;
    char path[400];
    snprintf(path, sizeof path, "%s/%s", where, entry->d_name);
    if (ends_with(entry->d_name, ".part") || ends_with(entry->d_name, ".new.hdf"))
      fail_msg("%s %ld: %s was left", what, n, path);
    if (entry->d_type == DT_DIR && entry->d_name[0] != '.')
      faults_check_files(path, since, what, n);
    struct stat info;
    if (!ends_with(entry->d_name, ".hdf")) continue;
    if (stat(path, &info) == 0 &&
        (info.st_ctim.tv_sec < since.tv_sec ||
         (info.st_ctim.tv_sec == since.tv_sec && info.st_ctim.tv_nsec < since.tv_nsec)))
      continue;
    if (h5_open_sealed(path, &file) != STATUS_OK) fail_msg("%s %ld: %s is damaged", what, n, path);
    h5_close(file);
  }
  closedir(folder);
}

static void faults_clear(void) {
  DIR *folder = opendir(".");
  for (struct dirent *entry; (entry = readdir(folder)) != NULL;)
    if (!strncmp(entry->d_name, "out", 3)) unlink(entry->d_name);
  closedir(folder);
}

/* The outputs in one folder become those of another. */
static void faults_copy(const char *from, const char *to) {
  DIR *folder = opendir(from);
  for (struct dirent *entry; (entry = readdir(folder)) != NULL;) {
    char path[400], data[4096];
    if (strncmp(entry->d_name, "out", 3) != 0) continue;
    snprintf(path, sizeof path, "%s/%s", from, entry->d_name);
    FILE *in = fopen(path, "rb");
    snprintf(path, sizeof path, "%s/%s", to, entry->d_name);
    FILE *out = fopen(path, "wb");
    for (size_t n; (n = fread(data, 1, sizeof data, in)) > 0;)
      assert_int_equal(fwrite(data, 1, n, out), n);
    fclose(in);
    assert_int_equal(fclose(out), 0);
  }
  closedir(folder);
}

/* Runs `before` and puts its outputs aside, in a folder of their own. */
static void faults_prepare(program run, const char *before, const char *aside) {
  faults_clear();
  if (before == NULL) return;
  assert_int_equal(faults_run(run, before), 0);
  assert_int_equal(mkdir(aside, 0700), 0);
  faults_copy(".", aside);
}

static void faults_show(void) {
  char line[400];
  FILE *file = fopen("said", "r");
  while (file != NULL && fgets(line, sizeof line, file) != NULL) print_error("  %s", line);
  if (file != NULL) fclose(file);
}

/* `before` (may be NULL) is run whole first, to have something to go on with: each time from the
 * same files. */
static void faults_all(program run, const char *before, const char *command,
                       long (*fail_after)(long), const char *what) {
  long n = 1, refused = 0;
  static int times; /* a folder each */
  char aside[40];
  snprintf(aside, sizeof aside, "before-%d", times++);
  faults_prepare(run, before, aside);
  for (bool met = true; met; n++) {
    faults_clear();
    if (before != NULL) faults_copy(aside, ".");
    size_t held = memory_in_use();
    struct timespec started; /* by the clock of files */
    clock_gettime(CLOCK_REALTIME_COARSE, &started);
    fail_after(n);
    int code = faults_run(run, command);
    met = fail_after(0) == 0;
    refused += code != 0;
    bool told = code == 0;
    struct stat info;
    if (stat("said", &info) == 0 && info.st_size > 0) told = true;
    if (code < 0 || code > 4 || !told || (!met && code != 0)) {
      faults_show();
      fail_msg("%s %ld of '%s': exit code %d", what, n, command, code);
    }
    if (memory_in_use() != held) {
      faults_show();
      fail_msg("%s %ld of '%s': %zu bytes were not freed", what, n, command,
               memory_in_use() - held);
    }
    ssize_t open = H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL);
    if (open > 0) {
      faults_show();
      fail_msg("%s %ld of '%s': %zd HDF5 objects are open", what, n, command, open);
    }
    faults_check_files(".", started, what, n);
    if (n > 20000) fail_msg("'%s' does not end", command);
  }
  print_message("# %s: %ld %ss, %ld of them fatal\n", command, n - 2, what, refused);
}

__attribute__((unused)) static void faults_both(program run, const char *before, const char *command) {
  faults_all(run, before, command, memory_fail_after, "allocation");
  faults_all(run, before, command, output_fail_after, "write");
}

static int faults_start(void **state) {
  (void)state;
  setenv("OMP_WAIT_POLICY", "passive", 1); /* or main would start the test anew */
  setenv("PATH", "", 1);                   /* no gnuplot: its own faults are not ours */
  snprintf(faults_folder, sizeof faults_folder, "%s/tosui-faults-XXXXXX",
           access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
  return mkdtemp(faults_folder) == NULL || chdir(faults_folder) != 0;
}

static int faults_end(void **state) {
  (void)state;
  char command[80];
  if (chdir("/") != 0) return 1;
  snprintf(command, sizeof command, "/bin/rm -rf '%s'", faults_folder);
  return system(command);
}

#endif
