#include "common/error.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "common/text.h"

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static char message[2048];
static char trail[1024];
static int pending;

static void trail_append(const char *file, int line) {
  size_t used = strlen(trail);
  snprintf(trail + used, sizeof trail - used, "%s%s:%d", used ? " < " : "", file, line);
}

enum status error_set(enum status status, const char *file, int line, const char *format, ...) {
  pthread_mutex_lock(&lock);
  if (!pending) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    text_make_plain(message);
    trail[0] = '\0';
    trail_append(file, line);
    pending = 1;
  }
  pthread_mutex_unlock(&lock);
  return status;
}

enum status error_context(enum status status, const char *format, ...) {
  pthread_mutex_lock(&lock);
  char context[1024], joined[sizeof message + sizeof context + 2];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(context, sizeof context, format, arguments);
  va_end(arguments);
  text_make_plain(context);
  snprintf(joined, sizeof joined, "%s: %s", context, message);
  memcpy(message, joined, sizeof message - 1);
  message[sizeof message - 1] = '\0';
  pthread_mutex_unlock(&lock);
  return status;
}

void error_trace(const char *file, int line) {
  pthread_mutex_lock(&lock);
  if (pending) trail_append(file, line);
  pthread_mutex_unlock(&lock);
}

const char *error_message(void) {
  return pending ? message : "";
}
const char *error_trail(void) {
  return pending ? trail : "";
}

void error_clear(void) {
  pthread_mutex_lock(&lock);
  pending = 0;
  message[0] = trail[0] = '\0';
  pthread_mutex_unlock(&lock);
}
