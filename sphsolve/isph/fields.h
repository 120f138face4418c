/* The fields of the particles, from fields.def: their memory, and what is done to all of them
 * alike. Beside those lines each effect may have fields of its own (plan/effect.h). */
#ifndef TOSUI_SPHSOLVE_ISPH_FIELDS_H
#define TOSUI_SPHSOLVE_ISPH_FIELDS_H

#include "common/hdf5_file.h"
#include "sphsolve/isph/state.h"

enum isph_use { STEP, KEPT };

struct isph_field {
  const char *name;
  bool exists;
  enum isph_use use;
  size_t at;   /* offset of its pointer in struct isph */
  size_t size; /* bytes of a particle */
  enum h5_type type;
  int components; /* 0: a struct */
  const char *unit, *text;
  bool shown; /* in snapshots: value times `factor`; `without` where it does not exist */
  double factor, without;
  const char *as, *as_unit, *as_text; /* NULL: name, unit and text are those above */
};

#define ISPH_FIELDS 96
/* Lists all fields, whether they exist or not; returns their number. */
size_t isph_fields(const struct isph *s, struct isph_field list[ISPH_FIELDS]);
/* Those of the particles' state. */
struct isph_kept {
  size_t count, bytes; /* bytes: of a particle */
  struct isph_field field[ISPH_FIELDS];
};
void isph_fields_kept(const struct isph *s, struct isph_kept *kept);
/* Bytes of a particle with all its fields. */
size_t isph_fields_bytes(const struct isph *s);
/* The array of a field. */
char *isph_field_data(const struct isph *s, const struct isph_field *field);
/* Makes room for n particles in all fields; frees them. */
enum status isph_fields_resize(struct isph *s, size_t n);
void isph_fields_free(struct isph *s);

/* Moves the state of n particles. */
void isph_kept_move(const struct isph *s, const struct isph_kept *kept, size_t to, size_t from,
                    size_t n);
/* Copies the state of particle i to, or from, kept->bytes bytes. */
void isph_kept_pack(const struct isph *s, const struct isph_kept *kept, size_t i, char *packed);
void isph_kept_unpack(const struct isph *s, const struct isph_kept *kept, size_t i,
                      const char *packed);

#endif
