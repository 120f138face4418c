/* Handling of SIGINT and SIGTERM: the first signal prints "stopping" at once and is recorded, so
 * that loops can end in an orderly way; a second one ends the program. */
#ifndef TOSUI_COMMON_INTERRUPT_H
#define TOSUI_COMMON_INTERRUPT_H

#include <stdbool.h>

#include "common/error.h"

/* Handles SIGINT and SIGTERM from here on; `doing` ("writing a checkpoint; ...") is copied and
 * printed behind "stopping". */
void interrupt_start(const char *doing);
/* Whether a signal has been received by this process; ranks have to agree among themselves. Costs a
 * single load. */
bool interrupt_requested(void);
/* The same for loops in which ranks do not communicate: always false with more than one rank. */
bool interrupt_alone(void);
/* STATUS_INTERRUPTED after a signal, as interrupt_alone: to be called between the stages of long
 * work and after loops that were left. */
enum status interrupt_look(void);

/* Whether a signal has been received, for work that is done at the end in any case: not counted by
 * interrupt_after. */
bool interrupt_came(void);

/* For tests: the n-th query from now on, and all after it, are answered as if a signal had been
 * received; 0: none is. Earlier signals are forgotten. Returns how many queries were left. */
long interrupt_after(long n);

#endif
