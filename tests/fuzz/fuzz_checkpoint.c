/* libFuzzer: any bytes, under a seal that holds, as the checkpoint of a small wcsph run. */
#include <string.h>

#include "common/provenance.h"
#include "fuzz_hdf5.h"
#include "sphsolve/lattice.h"
#include "sphsolve/methods/wcsph_plan.h"
#include "sphsolve/methods/wcsph_state.h"
#include "sphsolve/plan.h"
#include "sphsolve/recorder.h"
#include "sphsolve/scene.h"

static const char text[] =
    "scene = { method = \"wcsph\"; end_time = \"1 s\"; };\n"
    "domain = { size = [\"8 cm\", \"8 cm\"]; spacing = \"1 cm\"; periodic = [true, false]; };\n"
    "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1 Pa s\"; } );\n"
    "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"8 cm\", \"8 cm\"]; } );\n"
    "force = { body_acceleration = [\"1 mm/s^2\", \"0\"]; };\n";

static struct scene scene;
static struct lattice lattice;
static struct plan plan;
static size_t held;

static void start(void) {
  const char *path = fuzz_file(".cfg", (const uint8_t *)text, sizeof text - 1);
  if (scene_read(path, NULL, 0, &scene) != STATUS_OK ||
      lattice_build(&scene, plan_wall_layers(&scene), &lattice) != STATUS_OK ||
      plan_make(&scene, &lattice, METHOD_WCSPH, "", 1, &plan) != STATUS_OK) {
    fprintf(stderr, "%s\n", error_message());
    abort();
  }
  unlink(path);
  held = memory_in_use();
}

static void resume(const char *prefix) {
  struct recorder *recorder = NULL;
  struct h5_file *file = NULL;
  struct wcsph_state state = {0};
  struct engine_settings settings;
  double region_velocity[2][3] = {{0}};
  wcsph_settings(&scene, &plan, region_velocity, &settings);
  if (engine_make(&lattice, &settings, &state.engine) != STATUS_OK) abort();
  if (recorder_open(prefix, &scene, &plan, &lattice, "fuzz", true, &recorder) == STATUS_OK &&
      recorder_resume(recorder, &file) == STATUS_OK && file != NULL)
    (void)wcsph_read_state(file, &state);
  h5_close(file);
  recorder_close(recorder);
  monitor_free(&state.monitor);
  engine_free(&state.engine);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const char ending[] = ".ckpt.hdf";
  char prefix[96];
  if (held == 0) start();
  uint8_t *sealed = malloc(size + 16);
  uint64_t hash = hash_bytes(data, size);
  if (sealed == NULL) abort();
  if (size > 0) memcpy(sealed, data, size);
  memcpy(sealed + size, "TOSUICK1", 8);
  memcpy(sealed + size + 8, &hash, 8);
  const char *path = fuzz_file(ending, sealed, size + 16);
  free(sealed);
  snprintf(prefix, sizeof prefix, "%.*s", (int)(strlen(path) - strlen(ending)), path);
  resume(prefix);
  return fuzz_end(path, held);
}
