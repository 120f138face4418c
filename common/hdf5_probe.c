/* Probes a file in a child process. HDF5 1.10 can crash or hang on damaged metadata (fuzzing found
 * both within seconds). The child reads everything that a reader may read; if it dies the file is
 * refused, and the program goes on. */
#include "common/hdf5_probe.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/hdf5_store.h"

#ifndef PROBE_SECONDS
#define PROBE_SECONDS 20
#endif
#define READ_LIMIT (1u << 22) /* bytes of an object; larger ones would reveal nothing more */
/* Bytes that the library may allocate: a damaged size made it ask for 4 GB. */
#define LIBRARY_MEMORY_LIMIT (1ul << 28)
enum { PROBE_OUT_OF_MEMORY = 2, PROBE_INCOMPLETE, PROBE_TOO_DEEP }; /* exit codes of the child */
/* Nested groups; our files have three, and the time of the library is quadratic in the depth. */
#define GROUP_DEPTH_MAX 32

/* Ends the child; with `make coverage` its counters are written first. */
#ifdef TOSUI_COVERAGE
#include <gcov.h>
#define PROBE_EXIT(code) (__gcov_dump(), _exit(code))
#else
#define PROBE_EXIT(code) _exit(code)
#endif

/* Reads a dataset or attribute of `space` into values of `type`, including strings of variable
 * length. */
static void read_as(hid_t id, hid_t type, hid_t space, size_t points, bool is_attribute) {
  void *values = calloc(points, H5Tget_size(type));
  if (values == NULL) return;
  herr_t failed = is_attribute ? H5Aread(id, type, values)
                               : H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  if (failed >= 0 && H5Tis_variable_str(type) > 0)
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, values);
  free(values);
}

/* Reads small objects in their stored type, and numbers also in the types that readers ask for: the
 * conversion of a type with an invalid bit field reads beyond the memory, too. */
static void read_small(hid_t id, hid_t type, hid_t space, bool is_attribute) {
  hssize_t points = H5Sget_simple_extent_npoints(space);
  size_t width = H5Tget_size(type);
  if (points <= 0 || width == 0 || width > READ_LIMIT || points > (hssize_t)(READ_LIMIT / width))
    return;
  read_as(id, type, space, (size_t)points, is_attribute);
  const H5T_class_t class = H5Tget_class(type);
  if (class == H5T_INTEGER) read_as(id, H5T_NATIVE_INT64, space, (size_t)points, is_attribute);
  if (class == H5T_INTEGER || class == H5T_FLOAT)
    read_as(id, H5T_NATIVE_DOUBLE, space, (size_t)points, is_attribute);
}

static herr_t try_attribute(hid_t object, const char *name, const H5A_info_t *info, void *unused) {
  (void)info, (void)unused;
  hid_t id = H5Aopen(object, name, H5P_DEFAULT), type = H5Aget_type(id), space = H5Aget_space(id);
  if (id >= 0 && type >= 0 && space >= 0) read_small(id, type, space, true);
  H5Sclose(space);
  H5Tclose(type);
  H5Aclose(id);
  return 0;
}

static void try_dataset(hid_t set) {
  hid_t type = H5Dget_type(set), space = H5Dget_space(set), layout = H5Dget_create_plist(set);
  hsize_t chunks = 0;
  if (type >= 0 && space >= 0 && layout >= 0) {
    if (H5Pget_layout(layout) == H5D_CHUNKED) H5Dget_num_chunks(set, space, &chunks);
    /* With the filters checked, the probe loads no plug-in and no other file. */
    if (h5_filters_known(set)) read_small(set, type, space, false);
  }
  H5Pclose(layout);
  H5Sclose(space);
  H5Tclose(type);
}

static void try_group(hid_t group) {
  H5G_info_t info;
  char name[256];
  if (H5Gget_info(group, &info) < 0) return;
  for (hsize_t i = 0; i < info.nlinks && i < 1000; i++)
    if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name,
                           H5P_DEFAULT) < 0)
      return;
}

