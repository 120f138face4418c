#include "ct2model/scanner/grain_windows.h"

#include <string.h>

#include "common/memory.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/edge_response.h"
#include "ct2model/scanner/restore.h"

enum status grain_window(const struct window *window, const double stretch[3],
                         const struct deblur_scanner *scanner, struct deblur *deblur,
                         float *distance) {
  enum status status = STATUS_OK;
  memcpy(deblur->size, window->size, sizeof deblur->size);
  memcpy(deblur->grey, window->grey, window_voxels(window) * sizeof *window->grey);
  deblur->scanner = *scanner;
  deblur->iterations = ITERATIONS_COMPARED;
  deblur->compared = true;
  TRY(deblur_run(deblur));
  TRY(edge_distances(deblur->share, window->size, stretch, WALL_RANGE, distance));
cleanup:
  return status;
}

enum status grain_windows(const struct windows *scan, const struct scanner *scanner,
                          struct windows *grains) {
  enum status status = STATUS_OK;
  struct deblur deblur = {0};
  struct deblur_scanner work;
  *grains = *scan;
  grains->count = 0;
  /* All windows have one size. */
  restore_scanner(scan->region, scanner, scanner->blur, &work);
  TRY(deblur_start(window_voxels(&scan->window[0]), &work, &deblur));
  for (size_t i = 0; i < scan->count; i += windows_step(scan)) {
    struct window *w = &grains->window[grains->count++];
    *w = (struct window){0};
    memcpy(w->size, scan->window[i].size, sizeof w->size);
    TRY(memory_allocate(&w->distance, window_voxels(w), sizeof(float), "a window of the scan"));
    TRY(grain_window(&scan->window[i], scan->stretch, &work, &deblur, w->distance));
  }
cleanup:
  deblur_end(&deblur);
  return status;
}
