/* History of the time step: the number of steps limited by each effect, and each return of the
 * watchdog to an earlier state. Stored in /run of OUT.hdf and in checkpoints. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_STEP_LOG_H
#define TOSUI_SPHSOLVE_OUTPUT_STEP_LOG_H

#include <stddef.h>
#include <stdint.h>

#include "common/hdf5_file.h"

#define STEP_LIMITS_MAX 16

#define STEP_BACK_CAUSE 240
struct step_back {
  double time, back_to; /* s: when bounds were exceeded, and time of the restored state */
  double dt;            /* s: time step from then on */
  char cause[STEP_BACK_CAUSE];
};

struct step_log {
  size_t limit_count;
  char limit_names[STEP_LIMITS_MAX][48];
  double limit_steps[STEP_LIMITS_MAX];
  size_t back_count, back_capacity;
  struct step_back *backs;
};

/* Counts a step whose length `effect` limited. */
void step_log_limit(struct step_log *log, const char *effect);
/* Records a return to an earlier state. */
enum status step_log_back(struct step_log *log, const struct step_back *back);
/* Write and read GROUP/limits/{name,steps} and GROUP/watchdog/{time,back_to,dt,cause}; empty ones
 * are omitted. */
enum status step_log_write(const struct step_log *log, struct h5_file *file, const char *group);
enum status step_log_read(struct step_log *log, struct h5_file *file, const char *group);
void step_log_free(struct step_log *log);

#endif
