#include "common/balance.h"

#ifdef TOSUI_MPI
#include <stdio.h>
#include <zoltan.h>

#include "common/memory.h"
#include "common/ranks.h"

struct row {
  size_t first, own;
  const double *work;
};

static int count_items(void *data, int *error) {
  *error = ZOLTAN_OK;
  return (int)((const struct row *)data)->own;
}

static void list_items(void *data, int global_size, int local_size, ZOLTAN_ID_PTR global,
                       ZOLTAN_ID_PTR local, int weights, float *weight, int *error) {
  const struct row *row = data;
  (void)global_size, (void)local_size, (void)weights;
  for (size_t i = 0; i < row->own; i++) {
    global[i] = (ZOLTAN_ID_TYPE)(row->first + i);
    local[i] = (ZOLTAN_ID_TYPE)i;
    weight[i] = (float)row->work[i];
  }
  *error = ZOLTAN_OK;
}

static int count_axes(void *data, int *error) {
  (void)data;
  *error = ZOLTAN_OK;
  return 1;
}

static void place_items(void *data, int global_size, int local_size, int count,
                        ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int axes, double *place,
                        int *error) {
  (void)data, (void)global_size, (void)local_size, (void)local, (void)axes;
  for (int i = 0; i < count; i++) place[i] = (double)global[i];
  *error = ZOLTAN_OK;
}

enum status balance_partition(size_t items, size_t first, size_t own, const double *work,
                              size_t *partition) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count();
  struct row row = {first, own, work};
  struct Zoltan_Struct *zoltan = NULL;
  ZOLTAN_ID_PTR global_in = NULL, local_in = NULL, global = NULL, local = NULL;
  int *rank_in = NULL, *part_in = NULL, *rank = NULL, *part = NULL;
  int changed, global_size, local_size, in, out = 0;
  double *count = NULL;
  float version;
  if (Zoltan_Initialize(0, NULL, &version) == ZOLTAN_OK) zoltan = Zoltan_Create(MPI_COMM_WORLD);
  /* Without REMAP the parts keep their order along the row. Only items that change rank are listed:
   * when asked for all of them, Zoltan 13.2 reports a lack of memory on ranks without items if
   * nothing moves. */
  static const char *const settings[][2] = {{"DEBUG_LEVEL", "0"},    {"LB_METHOD", "RCB"},
                                            {"OBJ_WEIGHT_DIM", "1"}, {"RETURN_LISTS", "EXPORT"},
                                            {"REMAP", "0"},          {"IMBALANCE_TOL", "1.0001"}};
  for (size_t k = 0; zoltan != NULL && k < sizeof settings / sizeof *settings; k++)
    Zoltan_Set_Param(zoltan, settings[k][0], settings[k][1]);
  if (zoltan == NULL || Zoltan_Set_Num_Obj_Fn(zoltan, count_items, &row) != ZOLTAN_OK ||
      Zoltan_Set_Obj_List_Fn(zoltan, list_items, &row) != ZOLTAN_OK ||
      Zoltan_Set_Num_Geom_Fn(zoltan, count_axes, &row) != ZOLTAN_OK ||
      Zoltan_Set_Geom_Multi_Fn(zoltan, place_items, &row) != ZOLTAN_OK ||
      Zoltan_LB_Partition(zoltan, &changed, &global_size, &local_size, &in, &global_in, &local_in,
                          &rank_in, &part_in, &out, &global, &local, &rank,
                          &part) < 0) /* ZOLTAN_WARN: items too coarse for an even balance */
    status = FAIL(STATUS_RUN, "Zoltan fails to share the work out among %zu ranks", ranks);
  TRY(ranks_agree(status));
  TRY(memory_allocate(&count, ranks, sizeof *count, "shares of the ranks"));
  count[ranks_own()] = (double)own - out;
  for (int i = 0; i < out; i++) count[part[i]]++;
  ranks_sum_all(count, ranks);
  partition[0] = 0;
  for (size_t r = 0; r < ranks; r++) partition[r + 1] = partition[r] + (size_t)count[r];
  partition[ranks] = items;
cleanup:
  Zoltan_LB_Free_Part(&global_in, &local_in, &rank_in, &part_in);
  Zoltan_LB_Free_Part(&global, &local, &rank, &part);
  if (zoltan != NULL) Zoltan_Destroy(&zoltan);
  memory_free(&count);
  return status;
}
#endif
