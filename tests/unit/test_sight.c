/* Walls between particles: nothing passes through thin ones, nor where they touch. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "tests/unit/isph_scene.h"

/* Soil between two heads, and the walls across it. */
static void begin_between_heads(struct run *run, const char *walls) {
  char text[2048];
  snprintf(
      text, sizeof text,
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"0.4 m\", \"0.2 m\"]; spacing = \"1 cm\"; periodic = [false, "
      "false]; };\n"
      "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.4 m\", \"0.2 m\"]; porosity "
      "= 0.4; permeability = \"1e-4 m/s\"; },\n"
      "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 mm\", \"0.2 m\"]; head = \"0.5 m\"; },\n"
      "{ type = \"inflow\"; box = [\"399 mm\", \"0\", \"0.4 m\", \"0.2 m\"]; head = \"0.4 m\"; "
      "},\n%s );\n"
      "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
      walls);
  start(run, text);
}

#define BOX(a, b, c, d)                                                                            \
  "{ type = \"wall\"; box = [\"" #a " mm\", \"" #b " mm\", \"" #c " mm\", \"" #d " mm\"]; }"
#define CORNERS(c) "{ type = \"wall\"; corners = [" c "]; }"

/* Two boxes that meet at their corners; two triangles tip to tip; two diamonds between the sides;
 * plates of a fifth of a spacing, upright, with a bend, and at a slope; plates before a window, and
 * with a face on a row of particles. */
static void walls_let_nothing_through(void **state) {
  (void)state;
  static const char *const walls[] = {
      BOX(150, 0, 200, 100) ", " BOX(200, 100, 250, 200),
      CORNERS("\"12 cm\", \"0\", \"28 cm\", \"0\", \"20 cm\", \"10 cm\"") ", " CORNERS(
          "\"12 cm\", \"20 cm\", \"28 cm\", \"20 cm\", \"20 cm\", \"10 cm\""),
      CORNERS("\"20 cm\", \"0\", \"25 cm\", \"5 cm\", \"20 cm\", \"10 cm\", \"15 cm\", \"5 "
              "cm\"") ", " CORNERS("\"20 cm\", \"10 cm\", \"25 cm\", \"15 cm\", \"20 cm\", \"20 "
                                   "cm\", \"15 cm\", \"15 cm\""),
      BOX(194, 0, 196, 200),
      BOX(190, 0, 192, 100) ", " BOX(192, 100, 300, 102) ", " BOX(300, 100, 302, 200),
      CORNERS("\"10 cm\", \"0\", \"10.2 cm\", \"0\", \"30.2 cm\", \"20 cm\", \"30 cm\", \"20 cm\""),
      BOX(11, 0, 12, 200),
      BOX(185, 0, 186, 200)};
  const double open = 1e-4 * 0.1 / 0.4 * 0.2 * 0.01;
  for (size_t n = 0; n < sizeof walls / sizeof *walls; n++) {
    struct run run;
    begin_between_heads(&run, walls[n]);
    advance(&run, 0.3);
    print_message("%zu: %.1e of what would pass\n", n, flux_at(&run.s, 0.05) / open);
    assert_true(fabs(flux_at(&run.s, 0.05)) < 1e-4 * open);
    finish(&run);
  }
}

/* A wall of two spacings between two ponds over soil, in which the support is wider. */
static void walls_part_tight_soil(void **state) {
  (void)state;
  struct run run;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"1 m\", \"0.6 m\"]; spacing = \"2 cm\"; periodic = [false, false]; "
        "};\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"1 m\", \"0.2 m\"]; porosity = "
        "0.2; permeability = \"1e-2 m/s\"; },\n"
        "{ type = \"water\"; box = [\"0\", \"0\", \"0.5 m\", \"0.5 m\"]; },\n"
        "{ type = \"water\"; box = [\"0.5 m\", \"0\", \"1 m\", \"0.4 m\"]; },\n" BOX(
            480, 0, 520, 600) " );\n"
                              "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  advance(&run, 0.5);
  double fastest = 0;
  for (size_t i = 0; i < run.s.count; i++)
    for (int a = 0; a < 3; a++) fastest = fmax(fastest, fabs(run.s.velocity[i][a]));
  print_message("fastest %g m/s\n", fastest);
  assert_true(fastest < 1e-5);
  finish(&run);
}

/* Sum of the slopes of i with j and its images. */
static double slopes(const struct isph *s, size_t i, size_t j) {
  size_t c = 0;
  double sum = 0;
  while (i >= s->chunks[c].end) c++;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++)
    if ((s->chunks[c].pair[p] & PAIR_MASK) == j) sum += (double)s->chunks[c].slope[p];
  return sum;
}

static void assert_symmetric(const struct isph *s) {
  size_t hidden = 0;
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
      for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
        const size_t j = s->chunks[c].pair[p] & PAIR_MASK;
        assert_true(fabs(slopes(s, i, j) - slopes(s, j, i)) <= 1e-6 * slopes(s, i, j));
        hidden += s->chunks[c].slope[p] == 0;
      }
  print_message("%zu hidden\n", hidden);
  assert_true(hidden > 0);
}

/* A pair is hidden from both of its particles or from neither, across sides too: a plate on the
 * floor, and one at a periodic side. */
static void both_or_neither(void **state) {
  (void)state;
  static const char *const texts[] = {
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"0.4 m\", \"0.3 m\"]; spacing = \"1 cm\"; periodic = [false, false]; "
      "};\n"
      "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.3 m\"]; },\n"
      "{ type = \"porous\"; box = [\"0.12 m\", \"0\", \"0.31 m\", \"0.1 m\"]; porosity = 0.2; "
      "permeability = \"1e-3 m/s\"; },\n" BOX(
          230, 0, 319.8, 9.5) " );\n"
                              "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n",
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"0.4 m\", \"0.2 m\"]; spacing = \"1 cm\"; periodic = [true, false]; };\n"
      "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"0.4 m\", \"0.2 m\"]; porosity = "
      "0.3; permeability = \"1e-3 m/s\"; },\n" BOX(
          0, 0, 0.5, 100) " );\n"
                          "force = { body_acceleration = [\"1 m/s^2\", \"0\"]; };\n"};
  struct run run;
  begin_between_heads(&run, BOX(190, 0, 195, 110) ", " BOX(230, 87, 250, 200) ", " CORNERS(
                                "\"30 cm\", \"3 cm\", \"33 cm\", \"9 cm\", \"29 cm\", \"12 cm\""));
  advance(&run, 0.3);
  assert_symmetric(&run.s);
  finish(&run);
  for (int n = 0; n < 2; n++) {
    start(&run, texts[n]);
    advance(&run, 0.1);
    assert_symmetric(&run.s);
    finish(&run);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(walls_let_nothing_through),
      cmocka_unit_test(walls_part_tight_soil),
      cmocka_unit_test(both_or_neither),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
