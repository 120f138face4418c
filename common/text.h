/* Texts of others, shown as what they are: one line, in the order in which it is written; and
 * numbers that are none. */
#ifndef TOSUI_COMMON_TEXT_H
#define TOSUI_COMMON_TEXT_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Length of the well-formed UTF-8 sequence at `at`, and its code point; 0 if there is none. */
int text_character(const char *at, uint32_t *code);
/* Whether a code point is not shown but acts: control characters (also those of 8 bits, which steer
 * terminals), ends of lines, overrides of the direction, and what takes no room. */
bool text_is_hidden(uint32_t code);
/* Whether a text is UTF-8 without such characters. */
bool text_is_plain(const char *text);
/* Puts '?' for such characters and for bytes that are no UTF-8, in place. */
void text_make_plain(char *text);
/* A number to be printed: one that is none has one spelling, `nan`, whatever its sign. */
static inline double text_number(double value) {
  return isnan(value) ? NAN : value;
}

#endif
