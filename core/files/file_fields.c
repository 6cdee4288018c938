#include "core/files/file_fields.h"

#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
               "files are written from little-endian memory, and read into it");

uint64_t conic_file_get(const unsigned char *from, size_t n_bytes) {
  uint64_t bits = 0;
  memcpy(&bits, from, n_bytes);
  return bits;
}

void conic_file_put(unsigned char *to, size_t n_bytes, uint64_t bits) {
  memcpy(to, &bits, n_bytes);
}

size_t conic_file_fields_bytes(const conic_file_field *fields, size_t n) {
  size_t n_bytes = 0;
  for (size_t i = 0; i < n; i++)
    n_bytes += fields[i].n_bytes;
  return n_bytes;
}

void conic_file_fields_write(const conic_file_field *fields, size_t n, const void *from, unsigned char *bytes) {
  for (size_t i = 0; i < n; bytes += fields[i++].n_bytes)
    memcpy(bytes, (const char *)from + fields[i].offset, fields[i].n_bytes);
}

void conic_file_fields_read(const conic_file_field *fields, size_t n, const unsigned char *bytes, void *to) {
  for (size_t i = 0; i < n; bytes += fields[i++].n_bytes)
    memcpy((char *)to + fields[i].offset, bytes, fields[i].n_bytes);
}
