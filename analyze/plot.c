#define _GNU_SOURCE // NOLINT: the name glibc wants, for posix_spawn_file_actions_addchdir_np
#include "analyze/plot.h"

#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/output_file.h"

extern char **environ;

const char *const plot_colours[PLOT_COLOURS] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                "#E69F00", "#56B4E9", "#882255", "#000000"};

void plot_line_style(FILE *stream, size_t i) {
  fprintf(stream, "linecolor rgb '%s' dashtype %zu", plot_colours[i % PLOT_COLOURS],
          1 + i / PLOT_COLOURS);
}

void plot_point_style(FILE *stream, size_t i) {
  static const int points[PLOT_COLOURS] = {7, 5, 9, 13, 11, 15, 6, 4};
  fprintf(stream, " pointtype %d", points[i % PLOT_COLOURS]);
}

void plot_text(FILE *stream, const char *text) {
  fputc('"', stream);
  for (; *text != '\0'; text++) {
    const unsigned char c = (unsigned char)*text;
    if (c == '"' || c == '\\') fputc('\\', stream);
    fputc(c < 0x20 || c == 0x7f || c == '`' ? ' ' : c, stream);
  }
  fputc('"', stream);
}

/* Runs gnuplot in `folder` on NAME.gp; `exit_code` is -1 without gnuplot. Its messages are shown
 * only with `remarks`. */
static enum status spawn_gnuplot(const char *folder, const char *name, const char *format,
                                 bool messages, int *exit_code) {
  char script[300], set_format[40];
  snprintf(script, sizeof script, "%s.gp", name);
  snprintf(set_format, sizeof set_format, "format='%s'", format);
  char *argv[] = {"gnuplot", "-e", set_format, script, NULL};
  posix_spawn_file_actions_t actions;
  pid_t child = 0;
  int state = 0;
  *exit_code = -1;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  if (!messages)
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  int failure = posix_spawnp(&child, "gnuplot", &actions, NULL, argv, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) return STATUS_OK;
  while (waitpid(child, &state, 0) < 0)
    if (errno != EINTR) return FAIL(STATUS_RUN, "gnuplot: %s", strerror(errno));
  int code = WIFEXITED(state) ? WEXITSTATUS(state) : 1;
  *exit_code = code == 127 ? -1 : code;
  return STATUS_OK;
}

/* *ran is false without gnuplot. A script that fails is run again to show its messages. */
static enum status run_gnuplot(const char *folder, const char *name, const char *format,
                               bool *ran) {
  enum status status = STATUS_OK;
  char picture[4200], target[OUTPUT_NAME_MAX];
  int code;
  /* Removed first: gnuplot would write into other hard links of the file. */
  snprintf(picture, sizeof picture, "%s/%s.%s", folder, name, format);
  TRY(output_check_inputs(picture));
  TRY(output_follow(picture, target));
  unlink(target);
  TRY(spawn_gnuplot(folder, name, format, false, &code));
  *ran = code >= 0;
  if (code > 0) {
    TRY(spawn_gnuplot(folder, name, format, true, &code));
    unlink(picture); /* an incomplete picture */
    TRY_FAIL(STATUS_RUN, "%s/%s.gp: gnuplot could not draw it; its message stands above", folder,
             name);
  }
cleanup:
  return status;
}

static void write_head(FILE *stream, const char *name, int width, int height) {
  fprintf(stream,
          "# gnuplot %s.gp                      writes %s.svg\n"
          "# gnuplot -e \"format='png'\" %s.gp    writes %s.png\n"
          "if (!exists('format')) format = 'svg'\n",
          name, name, name, name);
  fprintf(stream,
          "if (format eq 'svg') set terminal svg size %d,%d dynamic enhanced "
          "font 'Helvetica,Arial,sans-serif,15' background '#ffffff'\n"
          "if (format eq 'png') set terminal pngcairo size %d,%d enhanced font 'DejaVu Sans,13' "
          "fontscale 1.5 linewidth 1.6 pointscale 1.6 background '#ffffff'\n"
          "set output '%s.'.format\n",
          width, height, 2 * width, 2 * height, name);
  fputs("set encoding utf8\n"
        "set border linewidth 1 linecolor rgb '#444444'\n"
        "set tics textcolor rgb '#222222'\n"
        "set grid linecolor rgb '#dddddd' linewidth 0.6 linetype 1\n"
        "set key noenhanced\n\n",
        stream);
}

