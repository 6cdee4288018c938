#include "core/files/lzf.h"

int conic_lzf_unpack(const unsigned char *packed, size_t n_packed, unsigned char *bytes, size_t n_bytes) {
  size_t from = 0, to = 0;
  while (from < n_packed) {
    size_t head = packed[from++], length = head + 1, distance;
    if (head < 32) {
      if (length > n_packed - from || length > n_bytes - to)
        return 0;
      memcpy(bytes + to, packed + from, length);
      from += length;
      to += length;
      continue;
    }
    length = (head >> 5) + 2;
    if (length == 9 && from < n_packed)
      length += packed[from++];
    if (from == n_packed)
      return 0;
    distance = ((head & 31) << 8) + packed[from++] + 1;
    if (distance > to || length > n_bytes - to)
      return 0;
    for (size_t i = 0; i < length; i++) /* which may read what it has just written */
      bytes[to + i] = bytes[to + i - distance];
    to += length;
  }
  return to == n_bytes;
}
