#include "ct2model/readers/image_data.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/readers/inflate.h"

/* Largest number of files that a header may name. */
#define FILES_MOST (1 << 20)

enum status image_header_line(const char *path, FILE *header, char *line, size_t size, int *number,
                              bool *more) {
  line[0] = '\0';
  *more = fgets(line, (int)size, header) != NULL;
  if (!*more) return STATUS_OK;
  ++*number;
  const size_t length = strcspn(line, "\r\n");
  if (length + 1 == size)
    return FAIL(STATUS_INPUT, "%s:%d: a line of over %zu characters, as no header has" EXPORT_AGAIN,
                path, *number, size - 1);
  line[length] = '\0';
  return STATUS_OK;
}

/* Whether a link takes `path` out of the folder of the header. */
static bool leads_out(const char *header, const char *path) {
  char *of_header = realpath(header, NULL), *of_path = realpath(path, NULL);
  bool out = false;
  if (of_header != NULL && of_path != NULL) {
    const size_t folder = (size_t)(strrchr(of_header, '/') - of_header) + 1;
    out = strncmp(of_header, of_path, folder) != 0;
  }
  free(of_header);
  free(of_path);
  return out;
}

enum status image_data_beside(struct image *image, const char *name, int line) {
  enum status status = STATUS_OK;
  const char *slash = strrchr(image->path, '/');
  const size_t folder = slash == NULL ? 0 : (size_t)(slash - image->path) + 1;
  const size_t count = image->data_file_count;
  char *joined = NULL;
  TRY(memory_allocate(&joined, folder + strlen(name) + 1, 1, "a path"));
  memcpy(joined, image->path, folder);
  strcpy(joined + folder, name);
  if (name[0] == '/' || strncmp(name, "../", 3) == 0 || strstr(name, "/../") != NULL ||
      leads_out(image->path, joined))
    TRY_FAIL(STATUS_INPUT,
             "%s:%d: the pixels in %s lie outside the header's folder; a header may name only "
             "files beside it: move them together, or give the pixels themselves with --raw",
             image->path, line, name);
  if (count == FILES_MOST)
    TRY_FAIL(STATUS_INPUT, "%s:%d: names over %d files", image->path, line, FILES_MOST);
  if ((count & (count - 1)) == 0) /* room for a power of two */
    TRY(memory_resize(&image->data_files, count > 0 ? 2 * count : 1, sizeof *image->data_files,
                      "file names"));
  image->data_files[image->data_file_count++] = joined;
  joined = NULL;
cleanup:
  memory_free(&joined);
  return status;
}

/* The place of the one "%d", "%3d" or "%03d" in a format, the width of its number and what fills
 * it; NULL if it holds none, or anything else that printf would read. */
static const char *number_place(const char *format, int *width, bool *zeros, const char **after) {
  const char *at = strchr(format, '%');
  if (at == NULL) return NULL;
  const char *c = at + 1;
  *zeros = *c == '0';
  *width = 0;
  while (isdigit((unsigned char)*c) && *width < 20) *width = 10 * *width + (*c++ - '0');
  if ((*c != 'd' && *c != 'i' && *c != 'u') || *width >= 20 || strchr(c, '%') != NULL) return NULL;
  *after = c + 1;
  return at;
}

enum status image_data_pattern(struct image *image, const char *text, int line) {
  enum status status = STATUS_OK;
  char format[300], name[340];
  const char *after;
  long first, last, step;
  int width;
  bool zeros;
  const bool whole = sscanf(text, "%299s %ld %ld %ld", format, &first, &last, &step) == 4;
  const char *at = whole ? number_place(format, &width, &zeros, &after) : NULL;
  if (at == NULL || first < 0 || last < 0 || first > INT32_MAX || last > INT32_MAX || step == 0 ||
      labs(step) > INT32_MAX || (last - first) / step < 0)
    return FAIL(STATUS_INPUT,
                "%s:%d: %.200s is no pattern of file names, as slice%%03d.raw 1 20 1 (first, last, "
                "step)",
                image->path, line, text);
  for (long i = 0; i <= (last - first) / step; i++) {
    snprintf(name, sizeof name, zeros ? "%.*s%0*ld%s" : "%.*s%*ld%s", (int)(at - format), format,
             width, first + i * step, after);
    TRY(image_data_beside(image, name, line));
  }
cleanup:
  return status;
}

