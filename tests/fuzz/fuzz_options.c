/* libFuzzer: each line as a word of ct2model's command line. */
#include <string.h>

#include "ct2model/request.h"
#include "fuzz_input.h"

enum { WORDS = 24 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static bool silent;
  char *text = malloc(size + 1), *words[WORDS + 2] = {"ct2model"};
  int count = 1;
  bool done;
  struct options *options = NULL;
  struct request request;
  if (text == NULL) abort();
  if (!silent) silent = freopen("/dev/null", "w", stdout) != NULL;
  if (size > 0) memcpy(text, data, size);
  text[size] = '\0';
  for (char *word = text; count <= WORDS && word != NULL; count++) {
    words[count] = word;
    word = strchr(word, '\n');
    if (word != NULL) *word++ = '\0';
  }
  if (options_parse(&ct2model_options, count, words, &options, &done) == STATUS_OK && !done)
    (void)request_parse(options, &request);
  options_free(options);
  free(text);
  memory_set_limit(0);
  return fuzz_end(NULL, 0);
}
