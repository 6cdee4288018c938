#include "core/pictures/tiff_tiles.h"

#include "core/base/byte_order.h"
#include "core/files/file.h"

#if CONIC_HAVE_ZLIB
#include <zlib.h>
enum { ZIP_LEVEL = 2 };
#endif

enum { TILE = CONIC_TIFF_TILE };

/* TIFF's types of numbers, and their bytes. */
typedef enum tiff_type { ASCII = 2, SHORT = 3, LONG = 4, RATIONAL = 5, DOUBLE = 12, LONG8 = 16 } tiff_type;

/* Numbers in the file; their meaning is noted where they are used. */
enum { COMPRESSION_NONE = 1, COMPRESSION_DEFLATE = 8, PREDICTOR_NONE = 1, PREDICTOR_HORIZONTAL = 2 };
enum { RGB = 2, BLACK_IS_ZERO = 1, UNASSOCIATED_ALPHA = 2, SAMPLES_ARE_FLOATS = 3 };

/* The most bytes of a picture with offsets of 32 bits; the rest is for tags and the worst of packing. */
#define MOST_CLASSIC_BYTES UINT64_C(0xE0000000)

struct conic_tiff {
  conic_context *context;
  const char *path;
  conic_tiff_layout layout;
  conic_output *output;
  FILE *file;
  int is_big;        /* BigTIFF: offsets of 64 bits */
  uint64_t at;       /* bytes written */
  uint64_t *offsets; /* of each tile … */
  uint64_t *n_bytes; /* … and its length */
  size_t n_tiles, next_tile;
  unsigned char *packed; /* room for a tile */
  size_t packed_room;
};

size_t conic_tiff_pixel_bytes(const conic_tiff_layout *layout) {
  return layout->is_elevation ? sizeof(float) : 4;
}

static void put_bytes(conic_tiff *tiff, const void *bytes, size_t n_bytes) {
  if (n_bytes)
    fwrite(bytes, 1, n_bytes, tiff->file); /* the stream reports failures at the end */
  tiff->at += n_bytes;
}

static void put_tiff_number(conic_tiff *tiff, uint64_t number, size_t n_bytes) {
  unsigned char bytes[8];
  conic_store_bits(bytes, n_bytes, number);
  put_bytes(tiff, bytes, n_bytes);
}

static void put_tiff_head(conic_tiff *tiff) {
  put_bytes(tiff, "II", 2);
  put_tiff_number(tiff, tiff->is_big ? 43 : 42, 2);
  if (tiff->is_big)
    put_tiff_number(tiff, 8, 4); /* bytes of an offset, and nothing */
  put_tiff_number(tiff, 0, tiff->is_big ? 8 : 4);
}

static conic_status make_tables(conic_tiff *tiff) {
  size_t tile_bytes = (size_t)TILE * TILE * conic_tiff_pixel_bytes(&tiff->layout);
  tiff->packed_room = tile_bytes + tile_bytes / 8 + 1024;
  return conic_memory_allocate_these(tiff->context, CONIC_ZEROED(tiff->offsets, tiff->n_tiles),
                                     CONIC_ZEROED(tiff->n_bytes, tiff->n_tiles),
                                     CONIC_ROOM(tiff->packed, tiff->packed_room));
}

conic_status conic_tiff_open(conic_context *context, const char *path, const conic_tiff_layout *layout,
                             conic_tiff **tiff) {
  uint64_t columns = (layout->width + TILE - 1) / TILE, rows = (layout->height + TILE - 1) / TILE;
  *tiff = NULL;
  if (strcmp(path, "-") == 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "a TIFF in tiles goes into a file, not to standard output");
  if (layout->width == 0 || layout->height == 0 || layout->width > INT32_MAX || layout->height > INT32_MAX ||
      columns > UINT32_MAX / rows)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: no TIFF has %llu x %llu pixels", path,
                      (unsigned long long)layout->width, (unsigned long long)layout->height);
  conic_tiff *t = conic_memory_allocate_zeroed(context, 1, sizeof *t);
  if (!t)
    return CONIC_ERROR_MEMORY;
  t->context = context;
  t->path = path;
  t->layout = *layout;
  t->n_tiles = (size_t)(columns * rows);
  t->is_big = columns * rows * TILE * TILE * conic_tiff_pixel_bytes(layout) > MOST_CLASSIC_BYTES;
  conic_status status = make_tables(t);
  if (status == CONIC_OK)
    status = conic_output_open(context, path, &t->output);
  if (status != CONIC_OK)
    return conic_tiff_end(t, status);
  t->file = conic_output_stream(t->output);
  put_tiff_head(t);
  *tiff = t;
  return CONIC_OK;
}

#if CONIC_HAVE_ZLIB

