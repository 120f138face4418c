/* Ctrl-C and its kin: the first signal says "stopping" at once and is noted, for loops to end in
 * order; a second one ends the program. */
#ifndef TOSUI_COMMON_INTERRUPT_H
#define TOSUI_COMMON_INTERRUPT_H

#include <stdbool.h>

#include "common/error.h"

/* From here on SIGINT and SIGTERM are noted; `doing` ("writing a checkpoint; ...") is said
 * behind "stopping" and is copied. */
void interrupt_start(const char *doing);
/* Whether one has come: costs a load. Of this process alone: ranks have to agree by themselves. */
bool interrupt_requested(void);
/* The same where there is one process, for loops without an agreement between ranks: with several
 * always false. */
bool interrupt_alone(void);
/* STATUS_INTERRUPTED then, between the stages of long work, and after loops that were left. */
enum status interrupt_look(void);

/* Whether one has come, for what is done at the end anyway: no question of those below. */
bool interrupt_came(void);

/* For tests: the n-th question from now on is answered as if a signal had come, as are those after
 * it; 0: none is. What came before is forgotten. Returns how many were left. */
long interrupt_after(long n);

#endif
