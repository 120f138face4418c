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
  /* Without data: makes it, when its turn has come, in memory that is given back at once; on all
   * ranks, also where none is to be written. */
  enum status (*fill)(const void *context, void *data);
  const void *context;
};

/* Which run a file of its flow belongs to: the hash of the velocities that its record has as well
 * (`flow_hash` of /run); 0 and no attribute where a run knows none. */
enum status flow_hash_write(struct h5_file *file, const char *group, uint64_t hash);
uint64_t flow_hash_read(struct h5_file *file, const char *group);
/* STATUS_INPUT where both files know theirs and they are unlike. */
enum status flow_hash_check(const char *record_path, uint64_t record, const char *path,
                            struct h5_file *file);

/* `points`: f64, 3 components, m. Root attribute `time` (s), `step`. Atomic. */
enum status snapshot_write(const char *path, double time, int64_t step, uint64_t flow, size_t count,
                           const struct snapshot_field *points, size_t field_count,
                           const struct snapshot_field *fields);

/* Rewrites PREFIX.hdf.series, ParaView's list of the snapshots with their times. */
enum status series_write(const char *path, size_t count, char *const *names, const double *times);

/* Points [count][3] into new memory; then one field as f64 [count][components]. */
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