/* Replaces each pixel's bytes by their differences from the pixel to the left. */
static void take_differences(const conic_tiff *tiff, unsigned char *pixels) {
  for (size_t y = 0; y < TILE && !tiff->layout.is_elevation; y++) {
    unsigned char *row = pixels + (size_t)4 * TILE * y;
    for (size_t i = (size_t)4 * TILE; i-- > 4;)
      row[i] = (unsigned char)(row[i] - row[i - 4]);
  }
}

static const unsigned char *pack_tile(conic_tiff *tiff, unsigned char *pixels, size_t *n_bytes) {
  uLongf n = (uLongf)tiff->packed_room;
  take_differences(tiff, pixels);
  if (compress2(tiff->packed, &n, pixels, (uLong)*n_bytes, ZIP_LEVEL) != Z_OK)
    return NULL;
  *n_bytes = n;
  return tiff->packed;
}

static const uint16_t compression = COMPRESSION_DEFLATE;

#else

static const unsigned char *pack_tile(conic_tiff *tiff, unsigned char *pixels, size_t *n_bytes) {
  (void)tiff;
  (void)n_bytes;
  return pixels;
}

static const uint16_t compression = COMPRESSION_NONE;

#endif

conic_status conic_tiff_append(conic_tiff *tiff, void *pixels) {
  size_t n_bytes = (size_t)TILE * TILE * conic_tiff_pixel_bytes(&tiff->layout);
  if (tiff->layout.is_elevation)
    conic_turn_words(pixels, (size_t)TILE * TILE, sizeof(float));
  const unsigned char *bytes = pack_tile(tiff, pixels, &n_bytes);
  if (!bytes)
    return conic_fail(tiff->context, CONIC_ERROR_MEMORY, "%s: cannot write: a tile cannot be compressed", tiff->path);
  tiff->offsets[tiff->next_tile] = tiff->at;
  tiff->n_bytes[tiff->next_tile++] = n_bytes;
  put_bytes(tiff, bytes, n_bytes);
  return ferror(tiff->file) ? conic_fail(tiff->context, CONIC_ERROR_IO, "%s: cannot write", tiff->path) : CONIC_OK;
}

/* --- tags --- */

/* A tag's numbers are in the directory if they fit, else before it in the file; their place is noted as they are
 * written. */
typedef struct tiff_tag {
  uint16_t tag;
  tiff_type type;
  uint64_t count;
  unsigned char bytes[8]; /* the numbers, or their place */
} tiff_tag;

enum { MOST_TAGS = 24 };

typedef struct tiff_directory {
  conic_tiff *tiff;
  tiff_tag tags[MOST_TAGS];
  size_t n;
} tiff_directory;

static size_t type_bytes(tiff_type type) {
  return type == ASCII ? 1 : type == SHORT ? 2 : type == LONG ? 4 : 8;
}

/* Adds a tag; its numbers are in the machine's order, of uint8_t, uint16_t, uint32_t or 64 bits. */
static void add_tag(tiff_directory *d, unsigned tag, tiff_type type, size_t count, const void *numbers) {
  conic_tiff *tiff = d->tiff;
  size_t step = type_bytes(type), room = tiff->is_big ? 8 : 4;
  tiff_tag *to = &d->tags[d->n++];
  *to = (tiff_tag){.tag = (uint16_t)tag, .type = type, .count = count};
  int is_within = count * step <= room;
  if (!is_within)
    conic_store_64(to->bytes, tiff->at);
  for (size_t i = 0; i < count; i++) {
    unsigned char bytes[8];
    memcpy(bytes, (const unsigned char *)numbers + step * i, step);
    conic_turn_words(bytes, 1, step);
    if (is_within)
      memcpy(to->bytes + step * i, bytes, step);
    else
      put_bytes(tiff, bytes, step);
  }
  if (!is_within && tiff->at % 2)
    put_tiff_number(tiff, 0, 1); /* the next data begin at an even byte */
}

static void add_short(tiff_directory *d, unsigned tag, unsigned value) {
  const uint16_t number = (uint16_t)value;
  add_tag(d, tag, SHORT, 1, &number);
}

static void add_long(tiff_directory *d, unsigned tag, uint64_t value) {
  const uint32_t number = (uint32_t)value;
  add_tag(d, tag, LONG, 1, &number);
}

/* Adds the tiles' places or lengths, in the file's number of bits. */
static void add_table(tiff_directory *d, unsigned tag, uint64_t *table) {
  size_t n = d->tiff->n_tiles;
  uint32_t *narrow = (uint32_t *)table;
  if (!d->tiff->is_big)
    for (size_t i = 0; i < n; i++) {
      uint32_t number = (uint32_t)table[i];
      memcpy((unsigned char *)narrow + sizeof number * i, &number, sizeof number);
    }
  add_tag(d, tag, d->tiff->is_big ? LONG8 : LONG, n, table);
}

