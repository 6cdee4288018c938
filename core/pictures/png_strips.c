#include "core/pictures/png_strips.h"

#include "core/base/byte_order.h"
#include "core/files/zip.h"
#include "core/pictures/image_samples.h"

#if CONIC_HAVE_ZLIB || CONIC_HAVE_PNG /* which comes with zlib */
#include <zlib.h>
#define HAS_ZLIB 1
#endif

/* zlib's level: 1024² pixels of the lion take 12 ms so; all filters and level 6 make a file an eighth smaller in 64 ms,
 * no filter a third larger in 14 ms. */
enum { ZIP_LEVEL = 1, ZIP_MEMORY = 8 };

/* Each strip starts to pack anew. So it has as many rows as fill so many bytes, but not so few that converting the one
 * above it again would cost. */
enum { STRIP_BYTES = 1 << 17, LEAST_ROWS = 16 };

/* So many strips, in so many bytes, are packed before their bytes are written. */
enum { STRIPS_A_THREAD = 4, ROUND_BYTES = 1 << 25 };

enum { FILTER_UP = 2, SUM = 4 };

/* What begins zlib's format: a window of 32 KiB, the fastest level. */
static const unsigned char zlib_head[2] = {0x78, 0x01};

/* A strip at work. Its memory serves one after the other. */
typedef struct png_strip {
#ifdef HAS_ZLIB
  z_stream stream;
  int has_stream;
#endif
  unsigned char *rows[2];  /* codes of a row and of the one above */
  unsigned char *filtered; /* all rows, each after its filter's number */
  unsigned char *chunk;    /* length, name, what is packed, and sum */
  size_t n_chunk;          /* 0: it could not be packed */
  uint32_t adler;          /* of what is filtered */
} png_strip;

typedef struct png_strips {
  const conic_image *image;
  conic_samples_layout layout;
  conic_samples_tables tables;
  size_t row_bytes, n_rows, n_strips, chunk_room; /* n_rows: of a strip, but the last */
  size_t first;                                   /* the first of those at work */
  const conic_png_rows *rows;                     /* where they come from; null: from the image */
  unsigned char *codes;                           /* of these, the row above those at work, and theirs */
  png_strip *strips;
} png_strips;

#ifdef HAS_ZLIB

static uint32_t sum_of(const unsigned char *bytes, size_t n) {
  return (uint32_t)crc32(0, bytes, (uInt)n);
}

/* The bytes that n filtered ones become; 0: zlib fails. All but the last strip end with an empty block, so that the
 * next begins with a byte. */
static size_t pack_rows(png_strip *strip, size_t n, unsigned char *to, size_t room, int is_last) {
  strip->stream.next_in = strip->filtered;
  strip->stream.avail_in = (uInt)n;
  strip->stream.next_out = to;
  strip->stream.avail_out = (uInt)room;
  int is_packed = deflateReset(&strip->stream) == Z_OK &&
                  deflate(&strip->stream, is_last ? Z_FINISH : Z_SYNC_FLUSH) == (is_last ? Z_STREAM_END : Z_OK) &&
                  strip->stream.avail_in == 0 && strip->stream.avail_out > 0;
  return is_packed ? strip->stream.total_out : 0;
}

/* The most bytes that pack_rows makes of n; 0: zlib fails. */
static size_t open_strip(png_strip *strip, size_t n) {
  strip->has_stream = deflateInit2(&strip->stream, ZIP_LEVEL, Z_DEFLATED, -MAX_WBITS, ZIP_MEMORY, Z_FILTERED) == Z_OK;
  return strip->has_stream ? deflateBound(&strip->stream, (uLong)n) : 0;
}

static void close_strip(png_strip *strip) {
  if (strip->has_stream)
    deflateEnd(&strip->stream);
}

#else

enum { MOST_STORED = 65535, BLOCK_HEAD = 5 };

static uint32_t sum_of(const unsigned char *bytes, size_t n) {
  return conic_zip_sum(bytes, n);
}

/* Blocks that are stored: whether it is the last one, its length, and that inverted. */
static size_t pack_rows(png_strip *strip, size_t n, unsigned char *to, size_t room, int is_last) {
  unsigned char *at = to;
  (void)room;
  for (size_t done = 0, m; done < n; done += m, at += m) {
    m = n - done < MOST_STORED ? n - done : MOST_STORED;
    *at = is_last && done + m == n;
    conic_store_bits(at + 1, 2, (uint32_t)m);
    conic_store_bits(at + 3, 2, ~(uint32_t)m & 0xffff);
    at += BLOCK_HEAD;
    memcpy(at, strip->filtered + done, m);
  }
  return (size_t)(at - to);
}

