/* Steadiness: the relative change of a flow that remains (docs/formats.md). For a sampled series it
 * is extrapolated, with a mean and an error that includes the noise; for a flow with a known
 * relaxation time it follows from that. */
#ifndef TOSUI_SPHSOLVE_MARCH_MONITOR_H
#define TOSUI_SPHSOLVE_MARCH_MONITOR_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

#define MONITOR_COMPONENTS 4

/* Samples at equal intervals; value[0] decides, the others are only averaged. */
struct monitor {
  double (*rows)[MONITOR_COMPONENTS];
  size_t count, capacity;
};

struct monitor_verdict {
  bool steady;
  double mean[MONITOR_COMPONENTS];
  double error; /* relative 95 % error of mean[0]: noise and remaining change */
  double drift; /* the part due to the remaining change */
};

/* Adds a sample. Free with monitor_free. */
enum status monitor_add(struct monitor *monitor, const double value[MONITOR_COMPONENTS]);
void monitor_free(struct monitor *monitor);
/* Steady: the error is below the tolerance, or below 100 tolerances if it is noise about a constant
 * mean. `least`: number of samples before anything may be called steady. */
struct monitor_verdict monitor_judge(const struct monitor *monitor, double tolerance, size_t least);

/* For samples at unequal times: since when (s) the velocity has stayed near a reference. */
struct monitor_settling {
  double since, reference[3];
};
/* Steady: over the last tenth of the time no component has changed by more than `tolerance` of the
 * largest. The remaining part of a change that decays as exp(-t/T) is then smaller than that, after
 * 7 T. */
bool monitor_settled(struct monitor_settling *settling, double tolerance, double time,
                     const double velocity[3]);

#endif