static void add_pixel_tags(tiff_directory *d) {
  const conic_tiff_layout *layout = &d->tiff->layout;
  static const uint16_t eight[] = {8, 8, 8, 8};
  const uint16_t thirty_two = 32;
  int is_elevation = layout->is_elevation, is_packed = compression != COMPRESSION_NONE;
  add_long(d, 256, layout->width);
  add_long(d, 257, layout->height);
  add_tag(d, 258, SHORT, is_elevation ? 1 : 4, is_elevation ? &thirty_two : eight); /* bits a sample */
  add_short(d, 259, compression);
  add_short(d, 262, is_elevation ? BLACK_IS_ZERO : RGB);
  if (layout->description)
    add_tag(d, 270, ASCII, strlen(layout->description) + 1, layout->description);
  add_short(d, 277, is_elevation ? 1 : 4); /* samples a pixel, */
  if (layout->dpi > 0.0) {
    const uint64_t a_hundred_inches = (uint64_t)(layout->dpi * 100.0 + 0.5) | UINT64_C(100) << 32;
    add_tag(d, 282, RATIONAL, 1, &a_hundred_inches);
    add_tag(d, 283, RATIONAL, 1, &a_hundred_inches);
  }
  add_short(d, 284, 1); /* side by side */
  if (layout->dpi > 0.0)
    add_short(d, 296, 2); /* of an inch */
  add_short(d, 317, is_packed && !is_elevation ? PREDICTOR_HORIZONTAL : PREDICTOR_NONE);
  add_short(d, 322, TILE);
  add_short(d, 323, TILE);
  add_table(d, 324, d->tiff->offsets);
  add_table(d, 325, d->tiff->n_bytes);
  if (is_elevation)
    add_short(d, 339, SAMPLES_ARE_FLOATS);
  else
    add_short(d, 338, UNASSOCIATED_ALPHA);
}

/* The place of the picture's upper left corner, and the size of its pixels, which are areas. */
static void add_place_tags(tiff_directory *d) {
  const conic_tiff_layout *layout = &d->tiff->layout;
  const conic_georeference *reference = layout->reference;
  static const uint16_t only_areas[] = {1, 1, 0, 1, 1025, 0, 1, 1};
  const double scale[3] = {layout->pixel, layout->pixel, 0.0};
  const double tie[6] = {0.0, 0.0, 0.0, layout->corner[0], layout->corner[1], 0.0};
  int is_known = reference && reference->keys;
  add_tag(d, 33550, DOUBLE, 3, scale);
  add_tag(d, 33922, DOUBLE, 6, tie);
  add_tag(d, 34735, SHORT, is_known ? reference->n_keys : 8, is_known ? reference->keys : only_areas);
  if (is_known && reference->n_numbers)
    add_tag(d, 34736, DOUBLE, reference->n_numbers, reference->numbers);
  if (is_known && reference->n_text)
    add_tag(d, 34737, ASCII, reference->n_text, reference->text);
}

static void put_directory(const tiff_directory *d) {
  conic_tiff *tiff = d->tiff;
  put_tiff_number(tiff, d->n, tiff->is_big ? 8 : 2);
  for (size_t i = 0; i < d->n; i++) {
    const tiff_tag *tag = &d->tags[i];
    put_tiff_number(tiff, tag->tag, 2);
    put_tiff_number(tiff, (uint64_t)tag->type, 2);
    put_tiff_number(tiff, tag->count, tiff->is_big ? 8 : 4);
    put_bytes(tiff, tag->bytes, tiff->is_big ? 8 : 4);
  }
  put_tiff_number(tiff, 0, tiff->is_big ? 8 : 4); /* there is no other picture */
}

static void put_tags(conic_tiff *tiff) {
  tiff_directory directory = {.tiff = tiff};
  char nodata[32];
  if (tiff->at % 2)
    put_tiff_number(tiff, 0, 1);
  add_pixel_tags(&directory);
  if (!(tiff->layout.dpi > 0.0))
    add_place_tags(&directory);
  if (tiff->layout.is_elevation) { /* as GDAL reads it */
    int n = snprintf(nodata, sizeof nodata, "%.9g", tiff->layout.nodata);
    add_tag(&directory, 42113, ASCII, (size_t)n + 1, nodata);
  }
  uint64_t at = tiff->at;
  put_directory(&directory);
  if (fseeko(tiff->file, tiff->is_big ? 8 : 4, SEEK_SET) == 0)
    put_tiff_number(tiff, at, tiff->is_big ? 8 : 4);
}

conic_status conic_tiff_end(conic_tiff *tiff, conic_status status) {
  if (!tiff)
    return status;
  if (status == CONIC_OK)
    put_tags(tiff);
  status = conic_output_end(tiff->output, status);
  conic_memory_release_these(tiff->context, tiff->offsets, tiff->n_bytes, tiff->packed, tiff);
  return status;
}
