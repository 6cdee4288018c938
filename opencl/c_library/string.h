/* What of C's <string.h> the shared text uses, for private memory. */
#ifndef CONIC_STRING_H
#define CONIC_STRING_H

static inline void conic_copy_bytes(void *to, const void *from, size_t n) {
  for (size_t i = 0; i < n; i++)
    ((uchar *)to)[i] = ((const uchar *)from)[i];
}

static inline void conic_fill_bytes(void *to, int value, size_t n) {
  for (size_t i = 0; i < n; i++)
    ((uchar *)to)[i] = (uchar)value;
}

#define memcpy conic_copy_bytes
#define memset conic_fill_bytes
#define memmove conic_copy_bytes

#endif
