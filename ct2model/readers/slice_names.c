#include "ct2model/readers/slice_names.h"

#include <ctype.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

const char *base_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash != NULL ? slash + 1 : path;
}

static bool is_digit(char c) {
  return isdigit((unsigned char)c) != 0;
}

/* The last number of a name, before its ending: "12" of "a_12.tif", "0.25" of "a0.25.tif". */
struct last_number {
  const char *start, *whole_end; /* digits before the point */
  const char *fraction, *end;    /* digits after it; NULL if there is none */
  bool minus, plus;              /* a sign before it, which follows no digit */
};

static bool find_last(const char *path, struct last_number *last) {
  const char *name = base_name(path), *dot = strrchr(name, '.');
  const char *end = dot != NULL && !is_digit(dot[1]) ? dot : name + strlen(name);
  while (end > name && !is_digit(end[-1])) end--;
  const char *start = end;
  while (start > name && is_digit(start[-1])) start--;
  if (start == end) return false;
  *last = (struct last_number){.start = start, .whole_end = end, .end = end};
  if (start > name + 1 && start[-1] == '.' && is_digit(start[-2])) {
    const char *whole = start - 1;
    while (whole > name && is_digit(whole[-1])) whole--;
    if (whole == name || whole[-1] != '.') /* 1.2.840 counts chapters */
      *last = (struct last_number){whole, start - 1, start, end, false, false};
  }
  const char *sign = last->start - 1;
  if (sign >= name && (sign == name || !is_digit(sign[-1]))) {
    last->minus = *sign == '-';
    last->plus = *sign == '+';
  }
  return true;
}

/* The number of letters before a number and its sign. */
static size_t letters_before(const char *name, const struct last_number *last) {
  return (size_t)(last->start - name) - (last->minus || last->plus);
}

struct name_order name_order_find(char *const *names, size_t count) {
  struct name_order order = {false, false, 0};
  const char *prefix = NULL; /* of the first name with a '-' before its number */
  size_t length = 0, points = 0, least = SIZE_MAX, most = 0;
  bool all = true, ends_in_zero = false;
  struct last_number last;
  for (size_t i = 0; i < count; i++) {
    if (!find_last(names[i], &last)) {
      all = false;
      continue;
    }
    if (last.minus && prefix == NULL) {
      prefix = names[i];
      length = letters_before(names[i], &last);
    }
    if (last.fraction == NULL) continue;
    const size_t digits = (size_t)(last.end - last.fraction);
    points++;
    if (digits < least) least = digits;
    if (digits > most) most = digits;
    ends_in_zero |= digits > 1 && last.end[-1] == '0';
  }
  /* Chapters "1.9", "1.10" end in a zero sooner or later; fractions are all of one length, or
   * written without zeros at their end. */
  order.fractions = all && points > 0 && (!ends_in_zero || (least == most && points == count));
  order.digits = order.fractions ? most : 0;
  for (size_t i = 0; i < count && prefix != NULL && !order.is_signed; i++)
    order.is_signed = find_last(names[i], &last) && !last.minus &&
                      letters_before(names[i], &last) == length &&
                      strncmp(names[i], prefix, length) == 0;
  return order;
}

/* Compares digits a, of `na`, and b as whole numbers. */
static int compare_whole(const char *a, size_t na, const char *b, size_t nb) {
  while (na > 0 && *a == '0') a++, na--;
  while (nb > 0 && *b == '0') b++, nb--;
  if (na != nb) return na < nb ? -1 : 1;
  return strncmp(a, b, na);
}

static int compare_fractions(const char *a, size_t na, const char *b, size_t nb) {
  for (size_t i = 0; i < na || i < nb; i++) {
    const char digit_a = i < na ? a[i] : '0', digit_b = i < nb ? b[i] : '0';
    if (digit_a != digit_b) return digit_a < digit_b ? -1 : 1;
  }
  return 0;
}

/* Compares the last numbers of both names. */
static int compare_last(const struct last_number *a, const struct last_number *b,
                        const struct name_order *order) {
  const bool minus_a = order->is_signed && a->minus, minus_b = order->is_signed && b->minus;
  if (minus_a != minus_b) return minus_a ? -1 : 1;
  int sign = compare_whole(a->start, (size_t)(a->whole_end - a->start), b->start,
                           (size_t)(b->whole_end - b->start));
  if (sign == 0)
    sign = compare_fractions(a->fraction, a->fraction ? (size_t)(a->end - a->fraction) : 0,
                             b->fraction, b->fraction ? (size_t)(b->end - b->fraction) : 0);
  return minus_a ? -sign : sign;
}

/* Where the ending of a name begins, all of its words: ".ome.tif" of "a.ome.tif". */
static const char *ending_of(const char *path) {
  const char *name = base_name(path), *at = name + strlen(name), *ending = at;
  while (at > name && (isalpha((unsigned char)at[-1]) || at[-1] == '.'))
    if (*--at == '.') ending = at;
  return ending;
}

int natural_compare(const char *a, const char *b) {
  const char *const a_start = a, *const b_start = b;
  const char *const a_end = ending_of(a), *const b_end = ending_of(b);
  while (*a != '\0' && *b != '\0') {
    if (is_digit(*a) && is_digit(*b)) {
      const size_t na = strspn(a, "0123456789"), nb = strspn(b, "0123456789");
      const int order = compare_whole(a, na, b, nb);
      if (order != 0) return order;
      a += na;
      b += nb;
    } else {
      if (*a != *b && (a == a_end || b == b_end)) return a == a_end ? -1 : 1; /* a, a-1 */
      if (*a != *b) return (unsigned char)*a < (unsigned char)*b ? -1 : 1;
      a++;
      b++;
    }
  }
  if (*a != *b) return *a == '\0' ? -1 : 1;
  return strcmp(a_start, b_start); /* slice_1 and slice_01: in a fixed order */
}

int name_compare(const char *a, const char *b, const struct name_order *order) {
  struct last_number last[2];
  if ((order->is_signed || order->fractions) && find_last(a, &last[0]) && find_last(b, &last[1])) {
    const size_t n[2] = {
        order->is_signed ? letters_before(a, &last[0]) : (size_t)(last[0].start - a),
        order->is_signed ? letters_before(b, &last[1]) : (size_t)(last[1].start - b)};
    /* Names that begin alike differ in the last number. */
    if (n[0] == n[1] && strncmp(a, b, n[0]) == 0) {
      const int sign = compare_last(&last[0], &last[1], order);
      if (sign != 0) return sign;
    }
  }
  return natural_compare(a, b);
}

bool name_number(const char *path, const struct name_order *order, long long *number) {
  struct last_number last;
  if (!find_last(path, &last)) return false;
  const char *start = last.fraction != NULL && !order->fractions ? last.fraction : last.start;
  const char *whole_end = last.fraction != NULL && !order->fractions ? last.end : last.whole_end;
  if ((size_t)(whole_end - start) + order->digits > 17) return false;
  *number = 0;
  for (const char *c = start; c < whole_end; c++) *number = 10 * *number + (*c - '0');
  for (size_t i = 0; i < order->digits; i++) {
    const bool there = last.fraction != NULL && last.fraction + i < last.end;
    *number = 10 * *number + (there ? last.fraction[i] - '0' : 0);
  }
  if (order->is_signed && last.minus) *number = -*number;
  return true;
}
