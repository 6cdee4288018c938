#include "core/pictures/picture_shot.h"

#include "core/base/byte_order.h"
#include "core/base/loan_find.h"
#include "core/files/inflate.h"
#include "core/files/mapping.h"

enum { LONGEST_TEXT = 16 << 20, KEYWORD = sizeof CONIC_SHOT_KEYWORD - 1 };

/* Bytes of a file, and where in them. */
typedef struct text_search {
  conic_context *context;
  const unsigned char *bytes;
  size_t n;
  char *text; /* that was found */
  size_t n_text;
} text_search;

/* A copy of what is found. */
static conic_status take_found_text(text_search *s, const void *bytes, size_t n) {
  if (n == 0 || n > LONGEST_TEXT)
    return CONIC_OK;
  s->text = conic_memory_allocate(s->context, n + 1, 1);
  if (!s->text)
    return CONIC_ERROR_MEMORY;
  memcpy(s->text, bytes, n);
  s->text[n] = '\0';
  s->n_text = n;
  return CONIC_OK;
}

/* The length of the text at `at`, up to its zero; n: there is no zero. */
static size_t length_at(const text_search *s, size_t at) {
  const unsigned char *zero = at < s->n ? memchr(s->bytes + at, 0, s->n - at) : NULL;
  return zero ? (size_t)(zero - (s->bytes + at)) : s->n;
}

/* --- EXR: after magic and version, names, types, lengths and values, up to an empty name --- */

static conic_status search_exr(text_search *s) {
  size_t at = 8;
  for (;;) {
    size_t n_name = length_at(s, at), type = at + n_name + 1, n_type;
    if (n_name == 0 || n_name >= s->n || type >= s->n)
      return CONIC_OK;
    n_type = length_at(s, type);
    size_t length = type + n_type + 1;
    if (n_type >= s->n || length > s->n || s->n - length < 4)
      return CONIC_OK;
    uint32_t n_value = conic_load_32(s->bytes + length);
    if (n_value > s->n - length - 4)
      return CONIC_OK;
    const unsigned char *value = s->bytes + length + 4;
    if (n_name == KEYWORD && memcmp(s->bytes + at, CONIC_SHOT_KEYWORD, KEYWORD) == 0 && n_type == 6 &&
        memcmp(s->bytes + type, "string", 6) == 0)
      return take_found_text(s, value, n_value);
    at = length + 4 + n_value;
  }
}

/* --- PNG: chunks of length, name, data and sum --- */

/* What zlib packed: two bytes before what is deflated. How long it becomes is not said. */
static conic_status take_packed_text(text_search *s, const unsigned char *packed, size_t n) {
  size_t room = 1 << 16;
  unsigned char *text = NULL;
  for (; n > 2 && room <= LONGEST_TEXT; room *= 4) {
    conic_memory_release(s->context, text);
    text = conic_memory_allocate(s->context, room, 1);
    if (!text)
      return CONIC_ERROR_MEMORY;
    size_t n_text = conic_inflate(CONIC_DEFLATE_BARE, packed + 2, n - 2, text, room, NULL);
    if (n_text == room)
      continue;
    conic_status status = take_found_text(s, text, n_text);
    conic_memory_release(s->context, text);
    return status;
  }
  conic_memory_release(s->context, text);
  return CONIC_OK;
}

/* After the keyword's zero: of zTXt a method, and what is packed; of iTXt whether it is packed, a method, and two texts
 * before the one. */
static conic_status take_chunk(text_search *s, const unsigned char *name, const unsigned char *data, size_t n) {
  size_t at = KEYWORD + 1;
  if (memcmp(name, "tEXt", 4) == 0)
    return take_found_text(s, data + at, n - at);
  if (memcmp(name, "zTXt", 4) == 0 && n - at > 1)
    return take_packed_text(s, data + at + 1, n - at - 1);
  if (memcmp(name, "iTXt", 4) != 0 || n - at < 4)
    return CONIC_OK;
  int is_packed = data[at] != 0;
  at += 2;
  for (int i = 0; i < 2; i++) {
    const unsigned char *zero = at < n ? memchr(data + at, 0, n - at) : NULL;
    if (!zero)
      return CONIC_OK;
    at = (size_t)(zero - data) + 1;
  }
  return is_packed ? take_packed_text(s, data + at, n - at) : take_found_text(s, data + at, n - at);
}

