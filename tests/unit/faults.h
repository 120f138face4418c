/* Faults in the middle: a program runs in this process, and at each allocation, or each write, a
 * copy of the process (fork) goes on in which it fails, once; then this one goes on, its files as
 * they were. Each copy must end with an exit code and a message, hold no memory and no HDF5 object,
 * and leave no part file and no damaged file; so must the run that meets no fault. */
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
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "kept_files.h"

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

/* The faults of one run. */
static struct {
  const char *command, *what;
  long met, fatal, wrong, first; /* the first that is wrong, */
  int end;                       /* and what waitpid says of it */
  size_t held;                   /* bytes, before the run */
  bool is_copy;                  /* this process is one whose fault has come */
  char fresh[KEPT_MOST][520];    /* outputs that came or changed since the fault before */
  int fresh_count;
  char file[600]; /* what is wrong with one */
} faults;

static bool faults_is_fresh(const char *name) {
  for (int i = 0; i < faults.fresh_count; i++)
    if (strcmp(faults.fresh[i], name) == 0) return true;
  return kept_changed(name);
}

static void faults_note_fresh(const char *name, bool is_folder) {
  if (is_folder || !kept_changed(name)) return;
  if (faults.fresh_count == KEPT_MOST) abort();
  snprintf(faults.fresh[faults.fresh_count++], sizeof faults.fresh[0], "%s", name);
}

/* No part file; every HDF5 file under its final name opens. What no copy has looked at is looked
 * at: what has changed since the fault before. */
static void faults_check_file(const char *name, bool is_folder) {
  struct h5_file *file;
  (void)is_folder;
  if (ends_with(name, ".part") || ends_with(name, ".new.hdf"))
    snprintf(faults.file, sizeof faults.file, "%s was left", name);
  if (!ends_with(name, ".hdf") || !faults_is_fresh(name)) return;
  if (h5_open_sealed(name, &file) == STATUS_OK) {
    h5_close(file);
  } else {
    error_clear();
    snprintf(faults.file, sizeof faults.file, "%s is damaged", name);
  }
}

static void faults_show(void) {
  char line[400];
  FILE *file = fopen("said", "r");
  while (file != NULL && fgets(line, sizeof line, file) != NULL) print_error("  %s", line);
  if (file != NULL) fclose(file);
}

/* After the run, in this process or a copy: whether all is as it must be. */
static bool faults_check(int code) {
  struct stat info;
  const bool told = code == 0 || (stat("said", &info) == 0 && info.st_size > 0);
  const size_t held = memory_in_use();
  const ssize_t open = H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL);
  kept_each(faults_check_file);
  const bool ends = code >= 0 && code <= 4 && told && (faults.is_copy || code == 0);
  if (ends && held == faults.held && open <= 0 && faults.file[0] == '\0') return true;
  faults_show();
  print_error("%s %ld of '%s': exit code %d, %zd bytes were not freed, %zd HDF5 objects open; %s\n",
              faults.what, faults.met, faults.command, code, (ssize_t)(held - faults.held), open,
              faults.file);
  return false;
}

enum { FAULTS_FINE, FAULTS_FATAL, FAULTS_WRONG };
/* Sanitizers tell of leaks, and coverage is written, at the end of a process. */
static void faults_leave(int code) {
#if defined __SANITIZE_ADDRESS__ || defined TOSUI_COVERAGE
  exit(code);
#else
  _exit(code);
#endif
}

/* True in a copy, once. */
static bool faults_fail(void) {
  if (faults.is_copy) return false;
  faults.met++;
  faults.fresh_count = 0;
  kept_each(faults_note_fresh);
  kept_take();
  const pid_t copy = fork();
  if (copy < 0) abort();
  faults.is_copy = copy == 0;
  if (faults.is_copy) return true;
  int end;
  if (waitpid(copy, &end, 0) != copy) abort();
  kept_restore();
  const int code = WIFEXITED(end) ? WEXITSTATUS(end) : -1;
  faults.fatal += code == FAULTS_FATAL;
  if (code != FAULTS_FINE && code != FAULTS_FATAL && faults.wrong++ == 0)
    faults.first = faults.met, faults.end = end;
  return false;
}

/* `before` (may be NULL) is run whole first, to have something to go on with. */
static void faults_all(program run, const char *before, const char *command,
                       void (*ask_fails)(bool (*)(void)), const char *what) {
  kept_each(kept_drop);
  if (before != NULL) assert_int_equal(faults_run(run, before), 0);
  kept_take();
  memset(&faults, 0, sizeof faults);
  faults.command = command, faults.what = what, faults.held = memory_in_use();
  ask_fails(faults_fail);
  const int code = faults_run(run, command);
  ask_fails(NULL);
  if (faults.is_copy)
    faults_leave(!faults_check(code) ? FAULTS_WRONG : code != 0 ? FAULTS_FATAL : FAULTS_FINE);
  if (!faults_check(code) || faults.wrong > 0)
    fail_msg("'%s': %ld of %ld %ss end wrong; the first is number %ld, by signal %d", command,
             faults.wrong, faults.met, what, faults.first,
             WIFSIGNALED(faults.end) ? WTERMSIG(faults.end) : 0);
  kept_forget();
  print_message("# %s: %ld %ss, %ld of them fatal\n", command, faults.met, what, faults.fatal);
}

__attribute__((unused)) static void faults_both(program run, const char *before,
                                                const char *command) {
  faults_all(run, before, command, memory_ask_fails, "allocation");
  faults_all(run, before, command, output_ask_fails, "write");
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
