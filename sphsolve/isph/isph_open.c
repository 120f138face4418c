#include "sphsolve/isph/isph_state.h"

enum status isph_open_create(struct isph *s) {
  (void)s;
  return STATUS_OK;
}

enum status isph_open_exchange(struct isph *s, double dt) {
  (void)s, (void)dt;
  return STATUS_OK;
}