static conic_status search_png(text_search *s) {
  for (size_t at = 8; at <= s->n && s->n - at >= 12;) {
    size_t n = conic_load_big_32(s->bytes + at);
    const unsigned char *name = s->bytes + at + 4, *data = name + 4;
    if (n > s->n - at - 12 || memcmp(name, "IEND", 4) == 0)
      return CONIC_OK;
    int is_text = memcmp(name + 1, "TXt", 3) == 0 || memcmp(name, "tEXt", 4) == 0;
    if (is_text && n > KEYWORD && memcmp(data, CONIC_SHOT_KEYWORD, KEYWORD + 1) == 0)
      return take_chunk(s, name, data, n);
    at += n + 12;
  }
  return CONIC_OK;
}

/* --- TIFF: the first directory's tag 270 --- */

static uint64_t tiff_number(const text_search *s, size_t at, size_t n_bytes) {
  uint64_t number = 0;
  int is_big_endian = s->bytes[0] == 'M';
  for (size_t i = 0; i < n_bytes; i++)
    number |= (uint64_t)s->bytes[at + i] << 8 * (is_big_endian ? n_bytes - 1 - i : i);
  return number;
}

static conic_status search_tiff(text_search *s) {
  int is_large = tiff_number(s, 2, 2) == 43; /* offsets and counts of 64 bits */
  size_t word = is_large ? 8 : 4, n_count = is_large ? 8 : 2, n_tag = is_large ? 20 : 12;
  if (s->n < 16)
    return CONIC_OK;
  uint64_t at = tiff_number(s, is_large ? 8 : 4, word);
  if (at >= s->n || s->n - at < n_count)
    return CONIC_OK;
  uint64_t n_tags = tiff_number(s, (size_t)at, n_count);
  at += n_count;
  for (; n_tags-- > 0 && s->n - at >= n_tag; at += n_tag) {
    if (tiff_number(s, (size_t)at, 2) != 270 || tiff_number(s, (size_t)at + 2, 2) != 2)
      continue;
    uint64_t n = tiff_number(s, (size_t)at + 4, word), to = at + 4 + word;
    if (n > word) /* else it is right here */
      to = tiff_number(s, (size_t)to, word);
    if (to > s->n || n > s->n - to || n == 0 || s->bytes[to] != '{')
      return CONIC_OK;
    return take_found_text(s, s->bytes + to, (size_t)n - (s->bytes[to + n - 1] == 0));
  }
  return CONIC_OK;
}

conic_status conic_picture_shot_text(conic_context *context, const char *path, char **text, size_t *n_bytes) {
  conic_mapping file;
  *text = NULL;
  *n_bytes = 0;
  if (conic_loan_find(context, path, "image")) /* no file, which nobody drew as far as is known */
    return CONIC_OK;
  conic_status status = conic_mapping_open(context, path, &file);
  if (status != CONIC_OK)
    return status;
  text_search s = {.context = context, .bytes = file.bytes, .n = file.n_bytes};
  if (s.n >= 8 && memcmp(s.bytes, "\x76\x2f\x31\x01", 4) == 0)
    status = search_exr(&s);
  else if (s.n >= 8 && memcmp(s.bytes, "\x89PNG", 4) == 0)
    status = search_png(&s);
  else if (s.n >= 4 && (memcmp(s.bytes, "II", 2) == 0 || memcmp(s.bytes, "MM", 2) == 0))
    status = search_tiff(&s);
  else if (s.n && s.bytes[0] == '{')
    status = take_found_text(&s, s.bytes, s.n);
  conic_mapping_close(context, &file);
  *text = s.text;
  *n_bytes = s.n_text;
  return status;
}
