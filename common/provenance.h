/* Where a file comes from: program version, command line, inputs with hashes, host, time. */
#ifndef TOSUI_COMMON_PROVENANCE_H
#define TOSUI_COMMON_PROVENANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/hdf5_file.h"

#define TOSUI_VERSION "0.1.0"
#define TOSUI_SCHEMA_VERSION 1

/* XXH3 (64 bit) of a file's bytes; hash_file_start: of the first `size` bytes, or of all if there
 * are fewer. */
enum status hash_file(const char *path, uint64_t *hash);
enum status hash_file_start(const char *path, uint64_t size, uint64_t *hash);
uint64_t hash_bytes(const void *data, size_t size);

/* Writes /provenance: attributes program, version, schema_version, command_line, host, time (the
 * only difference between two equal runs); datasets input_files, input_hashes. */
enum status provenance_write(struct h5_file *file, const char *program, const char *command_line,
                             size_t input_count, const char *const *input_paths,
                             const uint64_t *input_hashes);

/* Refuses a file written by a newer version; a file without a version is accepted. */
enum status provenance_check(struct h5_file *file);

/* Whether an HDF5 file was written by a program of Tosui: model, run, snapshot, checkpoint. */
bool provenance_is_ours(const char *path);

#endif
