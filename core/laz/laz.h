/* LAZ, the packed points of LASzip: a decoder of chunks that lie in memory.
 *
 * Points come out as the records of a LAS file, byte for byte. Formats 0 to 5 are packed point after point (LASzip's
 * compressors 1 and 2, items of version 2, waveforms of version 1). Formats 6 to 10 are packed in layers (compressor 3,
 * items of versions 3 and 4); unwanted layers are skipped. The result of a spoiled chunk means nothing, but decoding
 * ends, and memory is bounded by the chunk's own size. */
#pragma once

#include "core/files/input.h"

/* Chunks have several sizes: the table counts their points. */
#define CONIC_LAZ_VARIABLE UINT32_MAX

/* How a file's points are packed, from LASzip's record ("laszip encoded", 22204). */
typedef struct conic_laz_format {
  unsigned compressor;   /* 1: one chunk, 2: chunks, 3: chunks of layers */
  unsigned point_format; /* of LAS, 0 to 10 */
  size_t point_bytes, n_extra;
  uint32_t chunk_points; /* or CONIC_LAZ_VARIABLE; the last chunk may have fewer */
  unsigned point_version, color_version, wave_version, extra_version; /* versions of the items in layers, 3 or 4 */
} conic_laz_format;

/* Reads that record, without its header, for points of that format. Faults are logged after `name`; null: not logged.
 * Errors: INPUT. */
conic_status conic_laz_format_read(conic_context *context, const char *name, const unsigned char *record,
                                   size_t n_bytes, unsigned point_format, size_t point_bytes, conic_laz_format *format);

/* Wanted fields of points in layers, besides x, y and the returns. All other fields keep the values of the chunk's
 * first point. */
enum {
  CONIC_LAZ_Z = 1,
  CONIC_LAZ_CLASSIFICATION = 2,
  CONIC_LAZ_FLAGS = 4,
  CONIC_LAZ_INTENSITY = 8,
  CONIC_LAZ_SCAN_ANGLE = 16,
  CONIC_LAZ_USER_DATA = 32,
  CONIC_LAZ_POINT_SOURCE = 64,
  CONIC_LAZ_GPS_TIME = 128,
  CONIC_LAZ_COLORS = 256,
  CONIC_LAZ_NIR = 512,
  CONIC_LAZ_WAVE_PACKET = 1024,
  CONIC_LAZ_EXTRA = 2048,
  CONIC_LAZ_ALL = 4095
};

/* The state of decoding one chunk, and memory that the next chunk uses again. One thread at a time. */
typedef struct conic_laz_decoder conic_laz_decoder;

/* On success the caller destroys *decoder. Destroying null is allowed. Errors: MEMORY. */
conic_status conic_laz_decoder_create(conic_context *context, conic_laz_decoder **decoder);
void conic_laz_decoder_destroy(conic_laz_decoder *decoder);

/* Begins a chunk of so many points. Format and bytes must outlive the decoding. Only lack of memory is logged. Errors:
 * INPUT (the chunk is spoiled), MEMORY. */
conic_status conic_laz_begin(conic_laz_decoder *decoder, const conic_laz_format *format, const unsigned char *bytes,
                             size_t n_bytes, uint64_t n_points, unsigned wanted);

/* Decodes the next n points, at most as many as are left, into records of format->point_bytes. Errors: as begin. */
conic_status conic_laz_next(conic_laz_decoder *decoder, size_t n, unsigned char *records);

/* Decodes a whole chunk: begin, and next for all points. Errors: as begin. */
conic_status conic_laz_decode(conic_laz_decoder *decoder, const conic_laz_format *format, const unsigned char *bytes,
                              size_t n_bytes, size_t n_points, unsigned wanted, unsigned char *records);

/* For files without a table: how many bytes of the chunk have been used. After the last point, the next chunk begins
 * there. */
size_t conic_laz_taken(const conic_laz_decoder *decoder);

/* For points that are not in layers: continues with other bytes, which begin at the first unused one. conic_laz_taken
 * counts from there. */
void conic_laz_feed(conic_laz_decoder *decoder, const unsigned char *bytes, size_t n_bytes);

/* The most bytes that n points of such a chunk take. */
static inline size_t conic_laz_most_bytes(const conic_laz_format *format, size_t n) {
  return (n + 1) * (2 * format->point_bytes + 64);
}

/* For points in layers: the length of a chunk's head; and, from the bytes of that head, the whole chunk's length and
 * its number of points. */
size_t conic_laz_head_bytes(const conic_laz_format *format);
uint64_t conic_laz_layered_bytes(const conic_laz_format *format, const unsigned char *head);
uint32_t conic_laz_layered_points(const conic_laz_format *format, const unsigned char *head);

/* Reads the points of a LAZ file chunk by chunk; many at once, on all threads, where the file's table says where they
 * are. */

/* Takes records, which are valid during the call only. An answer other than CONIC_OK ends the reading with that
 * status. */
typedef conic_status conic_laz_receiver(void *cookie, const unsigned char *records, size_t n);

/* Hands over, in their order, the points from number `first` to before `end` of n_points. The input is at the offset of
 * the points in the header. A file that ends early is read as far as its chunks are whole; a file without its table is
 * read, too. Both are logged unless `is_again`. A pipe is kept in memory. Errors: INPUT (a chunk is spoiled, or there
 * are no points), MEMORY, CANCELLED, the receiver's. */
conic_status conic_laz_read(conic_input *input, const conic_laz_format *format, uint64_t n_points, uint64_t first,
                            uint64_t end, unsigned wanted, int is_again, conic_laz_receiver *receive, void *cookie);