static size_t open_strip(png_strip *strip, size_t n) {
  (void)strip;
  return n + BLOCK_HEAD * (n / MOST_STORED + 1);
}

static void close_strip(png_strip *strip) {
  (void)strip;
}

enum { ADLER_BASE = 65521 };

static uint32_t adler32(uint32_t sum, const unsigned char *bytes, size_t n) {
  uint32_t a = sum & 0xffff, b = sum >> 16;
  for (size_t i = 0; i < n; i++) {
    a = (a + bytes[i]) % ADLER_BASE;
    b = (b + a) % ADLER_BASE;
  }
  return b << 16 | a;
}

/* The sum of what has the first sum and then n bytes that have the second. */
static uint32_t adler32_combine(uint32_t first, uint32_t second, long n) {
  uint64_t a = first & 0xffff, b = (first >> 16) + (second >> 16) + (a + ADLER_BASE - 1) * ((uint64_t)n % ADLER_BASE);
  return (uint32_t)(b % ADLER_BASE << 16 | (a + (second & 0xffff) + ADLER_BASE - 1) % ADLER_BASE);
}

#endif

size_t conic_png_close_chunk(unsigned char *chunk, const char *name, size_t n) {
  conic_store_big_32(chunk, (uint32_t)n);
  memcpy(chunk + 4, name, 4);
  conic_store_big_32(chunk + CONIC_PNG_DATA + n, sum_of(chunk + 4, n + 4));
  return CONIC_PNG_DATA + n + SUM;
}

static size_t rows_of(const png_strips *s, size_t i_strip) {
  size_t height = (size_t)s->image->height, first = i_strip * s->n_rows;
  return height - first < s->n_rows ? height - first : s->n_rows;
}

static void convert_row(const png_strips *s, size_t y, unsigned char *to) {
  if (s->codes) {
    memcpy(to, s->codes + (y + 1 - s->first * s->n_rows) * s->row_bytes, s->row_bytes);
    return;
  }
  const float *rgba = s->image->planes[CONIC_PLANE_RGBA];
  size_t width = (size_t)s->image->width;
  conic_samples_row_from_rgba(&s->tables, s->layout, rgba + 4 * width * y, width, to);
}

static void filter_strip(const png_strips *s, size_t i_strip, png_strip *strip) {
  size_t first = i_strip * s->n_rows, n_rows = rows_of(s, i_strip);
  unsigned char *above = strip->rows[0], *row = strip->rows[1], *to = strip->filtered;
  if (first > 0)
    convert_row(s, first - 1, above);
  else
    memset(above, 0, s->row_bytes);
  for (size_t y = 0; y < n_rows; y++) {
    convert_row(s, first + y, row);
    *to++ = FILTER_UP;
    for (size_t i = 0; i < s->row_bytes; i++)
      to[i] = (unsigned char)(row[i] - above[i]);
    to += s->row_bytes;
    unsigned char *done = above;
    above = row;
    row = done;
  }
}

static void pack_strip(void *data, size_t i) {
  png_strips *s = data;
  png_strip *strip = &s->strips[i];
  size_t i_strip = s->first + i, n_bytes = rows_of(s, i_strip) * (s->row_bytes + 1), n_head = 0;
  int is_last = i_strip + 1 == s->n_strips;
  filter_strip(s, i_strip, strip);
  strip->adler = (uint32_t)adler32(1, strip->filtered, (unsigned)n_bytes);
  if (i_strip == 0) {
    memcpy(strip->chunk + CONIC_PNG_DATA, zlib_head, sizeof zlib_head);
    n_head = sizeof zlib_head;
  }
  size_t n_packed = pack_rows(strip, n_bytes, strip->chunk + CONIC_PNG_DATA + n_head,
                              s->chunk_room - CONIC_PNG_DATA - n_head - SUM, is_last);
  strip->n_chunk = n_packed ? conic_png_close_chunk(strip->chunk, "IDAT", n_head + n_packed) : 0;
}

/* Lets the rows of the next n strips be made. */
static conic_status make_rows(png_strips *s, size_t n, size_t n_before) {
  size_t begin = s->first * s->n_rows, height = (size_t)s->image->height;
  size_t end = begin + n * s->n_rows < height ? begin + n * s->n_rows : height;
  conic_status status = CONIC_OK;
  if (!s->rows)
    return CONIC_OK;
  if (begin > 0)
    memcpy(s->codes, s->codes + n_before * s->n_rows * s->row_bytes, s->row_bytes);
  for (size_t y = begin; y < end && status == CONIC_OK; y++)
    status = s->rows->next(s->rows->cookie, (int)y, s->codes + (y + 1 - begin) * s->row_bytes);
  return status;
}

