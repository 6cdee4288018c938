#include "core/files/file_fields.h"

#include <string.h>

uint64_t conic_file_get(const unsigned char *from, size_t n_bytes) {
  uint64_t bits = 0;
  for (size_t i = 0; i < n_bytes; i++)
    bits |= (uint64_t)from[i] << 8 * i;
  return bits;
}

void conic_file_put(unsigned char *to, size_t n_bytes, uint64_t bits) {
  for (size_t i = 0; i < n_bytes; i++)
    to[i] = (unsigned char)(bits >> 8 * i);
}

static uint64_t value_bits(const char *value, size_t n_bytes) {
  uint16_t short_value;
  uint32_t half;
  uint64_t whole;
  if (n_bytes == 2)
    return memcpy(&short_value, value, 2), short_value;
  if (n_bytes == 4)
    return memcpy(&half, value, 4), half;
  return memcpy(&whole, value, 8), whole;
}

static void set_value(char *value, size_t n_bytes, uint64_t bits) {
  uint16_t short_value = (uint16_t)bits;
  uint32_t half = (uint32_t)bits;
  if (n_bytes == 2)
    memcpy(value, &short_value, 2);
  else if (n_bytes == 4)
    memcpy(value, &half, 4);
  else
    memcpy(value, &bits, 8);
}

void conic_file_fields_write(const conic_file_field *fields, size_t n, const void *from, unsigned char *bytes) {
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < fields[i].n; k++, bytes += fields[i].n_bytes)
      conic_file_put(bytes, fields[i].n_bytes,
                     value_bits((const char *)from + fields[i].offset + k * fields[i].n_bytes, fields[i].n_bytes));
}

void conic_file_fields_read(const conic_file_field *fields, size_t n, const unsigned char *bytes, void *to) {
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < fields[i].n; k++, bytes += fields[i].n_bytes)
      set_value((char *)to + fields[i].offset + k * fields[i].n_bytes, fields[i].n_bytes,
                conic_file_get(bytes, fields[i].n_bytes));
}

size_t conic_file_fields_bytes(const conic_file_field *fields, size_t n) {
  size_t n_bytes = 0;
  for (size_t i = 0; i < n; i++)
    n_bytes += fields[i].n * fields[i].n_bytes;
  return n_bytes;
}
