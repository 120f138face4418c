#include "common/units.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct unit {
  const char *name;
  double factor;
  struct dimension dimension;
};

static const struct unit units[] = {
    {"m", 1, {1, 0, 0}},
    {"km", 1e3, {1, 0, 0}},
    {"cm", 1e-2, {1, 0, 0}},
    {"mm", 1e-3, {1, 0, 0}},
    {"um", 1e-6, {1, 0, 0}},
    {"\xc2\xb5m", 1e-6, {1, 0, 0}},
    {"\xce\xbcm", 1e-6, {1, 0, 0}},
    {"nm", 1e-9, {1, 0, 0}},
    {"kg", 1, {0, 1, 0}},
    {"g", 1e-3, {0, 1, 0}},
    {"mg", 1e-6, {0, 1, 0}},
    {"t", 1e3, {0, 1, 0}},
    {"s", 1, {0, 0, 1}},
    {"ms", 1e-3, {0, 0, 1}},
    {"us", 1e-6, {0, 0, 1}},
    {"ns", 1e-9, {0, 0, 1}},
    {"min", 60, {0, 0, 1}},
    {"h", 3600, {0, 0, 1}},
    {"d", 86400, {0, 0, 1}},
    {"Hz", 1, {0, 0, -1}},
    {"N", 1, {1, 1, -2}},
    {"kN", 1e3, {1, 1, -2}},
    {"Pa", 1, {-1, 1, -2}},
    {"mPa", 1e-3, {-1, 1, -2}},
    {"hPa", 1e2, {-1, 1, -2}},
    {"kPa", 1e3, {-1, 1, -2}},
    {"MPa", 1e6, {-1, 1, -2}},
    {"bar", 1e5, {-1, 1, -2}},
    {"J", 1, {2, 1, -2}},
    {"W", 1, {2, 1, -3}},
    {"L", 1e-3, {3, 0, 0}},
    {"P", 0.1, {-1, 1, -1}},
    {"cP", 1e-3, {-1, 1, -1}},
    {"St", 1e-4, {2, 0, -1}},
    {"cSt", 1e-6, {2, 0, -1}},
    {"%", 1e-2, {0, 0, 0}},
    {"darcy", DARCY, {2, 0, 0}},
    {"mdarcy", 1e-3 * DARCY, {2, 0, 0}},
    {"G", GRAVITY_STANDARD, {1, 0, -2}},
};

static bool dimension_equal(struct dimension a, struct dimension b) {
  return a.m == b.m && a.kg == b.kg && a.s == b.s;
}

void dimension_format(struct dimension dimension, char *text, size_t size) {
  static const struct {
    struct dimension dimension;
    const char *text;
  } known[] = {{{-1, 1, -2}, "Pa"}, {{-1, 1, -1}, "Pa s"}, {{-2, 1, -2}, "Pa/m"}};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++)
    if (dimension_equal(dimension, known[i].dimension)) {
      snprintf(text, size, "%s", known[i].text);
      return;
    }
  const char *names[3] = {"kg", "m", "s"};
  int exponents[3] = {dimension.kg, dimension.m, dimension.s};
  char above[64] = "", below[64] = "";
  for (int i = 0; i < 3; i++) {
    int e = abs(exponents[i]);
    char *part = exponents[i] > 0 ? above : below;
    size_t used = strlen(part);
    if (e == 1) snprintf(part + used, sizeof above - used, "%s%s", used ? " " : "", names[i]);
    if (e > 1) snprintf(part + used, sizeof above - used, "%s%s^%d", used ? " " : "", names[i], e);
  }
  if (!*above && !*below)
    snprintf(text, size, "a plain number");
  else
    snprintf(text, size, "%s%s%s", *above ? above : "1", *below ? "/" : "", below);
}

const char *dimension_example(struct dimension dimension) {
  static const struct {
    struct dimension dimension;
    const char *example;
  } examples[] = {
      /* For voxels, and for heads and domains; quotes are put around the text. */
      {{1, 0, 0}, "5.83um\" or \"0.3 m"},
      {{0, 0, 1}, "0.3 s"},
      {{1, 0, -1}, "1.5 m/s"},
      {{1, 0, -2}, "9.8 m/s^2"},
      {{-3, 1, 0}, "1000 kg/m^3"},
      {{-1, 1, -1}, "1e-3 Pa s"},
      {{-1, 1, -2}, "2 kPa"},
      {{-2, 1, -2}, "9807 Pa/m"},
      {{0, 0, 0}, "0.725"},
      {{2, 0, -1}, "1e-6 m^2/s"},
      {{-1, 0, 0}, "3.35 1/m"},
  };
  for (size_t i = 0; i < sizeof examples / sizeof *examples; i++)
    if (dimension_equal(dimension, examples[i].dimension)) return examples[i].example;
  return "a number with its unit";
}

static bool is_unit_character(unsigned char c) {
  return isalpha(c) || c == '%' || c >= 0x80;
}

/* The middle dot and the superscripts of typeset units, in UTF-8 with c2 as first byte. */
static bool is_middle_dot(const char *c) {
  return !strncmp(c, "\xc2\xb7", 2);
}
static int superscript(const char *c) {
  return !strncmp(c, "\xc2\xb2", 2) ? 2 : !strncmp(c, "\xc2\xb3", 2) ? 3 : 0;
}

