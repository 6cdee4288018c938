/* The size that a picture's header gives, in formats that OpenImageIO decodes, or takes memory for, as soon as it opens
 * them. */

#include "core/base/byte_order.h"
#include "core/files/disk.h"
#include "core/pictures/image_foreign.h"

/* Goes from segment to segment up to the frame's header: markers C0 to CF without C4 (tables), C8 and CC. */
static int find_jpeg_size(FILE *file, int *width, int *height) {
  unsigned char segment[9]; /* FF, marker, length of the rest, bits of a sample, height, width */
  long at = 2;
  while (fseek(file, at, SEEK_SET) == 0 && fread(segment, 1, sizeof segment, file) == sizeof segment) {
    int marker = segment[1];
    if (segment[0] != 0xff)
      return 0;
    if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) {
      *height = conic_load_big_16(segment + 5);
      *width = conic_load_big_16(segment + 7);
      return 1;
    }
    if (marker == 0xff) /* a fill byte */
      at++;
    else
      at += 2 + (marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8) ? 0 : conic_load_big_16(segment + 2));
  }
  return 0;
}

/* The first chunk is lossy, lossless, or extended; an extended one gives the size of the whole. */
static int find_webp_size(const unsigned char *start, int *width, int *height) {
  const unsigned char *chunk = start + 12, *data = chunk + 8;
  if (memcmp(chunk, "VP8 ", 4) == 0) {
    *width = conic_load_16(data + 6) & 0x3fff;
    *height = conic_load_16(data + 8) & 0x3fff;
  } else if (memcmp(chunk, "VP8L", 4) == 0) {
    *width = 1 + (conic_load_16(data + 1) & 0x3fff);
    *height = 1 + (data[2] >> 6 | data[3] << 2 | (data[4] & 0x0f) << 10);
  } else if (memcmp(chunk, "VP8X", 4) == 0) {
    *width = 1 + (int)conic_load_bits(data + 4, 3);
    *height = 1 + (int)conic_load_bits(data + 7, 3);
  } else
    return 0;
  return 1;
}

int conic_foreign_size(const char *path, int *width, int *height) {
  unsigned char start[30] = {0};
  int is_found = 0;
  FILE *file = conic_disk_open_stream(path, "rb");
  size_t n = file ? fread(start, 1, sizeof start, file) : 0;
  if (n >= 10 && memcmp(start, "GIF8", 4) == 0) {
    *width = conic_load_16(start + 6);
    *height = conic_load_16(start + 8);
    is_found = 1;
  } else if (n >= 10 && memcmp(start, "\xff\xd8\xff", 3) == 0)
    is_found = find_jpeg_size(file, width, height);
  else if (n == sizeof start && memcmp(start, "RIFF", 4) == 0 && memcmp(start + 8, "WEBP", 4) == 0)
    is_found = find_webp_size(start, width, height);
  if (file)
    fclose(file);
  return is_found && *width > 0 && *height > 0;
}
