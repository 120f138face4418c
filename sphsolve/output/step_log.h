/* What became of the time step: how many steps each effect limited, and each time the watchdog went
 * back. Stands in /run of OUT.hdf and in checkpoints. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_STEP_LOG_H
#define TOSUI_SPHSOLVE_OUTPUT_STEP_LOG_H

#include <stddef.h>
#include <stdint.h>

#include "common/hdf5_file.h"

#define STEP_LIMITS_MAX 16

#define STEP_BACK_CAUSE 240
struct step_back {
  double time, back_to; /* s: when bounds were left, and of the state gone back to */
  double dt;            /* s: from then on */
  char cause[STEP_BACK_CAUSE];
};

struct step_log {
  size_t limit_count;
  char limit_names[STEP_LIMITS_MAX][48];
  double limit_steps[STEP_LIMITS_MAX];
  size_t back_count, back_capacity;
  struct step_back *backs;
};

/* One more step whose length `effect` decided. */
void step_log_limit(struct step_log *log, const char *effect);
enum status step_log_back(struct step_log *log, const struct step_back *back);
/* GROUP/limits/{name,steps}, GROUP/watchdog/{time,back_to,dt,cause}; what is empty is left out. */
enum status step_log_write(const struct step_log *log, struct h5_file *file, const char *group);
enum status step_log_read(struct step_log *log, struct h5_file *file, const char *group);
void step_log_free(struct step_log *log);

#endif