/* Packs the next n strips and writes them. */
static conic_status write_round(conic_context *context, png_strips *s, size_t n, FILE *to, uint32_t *adler) {
  conic_parallel_for(context, n, pack_strip, s);
  for (size_t i = 0; i < n; i++) {
    const png_strip *strip = &s->strips[i];
    size_t n_bytes = rows_of(s, s->first + i) * (s->row_bytes + 1);
    if (!strip->n_chunk)
      return conic_fail(context, CONIC_ERROR_MEMORY, "zlib packs no PNG");
    *adler = (uint32_t)adler32_combine(*adler, strip->adler, (long)n_bytes);
    fwrite(strip->chunk, 1, strip->n_chunk, to);
  }
  s->first += n;
  return CONIC_OK;
}

static conic_status open_strips(conic_context *context, png_strips *s, size_t n) {
  conic_status status = conic_memory_allocate_these(context, CONIC_ZEROED(s->strips, n));
  size_t filtered_bytes = s->n_rows * (s->row_bytes + 1);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    png_strip *strip = &s->strips[i];
    s->chunk_room = open_strip(strip, filtered_bytes);
    if (!s->chunk_room)
      return CONIC_ERROR_MEMORY;
    s->chunk_room += 64; /* for what stands about it */
    status = conic_memory_allocate_these(
        context, CONIC_ROOM(strip->rows[0], s->row_bytes), CONIC_ROOM(strip->rows[1], s->row_bytes),
        CONIC_ROOM(strip->filtered, filtered_bytes), CONIC_ROOM(strip->chunk, s->chunk_room));
  }
  return status;
}

conic_status conic_png_write_strips(conic_context *context, const conic_image *image, conic_tone tone,
                                    const conic_png_rows *rows, FILE *to) {
  png_strips s = {
      .image = image,
      .rows = rows,
      .layout = {
          .n_channels = 4, .sample_bytes = 1, .is_straight = 1, .is_display = image->is_display != 0, .tone = tone}};
  unsigned char end[CONIC_PNG_DATA + 4 + SUM];
  uint32_t adler = 1;
  s.row_bytes = 4 * (size_t)image->width;
  s.n_rows = STRIP_BYTES / (s.row_bytes + 1) + 1;
  s.n_rows = s.n_rows > LEAST_ROWS ? s.n_rows : LEAST_ROWS;
  s.n_rows = s.n_rows < (size_t)image->height ? s.n_rows : (size_t)image->height;
  s.n_strips = ((size_t)image->height + s.n_rows - 1) / s.n_rows;
  size_t n_a_round = STRIPS_A_THREAD * (size_t)conic_context_threads(context);
  size_t most = ROUND_BYTES / (s.n_rows * (s.row_bytes + 1)) + 1;
  n_a_round = n_a_round < most ? n_a_round : most;
  n_a_round = n_a_round < s.n_strips ? n_a_round : s.n_strips;
  conic_samples_tables_fill(&s.tables);
  conic_status status = open_strips(context, &s, n_a_round);
  if (status == CONIC_OK && rows)
    status = conic_memory_allocate_these(context, CONIC_ROOM(s.codes, (n_a_round * s.n_rows + 1) * s.row_bytes));
  while (status == CONIC_OK && s.first < s.n_strips) {
    size_t left = s.n_strips - s.first;
    status = conic_progress(context, "write", (double)s.first / (double)s.n_strips);
    left = left < n_a_round ? left : n_a_round;
    if (status == CONIC_OK)
      status = make_rows(&s, left, n_a_round);
    if (status == CONIC_OK)
      status = write_round(context, &s, left, to, &adler);
  }
  if (status == CONIC_OK) { /* which is known last, in a chunk of its own */
    conic_store_big_32(end + CONIC_PNG_DATA, (uint32_t)adler);
    fwrite(end, 1, conic_png_close_chunk(end, "IDAT", 4), to);
  }
  for (size_t i = 0; s.strips && i < n_a_round; i++) {
    png_strip *strip = &s.strips[i];
    close_strip(strip);
    conic_memory_release_these(context, strip->rows[0], strip->rows[1], strip->filtered, strip->chunk);
  }
  conic_memory_release(context, s.strips);
  conic_memory_release(context, s.codes);
  return status;
}
