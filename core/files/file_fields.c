#include "core/files/file_fields.h"

#include <string.h>

#include "core/base/byte_order.h"

size_t conic_file_fields_bytes(const conic_file_field *fields, size_t n) {
  size_t n_bytes = 0;
  for (size_t i = 0; i < n; i++)
    n_bytes += fields[i].n_bytes;
  return n_bytes;
}

static void copy_field(const conic_file_field *field, const void *from, void *to) {
  memcpy(to, from, field->n_bytes);
  conic_turn_words(to, field->n_bytes / field->word_bytes, field->word_bytes);
}

void conic_file_fields_write(const conic_file_field *fields, size_t n, const void *from, unsigned char *bytes) {
  for (size_t i = 0; i < n; bytes += fields[i++].n_bytes)
    copy_field(&fields[i], (const char *)from + fields[i].offset, bytes);
}

void conic_file_fields_read(const conic_file_field *fields, size_t n, const unsigned char *bytes, void *to) {
  for (size_t i = 0; i < n; bytes += fields[i++].n_bytes)
    copy_field(&fields[i], bytes, (char *)to + fields[i].offset);
}
