/* Rows of the history, snapshots and checkpoints of method richards. */
#ifndef TOSUI_SPHSOLVE_DARCY_OUTPUT_H
#define TOSUI_SPHSOLVE_DARCY_OUTPUT_H

#include "sphsolve/output/recorder.h"
#include "sphsolve/darcy/state.h"

/* Adds the history's columns beyond those of every method. */
enum status richards_add_columns(const struct richards *s, struct recorder *recorder);
/* Both evaluate states and fluxes at the present time. */
enum status richards_write_row(struct richards *s, struct recorder *recorder, double dt);
enum status richards_write_snapshot(struct richards *s, struct recorder *recorder);
/* Write the state to a checkpoint, and read it; reading leaves the file open. */
enum status richards_write_checkpoint(const struct richards *s, struct recorder *recorder);
enum status richards_read_checkpoint(struct richards *s, struct h5_file *file);
/* Pressure head, m, at a point: linear between the centres of sites, and at rest in free water.
 * NAN outside both. */
double richards_head_at(const struct richards *s, const double point[3]);
/* Height of the water table over a point, m: below it the soil is under pressure down to its foot.
 * NAN: none. */
double richards_level_at(const struct richards *s, const double point[3]);

#endif
