/* LAZ, the packed points of LASzip: a decoder of chunks that lie in memory.
 *
 * Points come out as the records of a LAS file, byte for byte. Formats 0 to 5 are packed point after point (LASzip's
 * compressors 1 and 2, items of version 2, waveforms of version 1), 6 to 10 in layers (compressor 3, items of versions
 * 3 and 4), of which those that nobody wants are passed over. What a spoiled chunk decodes to means nothing, but it
 * ends, and memory is bounded by the chunk's own size. */
#ifndef CONIC_LAZ_H
#define CONIC_LAZ_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

/* Where the points of chunks of several sizes are counted: in the table. */
#define CONIC_LAZ_VARIABLE UINT32_MAX

/* How a file's points are packed: what its record of LASzip's says ("laszip encoded", 22204). */
typedef struct conic_laz_format {
  unsigned compressor;   /* 1: one chunk, 2: chunks, 3: chunks of layers */
  unsigned point_format; /* of LAS, 0 to 10 */
  size_t point_bytes, n_extra;
  uint32_t chunk_points; /* or CONIC_LAZ_VARIABLE; the last chunk may have fewer */
  unsigned point_version, color_version, wave_version, extra_version; /* of the items, 3 or 4, of layers */
} conic_laz_format;

/* Reads that record, without its header, for points of that format. What is wrong with it stands in the log, after
 * `name`; null: nothing is said. Errors: INPUT. */
conic_status conic_laz_format_read(conic_context *context, const char *name, const unsigned char *record,
                                   size_t n_bytes, unsigned point_format, size_t point_bytes, conic_laz_format *format);

/* What is wanted of points in layers besides x, y and the returns: whatever else is packed in them stays as the chunk's
 * first point has it. */
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

/* The state of decoding one chunk, and memory that is kept for the next. One thread at a time uses it. */
typedef struct conic_laz_decoder conic_laz_decoder;

/* On success the caller destroys *decoder; null is allowed there. Errors: MEMORY. */
conic_status conic_laz_decoder_create(conic_context *context, conic_laz_decoder **decoder);
void conic_laz_decoder_destroy(conic_laz_decoder *decoder);

/* Begins with a chunk of so many points. Format and bytes must outlive the decoding. Nothing is logged but want of
 * memory. Errors: INPUT (the chunk is spoiled), MEMORY. */
conic_status conic_laz_begin(conic_laz_decoder *decoder, const conic_laz_format *format, const unsigned char *bytes,
                             size_t n_bytes, uint64_t n_points, unsigned wanted);

/* The next n points, of as many as are left at most, as records of format->point_bytes. Errors: as begin. */
conic_status conic_laz_next(conic_laz_decoder *decoder, size_t n, unsigned char *records);

/* begin, and next for all of them. Errors: as begin. */
conic_status conic_laz_decode(conic_laz_decoder *decoder, const conic_laz_format *format, const unsigned char *bytes,
                              size_t n_bytes, size_t n_points, unsigned wanted, unsigned char *records);

/* Where no table says how long a chunk is. The bytes of it that have been used: what follows the last point's is the
 * next chunk. */
size_t conic_laz_taken(const conic_laz_decoder *decoder);

/* Of points that do not lie in layers: goes on with other bytes, the first of which is the first that has not been
 * used. conic_laz_taken counts from there. */
void conic_laz_feed(conic_laz_decoder *decoder, const unsigned char *bytes, size_t n_bytes);

/* How many bytes of such a chunk n points take at most. */
static inline size_t conic_laz_most_bytes(const conic_laz_format *format, size_t n) {
  return (n + 1) * (2 * format->point_bytes + 64);
}

/* Of points in layers: how long a chunk is whose first bytes these are, head included: conic_laz_head_bytes of them. */
size_t conic_laz_head_bytes(const conic_laz_format *format);
uint64_t conic_laz_layered_bytes(const conic_laz_format *format, const unsigned char *head);
uint32_t conic_laz_layered_points(const conic_laz_format *format, const unsigned char *head);

#endif
