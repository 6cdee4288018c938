/* LAZ within hierarchies: a chunk, or a whole file, of points. */
#include "lod/hierarchies/hierarchy.h"

#include "core/base/byte_order.h"
#include "core/laz/laz.h"

enum {
  RECORD_HEADER = 54,
  LEAST_HEADER = 227,
  AT_LAZ_HEADER_BYTES = 94,
  AT_LAZ_POINTS = 96,
  AT_LAZ_N_RECORDS = 100,
  AT_LAZ_FORMAT = 104,
  AT_LAZ_POINT_BYTES = 105,
  AT_LAZ_COUNT = 107,
  AT_LAZ_SCALE = 131,
  AT_LAZ_OFFSET = 155,
  LASZIP_RECORD = 22204
};

/* What drawing wants of points. */
enum { WANTED = CONIC_LAZ_Z | CONIC_LAZ_INTENSITY | CONIC_LAZ_COLORS };

/* The record that says how points are packed; null where there is none. */
static const unsigned char *find_record(const unsigned char *bytes, size_t n_bytes, size_t *n_record) {
  size_t at = (size_t)conic_load_bits(bytes + AT_LAZ_HEADER_BYTES, 2);
  uint64_t n_records = conic_load_bits(bytes + AT_LAZ_N_RECORDS, 4);
  for (uint64_t i = 0; i < n_records && at <= n_bytes && n_bytes - at >= RECORD_HEADER; i++) {
    *n_record = (size_t)conic_load_bits(bytes + at + 20, 2);
    if (*n_record > n_bytes - at - RECORD_HEADER)
      return NULL;
    if (memcmp(bytes + at + 2, "laszip encoded", 15) == 0 && conic_load_bits(bytes + at + 18, 2) == LASZIP_RECORD)
      return bytes + at + RECORD_HEADER;
    at += RECORD_HEADER + *n_record;
  }
  return NULL;
}

static const char *read_packing_record(conic_context *context, const unsigned char *bytes, size_t n_bytes,
                                       conic_laz_format *format) {
  size_t n_record;
  const unsigned char *record = find_record(bytes, n_bytes, &n_record);
  if (!record)
    return "it does not say how its points are packed";
  return conic_laz_format_read(context, NULL, record, n_record, bytes[AT_LAZ_FORMAT] & 0x3f,
                               (size_t)conic_load_bits(bytes + AT_LAZ_POINT_BYTES, 2), format) == CONIC_OK
             ? NULL
             : "its points are packed in a way that cannot be read";
}

conic_status conic_hierarchy_find_laz(conic_hierarchy *hierarchy, const unsigned char *bytes, size_t n_bytes) {
  conic_laz_format *format = hierarchy->own = conic_memory_allocate_zeroed(hierarchy->context, 1, sizeof *format);
  if (!format)
    return CONIC_ERROR_MEMORY;
  const char *wrong = read_packing_record(hierarchy->context, bytes, n_bytes, format);
  return wrong ? conic_hierarchy_wrong(hierarchy, wrong) : CONIC_OK;
}

const char *conic_hierarchy_take_chunk(const conic_hierarchy *hierarchy, const unsigned char *bytes, size_t n_bytes,
                                       conic_hierarchy_points *points) {
  conic_context *context = hierarchy->context;
  const conic_laz_format *format = hierarchy->own;
  conic_laz_decoder *decoder = NULL;
  const char *wrong = "there is no memory for it";
  unsigned char *records = conic_memory_allocate(context, points->n, hierarchy->layout.n_bytes);
  if (records && conic_laz_decoder_create(context, &decoder) == CONIC_OK)
    wrong = conic_laz_decode(decoder, format, bytes, n_bytes, points->n, WANTED, records) == CONIC_OK
                ? NULL
                : "its chunk is spoiled";
  if (!wrong)
    conic_point_layout_take(&hierarchy->layout, records, points);
  conic_laz_decoder_destroy(decoder);
  conic_memory_release(context, records);
  return wrong;
}

/* Chunk after chunk, behind the eight bytes that say where their table is. */
static const char *unpack_chunks(conic_context *context, const conic_laz_format *format, const unsigned char *bytes,
                                 size_t n_bytes, size_t n_points, unsigned char *records) {
  conic_laz_decoder *decoder;
  const char *wrong = NULL;
  size_t at = format->compressor == 1 ? 0 : 8;
  if (format->compressor != 1 && format->chunk_points == CONIC_LAZ_VARIABLE)
    return "its points are in chunks of several sizes";
  if (conic_laz_decoder_create(context, &decoder) != CONIC_OK)
    return "there is no memory for it";
  for (size_t done = 0; done < n_points && !wrong;) {
    size_t n = n_points - done;
    n = format->compressor != 1 && format->chunk_points < n ? format->chunk_points : n;
    if (n == 0 || at >= n_bytes ||
        conic_laz_decode(decoder, format, bytes + at, n_bytes - at, n, WANTED, records + done * format->point_bytes) !=
            CONIC_OK)
      wrong = "its chunks are spoiled";
    else
      at += conic_laz_taken(decoder);
    done += n;
  }
  conic_laz_decoder_destroy(decoder);
  return wrong;
}

static const char *take_packed(conic_context *context, const unsigned char *bytes, size_t n_bytes, size_t points_at,
                               const conic_point_layout *layout, conic_hierarchy_points *points) {
  conic_laz_format format;
  if (points_at > n_bytes || n_bytes - points_at < 8)
    return "it ends before its points";
  const char *wrong = read_packing_record(context, bytes, points_at, &format);
  if (wrong)
    return wrong;
  unsigned char *records = conic_memory_allocate(context, points->n, format.point_bytes);
  if (!records)
    return "there is no memory for it";
  wrong = unpack_chunks(context, &format, bytes + points_at, n_bytes - points_at, points->n, records);
  if (!wrong)
    conic_point_layout_take(layout, records, points);
  conic_memory_release(context, records);
  return wrong;
}

const char *conic_hierarchy_take_laz(conic_context *context, const unsigned char *bytes, size_t n_bytes,
                                     conic_hierarchy_points *points) {
  conic_point_layout layout;
  if (n_bytes < LEAST_HEADER || memcmp(bytes, "LASF", 4) != 0)
    return "it is no LAZ";
  uint32_t point_bytes = (uint32_t)conic_load_bits(bytes + AT_LAZ_POINT_BYTES, 2);
  uint64_t count = conic_load_bits(bytes + AT_LAZ_COUNT, 4), points_at = conic_load_bits(bytes + AT_LAZ_POINTS, 4);
  if (count == 0 && n_bytes >= 255 && bytes[25] >= 4)
    count = conic_load_bits(bytes + 247, 8);
  if (count != points->n)
    return "it holds another number of points than the hierarchy says";
  if (!conic_point_layout_of_las(bytes[AT_LAZ_FORMAT] & 0x3f, point_bytes, &layout))
    return "its points are of no format that is read";
  for (size_t axis = 0; axis < 3; axis++) {
    layout.scale[axis] = conic_load_double(bytes + AT_LAZ_SCALE + 8 * axis);
    layout.offset[axis] = conic_load_double(bytes + AT_LAZ_OFFSET + 8 * axis);
  }
  if (bytes[AT_LAZ_FORMAT] & 0xc0)
    return take_packed(context, bytes, n_bytes, (size_t)points_at, &layout, points);
  if (points_at > n_bytes || (n_bytes - points_at) / point_bytes < count)
    return "it ends before its points";
  conic_point_layout_take(&layout, bytes + points_at, points);
  return NULL;
}
