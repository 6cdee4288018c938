/* PNG files made by hand, of every kind that there is: without compression, by the format's own layout. */
#pragma once

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The numbers of the format. */
enum { PNG_GREY = 0, PNG_COLOR = 2, PNG_BY_PALETTE = 3, PNG_GREY_ALPHA = 4, PNG_COLOR_ALPHA = 6 };

typedef struct png_kind {
  uint32_t width, height;
  int kind, depth, is_interlaced;
  int has_transparency; /* tRNS: of the palette's first two colours, or the colour of pixel (0, 0) */
  int has_gamma;        /* gAMA, that of linear light; with 2 after sRGB, as most programs have it */
} png_kind;

typedef struct png_file {
  unsigned char bytes[1 << 16];
  size_t n_bytes;
} png_file;

static inline int png_n_channels(int kind) {
  return kind == PNG_GREY || kind == PNG_BY_PALETTE ? 1 : kind == PNG_GREY_ALPHA ? 2 : kind == PNG_COLOR ? 3 : 4;
}

/* Sample `c` of a pixel, of as many bits as the file has. */
static inline unsigned png_sample(const png_kind *kind, uint32_t x, uint32_t y, int c) {
  unsigned value = 40503u * (x * 7 + y * 31 + (unsigned)c * 3 + 1) + 60493u * x * y;
  return kind->kind == PNG_BY_PALETTE ? (x + y) % (kind->depth == 1 ? 2 : 3) : value & ((1u << kind->depth) - 1);
}

/* Colour `c` of entry `i` of the palette. */
static inline unsigned png_entry(unsigned i, int c) {
  return (37u * i + 90u * (unsigned)c + 11u) & 255u;
}

static inline void png_put(unsigned char *to, uint32_t value) {
  for (int i = 0; i < 4; i++)
    to[i] = (unsigned char)(value >> (24 - 8 * i));
}

static inline void png_chunk(png_file *file, const char *name, const void *bytes, size_t n_bytes) {
  unsigned char *to = file->bytes + file->n_bytes;
  uint32_t crc = 0xFFFFFFFFu;
  if (file->n_bytes + n_bytes + 12 > sizeof file->bytes)
    exit(1);
  png_put(to, (uint32_t)n_bytes);
  memcpy(to + 4, name, 4);
  if (n_bytes)
    memcpy(to + 8, bytes, n_bytes);
  for (size_t i = 4; i < 8 + n_bytes; i++) {
    crc ^= to[i];
    for (int bit = 0; bit < 8; bit++)
      crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
  }
  png_put(to + 8 + n_bytes, ~crc);
  file->n_bytes += n_bytes + 12;
}

/* The rows of every `dx`-th pixel from x on and every `dy`-th row from y on, each after its filter, which is none. */
static inline size_t png_rows(const png_kind *kind, unsigned char *to, uint32_t x, uint32_t y, uint32_t dx,
                              uint32_t dy) {
  size_t n = 0;
  for (; y < kind->height && x < kind->width; y += dy) {
    unsigned bit = 0;
    to[n++] = 0;
    for (uint32_t at = x; at < kind->width; at += dx)
      for (int c = 0; c < png_n_channels(kind->kind); c++) {
        unsigned value = png_sample(kind, at, y, c);
        if (kind->depth >= 8) {
          if (kind->depth == 16)
            to[n++] = (unsigned char)(value >> 8);
          to[n++] = (unsigned char)value;
          continue;
        }
        if (bit == 0)
          to[n++] = 0;
        to[n - 1] = (unsigned char)(to[n - 1] | value << (8 - (unsigned)kind->depth - bit));
        bit = (bit + (unsigned)kind->depth) % 8;
      }
  }
  return n;
}

/* The picture's data: one stored block of zlib's. */
static inline void png_data(png_file *file, const png_kind *kind) {
  static const uint32_t passes[7][4] = {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4},
                                        {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}};
  static unsigned char bytes[1 << 15];
  size_t n = 0;
  uint32_t low = 1, high = 0;
  unsigned char *rows = bytes + 7;
  if (!kind->is_interlaced)
    n = png_rows(kind, rows, 0, 0, 1, 1);
  for (int i = 0; kind->is_interlaced && i < 7; i++)
    n += png_rows(kind, rows + n, passes[i][0], passes[i][1], passes[i][2], passes[i][3]);
  for (size_t i = 0; i < n; i++) {
    low = (low + rows[i]) % 65521;
    high = (high + low) % 65521;
  }
  const unsigned char head[] = {
      0x78, 0x01, 1, (unsigned char)n, (unsigned char)(n >> 8), (unsigned char)~n, (unsigned char)(~n >> 8)};
  memcpy(bytes, head, sizeof head);
  png_put(rows + n, high << 16 | low);
  png_chunk(file, "IDAT", bytes, n + 11);
}

static inline void png_transparency(png_file *file, const png_kind *kind) {
  unsigned char bytes[6] = {0, 100};
  int n = png_n_channels(kind->kind);
  for (int c = 0; kind->kind != PNG_BY_PALETTE && c < n; c++) {
    bytes[2 * c] = (unsigned char)(png_sample(kind, 0, 0, c) >> 8);
    bytes[2 * c + 1] = (unsigned char)png_sample(kind, 0, 0, c);
  }
  png_chunk(file, "tRNS", bytes, kind->kind == PNG_BY_PALETTE ? 2 : 2 * (size_t)n);
}

static inline void png_make(png_file *file, const png_kind *kind) {
  unsigned char header[13] = {0}, gamma[4], palette[9];
  file->n_bytes = 8;
  memcpy(file->bytes, "\x89PNG\r\n\x1a\n", 8);
  png_put(header, kind->width);
  png_put(header + 4, kind->height);
  header[8] = (unsigned char)kind->depth;
  header[9] = (unsigned char)kind->kind;
  header[12] = (unsigned char)kind->is_interlaced;
  png_chunk(file, "IHDR", header, sizeof header);
  png_put(gamma, kind->has_gamma > 1 ? 45455 : 100000);
  if (kind->has_gamma > 1)
    png_chunk(file, "sRGB", "", 1);
  if (kind->has_gamma)
    png_chunk(file, "gAMA", gamma, sizeof gamma);
  for (unsigned i = 0; i < 9; i++)
    palette[i] = (unsigned char)png_entry(i / 3, (int)(i % 3));
  if (kind->kind == PNG_BY_PALETTE)
    png_chunk(file, "PLTE", palette, kind->depth == 1 ? 6 : 9);
  if (kind->has_transparency)
    png_transparency(file, kind);
  png_data(file, kind);
  png_chunk(file, "IEND", NULL, 0);
}
