/* What goes into a page cannot become markup. */
#include "analyze/report/page_html.h"
#include "analyze/plot.h"
#include "analyze/product.h"
#include "common/text.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static char *text;
static size_t size;

static FILE *open_text(void) {
  free(text);
  text = NULL;
  return open_memstream(&text, &size);
}

static void test_text_is_escaped(void **state) {
  (void)state;
  FILE *stream = open_text();
  html_text(stream, "<b a=\"1\" c='2'>&\x01 \xc2\xb5m \xff\xc0\x80 \xed\xa0\x80");
  fclose(stream);
  assert_string_equal(text,
                      "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp; \xc2\xb5m "
                      "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd \xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");
}

static void test_scripts_cannot_end(void **state) {
  (void)state;
  static const char script[] = "a='</SCRIPT>';b<c;'<!--'";
  FILE *stream = open_text();
  html_script(stream, script, strlen(script));
  fclose(stream);
  assert_string_equal(text, "a='<\\/SCRIPT>';b<c;'<\\!--'");
  stream = open_text();
  html_json(stream, "{\"a\":\"</script>\"}");
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
    FILE *stream = open_text();
    html_base64(stream, cases[i][0], strlen(cases[i][0]));
    fclose(stream);
    assert_string_equal(text, cases[i][1]);
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
  assert_string_equal(written(html_text, "a\xc2\x9b"
                                         "31m\xe2\x80\xae"
                                         "b"),
                      "a31mb");
  char name[] = "\x1b[1m a\xc2\x9b"
                "31m \xe2\x80\xae"
                "b \xff \xc2\xb5m \xe5\xbb\xba\n";
  assert_false(text_is_plain(name));
  text_make_plain(name);
  assert_string_equal(name, "?[1m a?31m ?b ? \xc2\xb5m \xe5\xbb\xba?");
  assert_true(text_is_plain("'s-Hertogenbosch \xc2\xb5m \xe5\xbb\xba"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_text_is_escaped), cmocka_unit_test(test_names_do_nothing),
      cmocka_unit_test(test_scripts_cannot_end), cmocka_unit_test(test_base64)};
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  free(text);
  return failed;
}