static enum status write_script(const char *folder, const char *name, const char *body, int width,
                                int height) {
  char path[4200];
  char *script = NULL;
  size_t size = 0;
  if (snprintf(path, sizeof path, "%s/%s.gp", folder, name) >= (int)sizeof path)
    return FAIL(STATUS_USAGE, "-o: the folder's name is too long");
  FILE *stream = open_memstream(&script, &size);
  if (stream == NULL) return FAIL(STATUS_RUN, "out of memory for a plot");
  write_head(stream, name, width, height);
  fputs(body, stream);
  bool bad = fclose(stream) != 0;
  enum status status =
      bad ? FAIL(STATUS_RUN, "out of memory for a plot") : output_write(path, script, size);
  free(script);
  return status;
}

static void warn_once(void) {
  static bool warned;
  if (!warned)
    log_warning("gnuplot is not installed: no plots are drawn (the scripts NAME.gp and all numbers "
                "are written); install it with 'apt-get install gnuplot-nox'");
  warned = true;
}

enum status plot_save(const char *folder, const char *name, const char *body, int width,
                      int height) {
  enum status status = STATUS_OK;
  bool ran = false;
  TRY(write_script(folder, name, body, width, height));
  TRY(run_gnuplot(folder, name, "svg", &ran));
  if (ran) TRY(run_gnuplot(folder, name, "png", &ran));
  if (!ran) warn_once();
cleanup:
  return status;
}

static enum status read_whole(const char *path, char **text) {
  enum status status = STATUS_OK;
  struct stat info;
  FILE *stream = fopen(path, "rb");
  if (stream == NULL || fstat(fileno(stream), &info) != 0)
    TRY_FAIL(STATUS_RUN, "%s: %s", path, strerror(errno));
  size_t size = (size_t)info.st_size;
  TRY(memory_allocate(text, size + 1, 1, "plot"));
  if (fread(*text, 1, size, stream) != size) TRY_FAIL(STATUS_RUN, "%s: cannot be read", path);
cleanup:
  if (stream != NULL) fclose(stream);
  return status;
}

enum status plot_svg(const char *name, const char *body, int width, int height, char **svg) {
  enum status status = STATUS_OK;
  const char *temporary = getenv("TMPDIR");
  const bool own = temporary != NULL && temporary[0] != '\0';
  char folder[1024], path[1400];
  bool ran = false;
  *svg = NULL;
  snprintf(folder, sizeof folder, "%s/tosui-plot-XXXXXX", own ? temporary : "/tmp");
  bool made = mkdtemp(folder) != NULL;
  if (!made && own) { /* TMPDIR of another machine, or missing */
    snprintf(folder, sizeof folder, "/tmp/tosui-plot-XXXXXX");
    made = mkdtemp(folder) != NULL;
  }
  if (!made)
    return FAIL(STATUS_RUN, "%s: no folder for a picture there: %s", folder, strerror(errno));
  TRY(write_script(folder, name, body, width, height));
  TRY(run_gnuplot(folder, name, "svg", &ran));
  snprintf(path, sizeof path, "%s/%s.svg", folder, name);
  if (ran)
    TRY(read_whole(path, svg));
  else
    warn_once();
cleanup:
  for (int i = 0; i < 2; i++) {
    snprintf(path, sizeof path, "%s/%s.%s", folder, name, i == 0 ? "gp" : "svg");
    unlink(path);
  }
  rmdir(folder);
  return status;
}
