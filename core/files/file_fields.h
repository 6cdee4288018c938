/* Structures in files: members in the order of a table, little-endian, one after the other. One table serves reading
 * and writing, so that they cannot differ. */
#ifndef CONIC_FILE_FIELDS_H
#define CONIC_FILE_FIELDS_H

#include <stddef.h>

/* A member, by its place in memory. */
typedef struct conic_file_field {
  size_t offset, n_bytes, word_bytes; /* word_bytes: turned round together; an array has several words */
} conic_file_field;

#define CONIC_FILE_FIELD(type, member)                                                                                 \
  { offsetof(type, member), sizeof(((type *)0)->member), __alignof__(((type *)0)->member) }

/* The bytes that so many fields take in a file. */
size_t conic_file_fields_bytes(const conic_file_field *fields, size_t n);

void conic_file_fields_write(const conic_file_field *fields, size_t n, const void *from, unsigned char *bytes);
void conic_file_fields_read(const conic_file_field *fields, size_t n, const unsigned char *bytes, void *to);

#endif
