/* Ctrl-C and its kin: the first signal says "stopping" at once and is noted, for loops to end in
 * order; a second one ends the program. */
#ifndef TOSUI_COMMON_INTERRUPT_H
#define TOSUI_COMMON_INTERRUPT_H

#include <stdbool.h>

/* From here on SIGINT and SIGTERM are noted; `doing` ("writing a checkpoint; ...") is said
 * behind "stopping" and is copied. */
void interrupt_start(const char *doing);
/* Whether one has come: costs a load. Of this process alone: ranks have to agree by themselves. */
bool interrupt_requested(void);

#endif
