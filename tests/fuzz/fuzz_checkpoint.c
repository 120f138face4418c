/* libFuzzer: edits of the checkpoint of a small wcsph run, under a seal that holds. */
#include <string.h>

#include "common/provenance.h"
#include "fuzz_edits.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/wcsph/plan.h"
#include "sphsolve/wcsph/state.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/output/recorder.h"
#include "sphsolve/scene/scene_read.h"

static const char text[] =
    "scene = { method = \"wcsph\"; end_time = \"1 s\"; };\n"
    "domain = { size = [\"8 cm\", \"8 cm\"]; spacing = \"1 cm\"; periodic = [true, false]; };\n"
    "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1 Pa s\"; } );\n"
    "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"8 cm\", \"8 cm\"]; } );\n"
    "force = { body_acceleration = [\"1 mm/s^2\", \"0\"]; };\n";

static struct scene scene;
static struct lattice lattice;
static struct plan plan;
static struct engine_settings settings;
static double region_velocity[2][3];
static size_t held;

static void start(void) {
  const char *path = fuzz_file(".cfg", (const uint8_t *)text, sizeof text - 1);
  if (scene_read(path, NULL, 0, &scene) != STATUS_OK ||
      lattice_build(&scene, plan_wall_layers(&scene), &lattice) != STATUS_OK ||
      plan_make(&scene, &lattice, &method_wcsph, "", 1, &plan) != STATUS_OK) {
    fprintf(stderr, "%s\n", error_message());
    abort();
  }
  unlink(path);
  if (wcsph_settings(&scene, &plan, region_velocity, &settings) != STATUS_OK) abort();
  held = memory_in_use();
}

static void resume(const char *prefix) {
  struct recorder *recorder = NULL;
  struct h5_file *file = NULL;
  struct wcsph_state state = {0};
  if (engine_make(&lattice, &settings, &state.engine) != STATUS_OK) abort();
  if (recorder_open(prefix, &scene, &plan, &lattice, "fuzz", true, &recorder) == STATUS_OK &&
      recorder_resume(recorder, &file) == STATUS_OK && file != NULL)
    (void)wcsph_read_state(file, &state);
  h5_close(file);
  recorder_close(recorder);
  monitor_free(&state.monitor);
  engine_free(&state.engine);
}

/* The checkpoint that the scene's run would write at its start. */
static void make_base(struct edit_base *base) {
  struct recorder *recorder = NULL;
  struct h5_file *file = NULL;
  struct wcsph_state state = {0};
  double row[MONITOR_COMPONENTS] = {1};
  const struct history_row history = {.time = 1, .step = 1};
  char prefix[96], path[128];
  snprintf(prefix, sizeof prefix, "%.*s", 80, fuzz_file("-base", (const uint8_t *)"", 0));
  unlink(prefix);
  if (engine_make(&lattice, &settings, &state.engine) != STATUS_OK ||
      monitor_add(&state.monitor, row) != STATUS_OK ||
      recorder_open(prefix, &scene, &plan, &lattice, "fuzz", false, &recorder) != STATUS_OK ||
      recorder_row(recorder, &history, NULL) != STATUS_OK ||
      recorder_checkpoint_begin(recorder, &file) != STATUS_OK ||
      wcsph_write_state(&state, file) != STATUS_OK ||
      recorder_checkpoint_commit(recorder, file) != STATUS_OK) {
    fprintf(stderr, "%s\n", error_message());
    abort();
  }
  recorder_close(recorder);
  monitor_free(&state.monitor);
  engine_free(&state.engine);
  snprintf(path, sizeof path, "%s.ckpt.hdf", prefix);
  edit_base_read(path, 16, base);
  unlink(path);
  snprintf(path, sizeof path, "%s.history.csv", prefix);
  unlink(path);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const char ending[] = ".ckpt.hdf";
  static struct edit_base base;
  char prefix[96];
  uint64_t hash;
  if (base.size == 0) {
    start();
    make_base(&base);
  }
  const char *path = edit_file(&base, ending, data, size);
  if (hash_file(path, &hash) != STATUS_OK) abort();
  FILE *file = fopen(path, "ab");
  if (file == NULL || fwrite("TOSUICK1", 8, 1, file) != 1 || fwrite(&hash, 8, 1, file) != 1 ||
      fclose(file) != 0)
    abort();
  snprintf(prefix, sizeof prefix, "%.*s", (int)(strlen(path) - strlen(ending)), path);
  resume(prefix);
  return fuzz_end(path, held);
}