enum status image_data_list(struct image *image, FILE *header, int line) {
  enum status status = STATUS_OK;
  char name[1024];
  bool more = true;
  for (;;) {
    TRY(image_header_line(image->path, header, name, sizeof name, &line, &more));
    if (!more) break;
    char *end = name + strlen(name);
    while (end > name && isspace((unsigned char)end[-1])) *--end = '\0';
    if (name[0] != '\0') TRY(image_data_beside(image, name, line));
  }
  if (image->data_file_count == 0)
    TRY_FAIL(STATUS_INPUT, "%s:%d: a list of files, which names none" EXPORT_AGAIN, image->path,
             line);
cleanup:
  return status;
}

/* Pixels that are compressed. */
static enum status claim_packed(struct image *image, const char *path, uint64_t bytes,
                                double wanted) {
  const double skipped = (double)image->data_offset;
  const double most = INFLATE_MOST * ((double)bytes - (double)image->packed_offset);
  if (image->data_offset == PIXELS_AT_END)
    return FAIL(STATUS_INPUT, "%s: compressed pixels need a header of known size", image->path);
  if (image->data_file_count > 1)
    return FAIL(STATUS_INPUT, "%s: compressed pixels in several files are not read; save them raw",
                image->path);
  if (!(wanted + skipped <= most))
    return FAIL(STATUS_INPUT,
                "%s: the header promises %.0f bytes of pixels, but the compressed data can hold "
                "at most %.0f; the file is cut short or damaged",
                image->path, wanted + skipped, fmax(most, 0));
  return inflate_start(path, image->packed_offset, image->data_offset + (uint64_t)wanted,
                       &image->inflated);
}

/* Bytes beyond the pixels: in a file of their own nobody says on which side of the pixels they lie,
 * unless the header does; behind pixels that follow their header they are of no account. */
static enum status judge_rest(struct image *image, const char *path, double rest) {
  if (image->data_file_count > 0 && !image->placed)
    return FAIL(
        STATUS_INPUT,
        "%s: %.0f bytes more than the %zux%zux%zu pixels that %s describes: where do they "
        "begin? Let it say so (HeaderSize of MetaImage, byte skip of NRRD; -1: they are the "
        "last), or give --raw NXxNYxNZ:TYPE:OFFSET",
        path, rest, image->size[0], image->size[1], image->pages / image->data_file_count,
        image->path);
  image_note(image, "%.0f bytes after its pixels are not used", rest);
  return STATUS_OK;
}

enum status image_claim_pixels(struct image *image, bool compressed) {
  enum status status = STATUS_OK;
  const size_t files = image->data_file_count > 0 ? image->data_file_count : 1;
  const double wanted = (double)image->size[0] * (double)image->size[1] * (double)image->pages *
                        (double)image_stored_size(image) / (double)files;
  const bool at_end = image->data_offset == PIXELS_AT_END;
  const char *longest = NULL;
  double rest = 0.0;
  if (image->pages % files != 0)
    return FAIL(STATUS_INPUT, "%s: names %zu files for %zu slices, which is no whole number each",
                image->path, files, image->pages);
  for (size_t i = 0; i < files; i++) {
    const char *path = image->data_file_count > 0 ? image->data_files[i] : image->path;
    uint64_t bytes = 0;
    TRY(image_file_size(path, &bytes));
    if (compressed) {
      TRY(claim_packed(image, path, bytes, wanted));
      break;
    }
    const double before = at_end ? fmax((double)bytes - wanted, 0.0) : (double)image->data_offset;
    if (at_end && i > 0 && (double)image->data_offset != before)
      TRY_FAIL(STATUS_INPUT, "%s: not as long as the first of the files that %s names", path,
               image->path);
    image->data_offset = (uint64_t)before;
    const double there = (double)bytes - before;
    if (there < wanted)
      TRY_FAIL(STATUS_INPUT,
               "%s: %.10g bytes of pixels, but the header promises %.10g" EXPORT_AGAIN, path, there,
               wanted);
    if (there - wanted <= rest) continue;
    rest = there - wanted;
    longest = path;
  }
  if (longest != NULL) TRY(judge_rest(image, longest, rest));
cleanup:
  return status;
}
