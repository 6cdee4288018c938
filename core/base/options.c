#include "core/base/options.h"

#include <string.h>

static const size_t most_bytes = 4096;

static size_t size_of(const void *options) {
  size_t size;
  memcpy(&size, options, sizeof size);
  return size;
}

static size_t common(const void *own, size_t size) {
  return size < size_of(own) ? size : size_of(own);
}

int conic_is_zero(const void *bytes, size_t n) {
  for (size_t i = 0; i < n; i++)
    if (((const unsigned char *)bytes)[i])
      return 0;
  return 1;
}

void conic_options_give(void *theirs, size_t size, const void *own) {
  memset(theirs, 0, size);
  memcpy(theirs, own, common(own, size));
  memcpy(theirs, &size, sizeof size);
}

int conic_options_take(void *own, const void *theirs) {
  size_t own_size = size_of(own), size = theirs ? size_of(theirs) : 0;
  if (size < sizeof size || size % sizeof size || size > most_bytes)
    return 0;
  if (size > own_size && !conic_is_zero((const unsigned char *)theirs + own_size, size - own_size))
    return 0;
  memcpy(own, theirs, common(own, size));
  memcpy(own, &own_size, sizeof own_size);
  return 1;
}
