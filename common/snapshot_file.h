/* Snapshots of particles: VTKHDF 1.0 UnstructuredGrid, one file per instant, readable by ParaView
 * 5.11 and by analyze. */
#ifndef TOSUI_COMMON_SNAPSHOT_FILE_H
#define TOSUI_COMMON_SNAPSHOT_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/hdf5_file.h"

struct snapshot_field {
  const char *name, *unit, *description;
  enum h5_type type;
  int components;   /* 1 or 3 */
  const void *data; /* [count][components] */
  /* If `data` is NULL: computes the data when the field is written, into memory that is freed at
   * once. Called on all ranks, even if this rank has no particles. */
  enum status (*fill)(const void *context, void *data);
  const void *context;
};

/* Hash of the velocities, which links a file to the flow of a run: the run file has the same one
 * (`flow_hash` of /run). 0 means unknown; the attribute is then omitted. */
enum status flow_hash_write(struct h5_file *file, const char *group, uint64_t hash);
uint64_t flow_hash_read(struct h5_file *file, const char *group);
/* STATUS_INPUT if both files have a hash and they differ. */
enum status flow_hash_check(const char *record_path, uint64_t record, const char *path,
                            struct h5_file *file);

/* Writes a snapshot, atomically. `points`: f64, 3 components, m. Root attributes `time` (s) and
 * `step`. */
enum status snapshot_write(const char *path, double time, int64_t step, uint64_t flow, size_t count,
                           const struct snapshot_field *points, size_t field_count,
                           const struct snapshot_field *fields);

/* Collective: makes a file an UnstructuredGrid of points, `count` of them on this rank, with cells
 * of `each` consecutive ones and VTK's number `type`. */
#define VTK_VERTEX 1
#define VTK_POLY_LINE 4
enum status snapshot_write_grid(struct h5_file *file, size_t count,
                                const struct snapshot_field *points, size_t each, int type);

/* Rewrites PREFIX.hdf.series, ParaView's list of the snapshots and their times. */
enum status series_write(const char *path, size_t count, char *const *names, const double *times);

/* snapshot_open reads the points [count][3] (m) into new memory; snapshot_read one field as f64
 * [count][components]. */
struct snapshot {
  double time;
  size_t count;
  double *points;
  struct h5_file *file;
};
enum status snapshot_open(const char *path, struct snapshot *snapshot);
enum status snapshot_read(struct snapshot *snapshot, const char *field, int components,
                          double **values);
void snapshot_close(struct snapshot *snapshot);

#endif