/* Multiplies *value and *dimension by the unit expression at `text`: factors separated by spaces,
 * '*' or the middle dot, with powers ("^2", "^-1", "2"). '/' inverts the next factor, or all
 * factors in the parentheses that follow. Returns false and sets *bad to the offending word on
 * failure. */
static bool parse_units(const char *text, double *value, struct dimension *dimension, char *bad,
                        size_t bad_size) {
  int sign = 1, group = 1; /* group: sign of the exponents within parentheses */
  bool open = false;
  while (*text) {
    if (isspace((unsigned char)*text) || *text == '*') {
      text++;
      continue;
    }
    if (is_middle_dot(text)) {
      text += 2;
      continue;
    }
    if (text[0] == '1' && text[1] == '/') { /* "1/m", a common way to write units */
      text++;
      continue;
    }
    if (*text == '/') {
      sign = -group;
      text++;
      continue;
    }
    if (*text == (open ? ')' : '(') && !(open && sign != group)) {
      group = open ? 1 : sign;
      sign = group;
      open = !open;
      text++;
      continue;
    }
    size_t n = 0;
    while (is_unit_character((unsigned char)text[n]) && !is_middle_dot(text + n) &&
           !superscript(text + n))
      n++;
    const struct unit *unit = NULL;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
      if (strlen(units[i].name) == n && !strncmp(units[i].name, text, n)) unit = &units[i];
    if (n == 0 || unit == NULL) {
      if (n == 0) n = strlen(text);
      snprintf(bad, bad_size, "%.*s", (int)(n < bad_size ? n : bad_size - 1), text);
      return false;
    }
    text += n;
    long power = 1;
    if (superscript(text)) {
      power = superscript(text);
      text += 2;
    } else {
      if (*text == '^') text++;
      if (isdigit((unsigned char)*text) || (*text == '-' && isdigit((unsigned char)text[1]))) {
        char *end;
        power = strtol(text, &end, 10);
        text = end;
      }
      if (labs(power) > 9) {
        snprintf(bad, bad_size, "%s^%ld", unit->name, power);
        return false;
      }
    }
    int p = sign * (int)power;
    *value *= pow(unit->factor, p);
    dimension->m += p * unit->dimension.m;
    dimension->kg += p * unit->dimension.kg;
    dimension->s += p * unit->dimension.s;
    sign = group;
  }
  if (sign != 1 || open) {
    snprintf(bad, bad_size, open ? "(" : "/");
    return false;
  }
  return true;
}

enum status quantity_parse(const char *text, struct dimension expected, double *value) {
  char wanted[64], has[64], bad[64];
  dimension_format(expected, wanted, sizeof wanted);
  const char *example = dimension_example(expected);
  while (isspace((unsigned char)*text)) text++;
  char *end;
  double number = strtod(text, &end);
  if (end == text || !(isdigit((unsigned char)*text) || strchr("+-.", *text)))
    return FAIL(STATUS_INPUT, "'%s' is no number; write it like \"%s\"", text, example);
  if (!isfinite(number)) return FAIL(STATUS_INPUT, "'%s' is not finite", text);
  if (*end == ',' && isdigit((unsigned char)end[1]))
    return FAIL(STATUS_INPUT, "'%s': a decimal comma; numbers take a point, like \"%s\"", text,
                example);
  const char *unit = end;
  while (isspace((unsigned char)*unit)) unit++;
  if (*unit == '\0') {
    if (number != 0 && !dimension_equal(expected, DIM_NONE))
      return FAIL(STATUS_INPUT, "'%s' has no unit; write it like \"%s\"", text, example);
    *value = number;
    return STATUS_OK;
  }
  struct dimension dimension = DIM_NONE;
  if (!parse_units(unit, &number, &dimension, bad, sizeof bad))
    return FAIL(STATUS_INPUT, "'%s': unknown unit '%s'; write it like \"%s\"", text, bad, example);
  if (!dimension_equal(dimension, expected)) {
    dimension_format(dimension, has, sizeof has);
    return FAIL(STATUS_INPUT, "'%s' is in %s, but %s is wanted, like \"%s\"", text, has, wanted,
                example);
  }
  if (!isfinite(number)) return FAIL(STATUS_INPUT, "'%s' is not finite", text);
  *value = number;
  return STATUS_OK;
}

void quantity_format(double value, const char *base_unit, char *text, size_t size) {
  static const char *const prefixes[] = {"n", "u", "m", "", "k", "M", "G"};
  int p = 3;
  double shown = value;
  if (value != 0 && isfinite(value)) {
    while (fabs(shown) >= 1000 && p < 6) shown /= 1000, p++;
    while (fabs(shown) < 0.9999999 && p > 0) shown *= 1000, p--;
  }
  /* Kiloseconds are not used. */
  if (p > 3 && !strcmp(base_unit, "s")) shown = value, p = 3;
  snprintf(text, size, "%.4g %s%s", shown, prefixes[p], base_unit);
}

void duration_format(double seconds, char *text, size_t size) {
  if (!isfinite(seconds))
    snprintf(text, size, "unknown");
  else if (seconds < 1)
    snprintf(text, size, "under 1 s");
  else if (seconds < 120)
    snprintf(text, size, "%.0f s", seconds);
  else if (seconds < 7200)
    snprintf(text, size, "%.0f min", seconds / 60);
  else
    snprintf(text, size, "%.1f h", seconds / 3600);
}

const char *percent_format(double share, char text[32]) {
  snprintf(text, 32, fabs(share) < 0.995 ? "%.2g" : "%.0f", 100.0 * share);
  return text;
}