static herr_t try_object(hid_t root, const char *name, const H5O_info_t *info, void *unused) {
  (void)unused;
  int depth = 0;
  for (const char *c = name; *c; c++) depth += *c == '/';
  if (depth > GROUP_DEPTH_MAX) PROBE_EXIT(PROBE_TOO_DEEP);
  /* Opened by address: opening by name would traverse all parent groups for each object. */
  hid_t object = H5Oopen_by_addr(root, info->addr);
  if (object < 0) return 0;
  herr_t failed = H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, NULL, try_attribute, NULL);
  if (info->type == H5O_TYPE_DATASET) try_dataset(object);
  if (info->type == H5O_TYPE_GROUP) try_group(object);
  H5Oclose(object);
  return failed;
}

static herr_t exit_if_out_of_memory(unsigned n, const H5E_error2_t *error, void *unused) {
  (void)n, (void)unused;
  if (error->maj_num == H5E_RESOURCE) PROBE_EXIT(PROBE_OUT_OF_MEMORY);
  return 0;
}

/* Called by the library when one of its functions fails. */
static herr_t on_library_error(hid_t stack, void *unused) {
  return H5Ewalk2(stack, H5E_WALK_DOWNWARD, exit_if_out_of_memory, unused);
}

/* Limits the memory of this process to the present amount and LIBRARY_MEMORY_LIMIT; no limit
 * without /proc. */
static void limit_memory(void) {
  unsigned long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (file == NULL) return;
  int read = fscanf(file, "%*u %*u %*u %*u %*u %lu", &pages);
  fclose(file);
  rlim_t most = pages * (unsigned long)sysconf(_SC_PAGESIZE) + LIBRARY_MEMORY_LIMIT;
  if (read == 1) setrlimit(RLIMIT_DATA, &(struct rlimit){most, most});
  H5Eset_auto2(H5E_DEFAULT, on_library_error, NULL);
}

static void probe_file(const char *path) {
  const struct rlimit none = {0, 0};
  static const int deadly[] = {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGALRM, SIGINT, SIGTERM};
  for (size_t i = 0; i < sizeof deadly / sizeof *deadly; i++) signal(deadly[i], SIG_DFL);
  setrlimit(RLIMIT_CORE, &none);
  limit_memory();
  alarm(PROBE_SECONDS);
  hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file >= 0) {
    /* An incomplete traversal may have missed objects that a reader will read. */
    if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, try_object, NULL, H5O_INFO_BASIC) < 0)
      PROBE_EXIT(PROBE_INCOMPLETE);
    H5Fclose(file);
  }
  PROBE_EXIT(0); /* other errors are found and reported by the reader itself */
}

enum status h5_try(const char *path) {
  int end = 0;
  pid_t child = fork();
  if (child < 0) return STATUS_OK; /* no child process: the file is read without a probe */
  if (child == 0) probe_file(path);
  while (waitpid(child, &end, 0) < 0)
    if (errno != EINTR) return STATUS_OK;
  if (WIFEXITED(end) && WEXITSTATUS(end) == 0) return STATUS_OK;
  const char *what = "the HDF5 library fails on it";
  if (WIFSIGNALED(end) && WTERMSIG(end) == SIGALRM) what = "reading it does not end";
  if (WIFEXITED(end) && WEXITSTATUS(end) == PROBE_OUT_OF_MEMORY)
    what = "it asks for more memory than any needs";
  if (WIFEXITED(end) && WEXITSTATUS(end) == PROBE_INCOMPLETE)
    what = "not all that it lists can be read";
  if (WIFEXITED(end) && WEXITSTATUS(end) == PROBE_TOO_DEEP)
    what = "its groups lie too deep in each other";
  return FAIL(STATUS_INPUT, "%s: is damaged (%s); make or copy it anew", path, what);
}
