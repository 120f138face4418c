/* For memory_ask_fails and output_ask_fails: the n-th allocation or write from now fails. */
#ifndef TOSUI_TESTS_UNIT_NTH_FAILS_H
#define TOSUI_TESTS_UNIT_NTH_FAILS_H

#include <stdbool.h>

static long nth_fails_left; /* to go, n at first; 0: none fails */

static bool nth_fails(void) {
  return nth_fails_left > 0 && --nth_fails_left == 0;
}

#endif
