/* ranks_faults allocation|write RANK N ARGUMENT...: sphsolve ARGUMENT... of which the N-th
 * allocation, or write, on that rank fails. Says on stderr how many there were, where N is not
 * reached. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/output_file.h"
#include "tests/unit/nth_fails.h"

int sphsolve_main(int argc, char **argv);
#define main sphsolve_main
#include "sphsolve/sphsolve.c"
#undef main

int main(int argc, char **argv) {
  if (argc < 5) return STATUS_USAGE;
  const char *rank = getenv("OMPI_COMM_WORLD_RANK");
  void (*const ask_fails)(bool (*)(void)) =
      !strcmp(argv[1], "write") ? output_ask_fails : memory_ask_fails;
  const long n = strtol(argv[3], NULL, 10);
  const bool here = rank == NULL || !strcmp(rank, argv[2]);
  setenv("OMP_WAIT_POLICY", "passive", 1); /* or sphsolve would start this program anew */
  if (here) nth_fails_left = n, ask_fails(nth_fails);
  argv[3] = argv[0];
  const int code = sphsolve_main(argc - 3, argv + 3);
  ask_fails(NULL);
  if (here && nth_fails_left > 0) fprintf(stderr, "%ld\n", n - nth_fails_left);
  return code;
}
