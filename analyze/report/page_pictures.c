#include "analyze/report/page_pictures.h"

#include "analyze/report/page_internal.h"
#include "common/log.h"

static void put(json_t *pictures, const char *name, json_t *picture) {
  if (picture != NULL) json_object_set_new(pictures, name, picture);
}

/* The first run's flow in three dimensions, and maps of a plane. */
static enum status add_flow(struct page *page, json_t *pictures) {
  enum status status = STATUS_OK;
  struct particles particles = {0};
  const struct run *run = &page->subject.runs[0];
  json_t *flow = NULL, *plane = NULL;
  const bool driven = page->subject.permeable > 0;
  if (run->dimensions != 3 || !page->subject.snapshots) return STATUS_OK;
  TRY(run_last_snapshot(run, &particles));
  TRY(picture_flow(run, &particles, driven, &flow));
  if (driven) TRY(picture_plane(run, &particles, &page->voxels, &plane));
  page->subject.maps = plane != NULL;
cleanup:
  put(pictures, "flow", flow);
  put(pictures, "plane", plane);
  particles_free(&particles);
  return status;
}

/* A picture that cannot be made is left out with a warning. */
static void put_if(enum status status, json_t *pictures, const char *name, json_t **picture) {
  if (status == STATUS_OK) {
    put(pictures, name, *picture);
    return;
  }
  log_warning("%s; the report goes without that picture", error_message());
  error_clear();
  json_decref(*picture);
}

enum status page_pictures(struct page *page) {
  enum status status = STATUS_OK;
  json_t *pictures = json_object(), *slice = NULL, *frames = NULL, *sizes = NULL;
  json_object_set_new(page->data, "pictures", pictures);
  TRY(add_flow(page, pictures));
  if (page->voxels.solid != NULL)
    put_if(picture_slice(&page->model, &page->voxels, &slice), pictures, "slice", &slice);
  put_if(grain_sizes(&page->voxels, &sizes), page->data, "grain_sizes", &sizes);
  put_if(picture_frames(&page->subject.runs[0], &frames), pictures, "frames", &frames);
  page->subject.maps |= json_object_get(pictures, "frames") != NULL;
cleanup:
  return status;
}
