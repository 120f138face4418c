#include "sphsolve/isph/fields.h"

#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/calm.h"
#include "sphsolve/isph/linear.h"
#include "sphsolve/isph/outline.h"
#include "sphsolve/isph/step.h"
#include "sphsolve/isph/well.h"

/* How a type is stored in files; structs are not. */
#define FILE_TYPE(type)                                                                            \
  _Generic(*(type *)NULL, double : H5_F64, float : H5_F32, uint64_t : H5_U64, default : H5_U8)
#define COMPONENTS(type, shape)                                                                    \
  (_Generic(*(type *)NULL, double : 1, float : 1, uint64_t : 1, default : 0) *                     \
   (int)(sizeof(type shape) / sizeof(type)))

static bool has_surface_pressure(const struct isph *s) {
  for (size_t k = 0; k < s->on.own_count; k++)
    if (s->on.own[k]->surface_pressure != NULL) return true;
  return false;
}

/* Working memory of a fixed size, which has no place in fields.def. */
static struct isph_field unnamed(size_t at, bool exists, size_t size) {
  return (struct isph_field){.name = "", .at = at, .exists = exists, .size = size};
}

size_t isph_fields(const struct isph *s, struct isph_field list[ISPH_FIELDS]) {
  size_t n = 0;
#define HIDDEN .factor = 1
#define SHOWN(value, missing) .shown = true, .factor = (value), .without = (missing)
#define SHOWN_AS(name, unit, text, value, missing)                                                 \
  SHOWN(value, missing), .as = (name), .as_unit = (unit), .as_text = (text)
#define FIELD(how, kind, shape, member, when, of, words, ...)                                      \
  list[n++] = (struct isph_field){.name = #member,                                                 \
                                  .exists = (when),                                                \
                                  .use = (how),                                                    \
                                  .at = offsetof(struct isph, member),                             \
                                  .size = sizeof(kind shape),                                      \
                                  .type = FILE_TYPE(kind),                                         \
                                  .components = COMPONENTS(kind, shape),                           \
                                  .unit = (of),                                                    \
                                  .text = (words),                                                 \
                                  __VA_ARGS__};
#include "sphsolve/isph/fields.def"
#undef FIELD
  for (size_t k = 0; k < sizeof s->work / sizeof *s->work; k++)
    list[n++] = unnamed(offsetof(struct isph, work) + k * sizeof *s->work, true, sizeof(double));
  list[n++] = unnamed(offsetof(struct isph, scratch), true, sizeof(double[3]));
  for (size_t k = 0, own = 0; k < s->on.active_count; k++)
    for (const struct effect_field *f = s->on.active[k]->fields; f != NULL && f->name != NULL;
         f++, own++)
      list[n++] =
          (struct isph_field){.name = f->name,
                              .exists = true,
                              .use = KEPT,
                              .at = offsetof(struct isph, own_field) + own * sizeof *s->own_field,
                              .size = sizeof(double),
                              .type = H5_F64,
                              .components = 1,
                              .unit = f->unit,
                              .text = f->text,
                              .shown = true,
                              .factor = 1};
  for (size_t k = 0; k < s->on.own_count; k++)
    list[n++] = unnamed(offsetof(struct isph, own_force) + k * sizeof *s->own_force,
                        s->on.own[k]->force != NULL, sizeof(double[3]));
  return n;
}

void isph_fields_kept(const struct isph *s, struct isph_kept *kept) {
  const size_t n = isph_fields(s, kept->field);
  kept->count = kept->bytes = 0;
  for (size_t k = 0; k < n; k++) {
    if (!kept->field[k].exists || kept->field[k].use != KEPT) continue;
    kept->bytes += kept->field[k].size;
    kept->field[kept->count++] = kept->field[k];
  }
}

size_t isph_fields_bytes(const struct isph *s) {
  struct isph_field list[ISPH_FIELDS];
  size_t bytes = 0;
  for (size_t k = 0, n = isph_fields(s, list); k < n; k++)
    if (list[k].exists) bytes += list[k].size;
  return bytes;
}

char *isph_field_data(const struct isph *s, const struct isph_field *field) {
  char *data;
  memcpy(&data, (const char *)s + field->at, sizeof data);
  return data;
}

/* With room for those that a load of several numbers at the last particle may read beyond it. */
#define FIELD_ROOM 8

enum status isph_fields_resize(struct isph *s, size_t n) {
  struct isph_field list[ISPH_FIELDS];
  for (size_t k = 0, count = isph_fields(s, list); k < count; k++) {
    if (!list[k].exists) continue;
    enum status status =
        memory_resize((char *)s + list[k].at, n + FIELD_ROOM, list[k].size, "water particles");
    if (status != STATUS_OK) return status;
  }
  return STATUS_OK;
}

void isph_fields_free(struct isph *s) {
  struct isph_field list[ISPH_FIELDS];
  for (size_t k = 0, count = isph_fields(s, list); k < count; k++)
    memory_free((char *)s + list[k].at);
}

void isph_kept_move(const struct isph *s, const struct isph_kept *kept, size_t to, size_t from,
                    size_t n) {
  if (n == 0 || to == from) return;
  for (size_t k = 0; k < kept->count; k++) {
    char *data = isph_field_data(s, &kept->field[k]);
    const size_t size = kept->field[k].size;
    memmove(data + to * size, data + from * size, n * size);
  }
}

void isph_kept_pack(const struct isph *s, const struct isph_kept *kept, size_t i, char *packed) {
  for (size_t k = 0; k < kept->count; packed += kept->field[k++].size)
    memcpy(packed, isph_field_data(s, &kept->field[k]) + i * kept->field[k].size,
           kept->field[k].size);
}

void isph_kept_unpack(const struct isph *s, const struct isph_kept *kept, size_t i,
                      const char *packed) {
  for (size_t k = 0; k < kept->count; packed += kept->field[k++].size)
    memcpy(isph_field_data(s, &kept->field[k]) + i * kept->field[k].size, packed,
           kept->field[k].size);
}
