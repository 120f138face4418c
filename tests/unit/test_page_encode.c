/* What goes into a page cannot become markup, and pictures come out of it as they went in. */
#include "analyze/plot.h"
#include "analyze/product.h"
#include "common/page_encode.h"
#include "common/text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include <math.h>

static char *text;
static size_t size;

static FILE *open_text(void) {
  free(text);
  text = NULL;
  return open_memstream(&text, &size);
}

static void test_scripts_cannot_end(void **state) {
  (void)state;
  static const char script[] = "a='</SCRIPT>';b<c;'<!--'";
  FILE *stream = open_text();
  encode_script(stream, script, strlen(script));
  fclose(stream);
  assert_string_equal(text, "a='<\\/SCRIPT>';b<c;'<\\!--'");
  stream = open_text();
  encode_json(stream, "{\"a\":\"</script>\"}");
  fclose(stream);
  assert_string_equal(text, "{\"a\":\"\\u003c/script>\"}");
}

static void test_base64(void **state) {
  (void)state;
  static const char *const cases[][2] = {{"", ""},
                                         {"f", "Zg=="},
                                         {"fo", "Zm8="},
                                         {"foo", "Zm9v"},
                                         {"foobar", "Zm9vYmFy"}}; /* RFC 4648 */
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    json_t *value = encode_bytes(cases[i][0], strlen(cases[i][0]));
    assert_string_equal(json_string_value(value), cases[i][1]);
    json_decref(value);
  }
}

static const char *written(void (*write)(FILE *, const char *), const char *what) {
  FILE *stream = open_text();
  write(stream, what);
  fclose(stream);
  return text;
}

/* Names that act where they stand: in gnuplot, in a spreadsheet, on a terminal. */
static void test_names_do_nothing(void **state) {
  (void)state;
  assert_string_equal(written(plot_text, "'s-Hertogenbosch \"\\n`ls`"),
                      "\"'s-Hertogenbosch \\\"\\\\n ls \"");
  assert_string_equal(written(csv_text, "=1+1"), "'=1+1");
  assert_string_equal(written(csv_text, "@SUM(a,b)"), "\"'@SUM(a,b)\"");
  assert_string_equal(written(csv_text, "sand, \"dense\""), "\"sand, \"\"dense\"\"\"");
  assert_string_equal(written(csv_text, "1+1"), "1+1");
  char name[] = "\x1b[1m a\xc2\x9b"
                "31m \xe2\x80\xae"
                "b \xff \xc2\xb5m \xe5\xbb\xba\n";
  assert_false(text_is_plain(name));
  text_make_plain(name);
  assert_string_equal(name, "?[1m a?31m ?b ? \xc2\xb5m \xe5\xbb\xba?");
  assert_true(text_is_plain("'s-Hertogenbosch \xc2\xb5m \xe5\xbb\xba"));
}

/* 0 at `low`, 254 at `high`, held between them, 255 for NAN. */
static void test_fields(void **state) {
  (void)state;
  static const float values[] = {-2.0f, 0.0f, 2.0f, 9.0f, -9.0f, NAN};
  json_t *field = encode_field(values, 6, -2.0, 2.0);
  assert_string_equal(json_string_value(json_object_get(field, "bytes")), "AH/+/gD/");
  assert_float_equal(json_number_value(json_object_get(field, "low")), -2.0, 0.0);
  json_decref(field);
  static const float shares[] = {0.0f, 1.0f, 0.4f};
  json_t *nibbles = encode_nibbles(shares, 3); /* f0 06 */
  assert_string_equal(json_string_value(nibbles), "8AY=");
  json_decref(nibbles);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_scripts_cannot_end),
                                     cmocka_unit_test(test_names_do_nothing),
                                     cmocka_unit_test(test_base64), cmocka_unit_test(test_fields)};
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  free(text);
  return failed;
}
