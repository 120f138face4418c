/* What a program says to wrong words and files: each command of a list runs in this process, and
 * must end with its exit code and one line that begins with the program's name and says what it
 * must; no output may come of it. */
#ifndef TOSUI_TESTS_UNIT_REFUSALS_H
#define TOSUI_TESTS_UNIT_REFUSALS_H

#include "faults.h"

struct refusal {
  int code;
  const char *command; /* words parted by single spaces, the program's name first */
  const char *says;
};

static char refusal_output[600];

static void refusals_note(const char *name, bool is_folder) {
  (void)is_folder;
  if (strncmp(name, "out", 3) == 0) snprintf(refusal_output, sizeof refusal_output, "%s", name);
}

static void refusals_hold(program run, const struct refusal *cases, size_t count) {
  int wrong = 0;
  for (size_t i = 0; i < count; i++) {
    char said[4096], name[64] = "";
    refusal_output[0] = '\0';
    const int code = faults_run(run, cases[i].command);
    FILE *file = fopen("said", "r");
    said[file == NULL ? 0 : fread(said, 1, sizeof said - 1, file)] = '\0';
    if (file != NULL) fclose(file);
    kept_each(refusals_note);
    kept_each(kept_drop);
    snprintf(name, sizeof name, "%.*s: ", (int)strcspn(cases[i].command, " "), cases[i].command);
    const char *end = strchr(said, '\n');
    if (code == cases[i].code && end != NULL && end[1] == '\0' && refusal_output[0] == '\0' &&
        strncmp(said, name, strlen(name)) == 0 && strstr(said, cases[i].says) != NULL)
      continue;
    print_error("%s\n  exit code %d, %d wanted; '%s' wanted; output %s; said: %s\n",
                cases[i].command, code, cases[i].code, cases[i].says,
                *refusal_output ? refusal_output : "none", said);
    wrong++;
  }
  assert_int_equal(wrong, 0);
}

#endif
