#include "common/text.h"

#include <string.h>

int text_character(const char *at, uint32_t *code) {
  static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const unsigned char *c = (const unsigned char *)at;
  const int n = c[0] < 0x80       ? 1
                : c[0] >> 5 == 6  ? 2
                : c[0] >> 4 == 14 ? 3
                : c[0] >> 3 == 30 ? 4
                                  : 0;
  *code = n == 1 ? c[0] : n == 0 ? 0 : c[0] & (0x7fu >> n);
  if (n == 0 || c[0] == 0) return 0;
  for (int i = 1; i < n; i++) {
    if ((c[i] & 0xc0) != 0x80) return 0;
    *code = *code << 6 | (c[i] & 0x3fu);
  }
  return *code < least[n] || *code > 0x10ffff || (*code >= 0xd800 && *code < 0xe000) ? 0 : n;
}

bool text_is_hidden(uint32_t code) {
  static const uint32_t RANGES[][2] = {
      {0x0000, 0x001f},  /* controls */
      {0x007f, 0x009f},  /* delete, controls of 8 bits */
      {0x00ad, 0x00ad},  /* soft hyphen */
      {0x061c, 0x061c},  /* Arabic letter mark */
      {0x200b, 0x200b},  /* zero width space; the joiners after it belong to scripts */
      {0x200e, 0x200f},  /* marks of direction */
      {0x2028, 0x202e},  /* ends of lines and paragraphs, embeddings and overrides */
      {0x2060, 0x206f},  /* invisible operators, isolates */
      {0xfeff, 0xfeff},  /* byte order mark */
      {0xfff9, 0xfffb},  /* interlinear annotation */
      {0xe0000, 0xe007f} /* tags */
  };
  for (size_t i = 0; i < sizeof RANGES / sizeof *RANGES; i++)
    if (code >= RANGES[i][0] && code <= RANGES[i][1]) return true;
  return false;
}

bool text_is_plain(const char *text) {
  uint32_t code;
  for (int n; *text != '\0'; text += n) {
    n = text_character(text, &code);
    if (n == 0 || text_is_hidden(code)) return false;
  }
  return true;
}

void text_make_plain(char *text) {
  char *to = text;
  uint32_t code;
  for (int n; *text != '\0'; text += n > 0 ? n : 1) {
    n = text_character(text, &code);
    if (n == 0 || text_is_hidden(code))
      *to++ = '?';
    else
      for (int i = 0; i < n; i++) *to++ = text[i];
  }
  *to = '\0';
}
