/* Steadiness: how much of the change of a flow is still to come, relative (docs/formats.md). Of a
 * sampled series it is extrapolated, with a mean and an error that counts its noise too; of a flow
 * whose relaxation time is known it follows from that. */
#ifndef TOSUI_SPHSOLVE_MARCH_MONITOR_H
#define TOSUI_SPHSOLVE_MARCH_MONITOR_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

#define MONITOR_COMPONENTS 4

/* Samples at equal intervals; value[0] decides, the others are averaged with it. */
struct monitor {
  double (*rows)[MONITOR_COMPONENTS];
  size_t count, capacity;
};

struct monitor_verdict {
  bool steady;
  double mean[MONITOR_COMPONENTS];
  double error; /* of mean[0], relative, 95 %: its noise and the change still to come */
  double drift; /* its part that is change still to come */
};

/* The next sample. Free with monitor_free. */
enum status monitor_add(struct monitor *monitor, const double value[MONITOR_COMPONENTS]);
void monitor_free(struct monitor *monitor);
/* Steady: the error is below the tolerance, or below 100 of them where what is left is noise about
 * a mean that has stopped moving. `least`: samples before anything may be called steady. */
struct monitor_verdict monitor_judge(const struct monitor *monitor, double tolerance, size_t least);

/* Without samples at equal intervals: since when, s, the velocity has stayed near a reference. */
struct monitor_settling {
  double since, reference[3];
};
/* Steady: no component has moved by more than `tolerance` of the largest over the last tenth of the
 * time. Of a change that dies as exp(-t/T) less than that is then still to come, after 7 T. */
bool monitor_settled(struct monitor_settling *settling, double tolerance, double time,
                     const double velocity[3]);

/* By how much, relative, the mean over the second half of `time` (s) stays below what the value
 * relaxes to as 1 - exp(-t / relaxation). */
double monitor_relaxation_deficit(double time, double relaxation);

#endif
