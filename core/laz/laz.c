#include "core/laz/laz.h"

#include "core/laz/laz_points.h"
#include "core/laz/laz_stream.h"

enum { RECORD_BYTES = 34, ITEM_BYTES = 6, MOST_ITEMS = 5 };

/* Kinds of items, by their numbers in the record. */
enum {
  BYTES = 0,
  POINT10 = 6,
  TIME11 = 7,
  RGB12 = 8,
  WAVE13 = 9,
  POINT14 = 10,
  RGB14 = 11,
  RGBNIR14 = 12,
  WAVE14 = 13,
  BYTES14 = 14
};

struct conic_laz_decoder {
  conic_context *context;
  const conic_laz_format *format;
  const unsigned char *bytes;
  uint64_t n_left;
  int is_at_first;
  conic_laz_arena arena;
  conic_laz_serial *serial;
  conic_laz_layered *layered;
};

/* --- the file's record; the header's byte 104 says that there is one --- */

typedef struct packed_item {
  unsigned kind;
  size_t n_bytes;
} packed_item;

/* The items of a point format, without extra bytes. */
static size_t list_items(unsigned point_format, packed_item items[MOST_ITEMS]) {
  size_t n = 0;
  int is_new = point_format >= 6;
  items[n++] = is_new ? (packed_item){POINT14, 30} : (packed_item){POINT10, 20};
  if (!is_new && point_format != 0 && point_format != 2)
    items[n++] = (packed_item){TIME11, 8};
  if (point_format == 2 || point_format == 3 || point_format == 5)
    items[n++] = (packed_item){RGB12, 6};
  if (point_format == 7)
    items[n++] = (packed_item){RGB14, 6};
  if (point_format == 8 || point_format == 10)
    items[n++] = (packed_item){RGBNIR14, 8};
  if (point_format == 4 || point_format == 5)
    items[n++] = (packed_item){WAVE13, 29};
  if (point_format >= 9)
    items[n++] = (packed_item){WAVE14, 29};
  return n;
}

/* Versions 1 and 2 of waveforms are the same. */
static int is_version_read(unsigned kind, unsigned version) {
  return kind == WAVE13 ? version == 1 || version == 2 : kind >= POINT14 ? version == 3 || version == 4 : version == 2;
}

static void keep_version(conic_laz_format *format, unsigned kind, unsigned version) {
  if (kind == POINT14)
    format->point_version = version;
  else if (kind == RGB14 || kind == RGBNIR14)
    format->color_version = version;
  else if (kind == WAVE14)
    format->wave_version = version;
  else if (kind == BYTES14)
    format->extra_version = version;
}

static conic_status wrong_format(conic_context *context, const char *name, const char *what) {
  return name ? conic_fail(context, CONIC_ERROR_INPUT, "%s: LAZ: %s (at byte 104)", name, what) : CONIC_ERROR_INPUT;
}

static conic_status check_items(conic_context *context, const char *name, const unsigned char *bytes, size_t n_items,
                                conic_laz_format *format) {
  packed_item items[MOST_ITEMS];
  size_t n = list_items(format->point_format, items);
  if (format->n_extra > 0)
    items[n++] = (packed_item){format->point_format >= 6 ? BYTES14 : BYTES, format->n_extra};
  if (n_items != n)
    return wrong_format(context, name, "its record lists other items than a point of its format has");
  for (size_t i = 0; i < n; i++, bytes += ITEM_BYTES) {
    unsigned kind = conic_load_16(bytes), version = conic_load_16(bytes + 4);
    if (kind != items[i].kind || conic_load_16(bytes + 2) != items[i].n_bytes)
      return wrong_format(context, name, "its record lists other items than a point of its format has");
    if (!is_version_read(kind, version))
      return !name ? CONIC_ERROR_INPUT
                   : conic_fail(context, CONIC_ERROR_INPUT,
                                "%s: LAZ: items of version %u (of kind %u) are not read; pack it anew with a current "
                                "LASzip (at byte 104)",
                                name, version, kind);
    keep_version(format, kind, version);
  }
  return CONIC_OK;
}

conic_status conic_laz_format_read(conic_context *context, const char *name, const unsigned char *record,
                                   size_t n_bytes, unsigned point_format, size_t point_bytes,
                                   conic_laz_format *format) {
  packed_item items[MOST_ITEMS];
  size_t n_least = 0, n_items;
  memset(format, 0, sizeof *format);
  if (n_bytes < RECORD_BYTES || (n_items = conic_load_16(record + 32)) > (n_bytes - RECORD_BYTES) / ITEM_BYTES)
    return wrong_format(context, name, "its record ends early");
  for (size_t i = 0, n = point_format <= 10 ? list_items(point_format, items) : 0; i < n; i++)
    n_least += items[i].n_bytes;
  if (point_format > 10 || point_bytes < n_least || point_bytes > UINT16_MAX)
    return wrong_format(context, name, "there is no such point format");
  format->compressor = conic_load_16(record);
  format->point_format = point_format;
  format->point_bytes = point_bytes;
  format->n_extra = point_bytes - n_least;
  format->chunk_points = format->compressor == 1 ? CONIC_LAZ_VARIABLE : conic_load_32(record + 12);
  if (point_format >= 6 ? format->compressor != 3 : format->compressor != 1 && format->compressor != 2)
    return !name ? CONIC_ERROR_INPUT
                 : conic_fail(context, CONIC_ERROR_INPUT,
                              "%s: LAZ: compressor %u, which is none for points of format %u (at byte 104)", name,
                              format->compressor, point_format);
  if (conic_load_16(record + 2) != 0)
    return wrong_format(context, name, "an unknown coder");
  if (format->chunk_points == 0) /* as LAStools writes into COPC, and LASzip reads: the table has each chunk's number */
    format->chunk_points = CONIC_LAZ_VARIABLE;
  return check_items(context, name, record + RECORD_BYTES, n_items, format);
}

/* --- decoding --- */

conic_status conic_laz_decoder_create(conic_context *context, conic_laz_decoder **decoder) {
  *decoder = conic_memory_allocate_zeroed(context, 1, sizeof **decoder);
  if (!*decoder)
    return CONIC_ERROR_MEMORY;
  (*decoder)->context = context;
  (*decoder)->arena.context = context;
  return CONIC_OK;
}

void conic_laz_decoder_destroy(conic_laz_decoder *decoder) {
  if (!decoder)
    return;
  conic_laz_serial_destroy(decoder->context, decoder->serial);
  conic_laz_layered_destroy(decoder->context, decoder->layered);
  conic_laz_arena_release(&decoder->arena);
  conic_memory_release(decoder->context, decoder);
}

static conic_status make_state(conic_laz_decoder *decoder) {
  if (decoder->format->compressor == 3)
    return decoder->layered ? CONIC_OK : conic_laz_layered_create(decoder->context, &decoder->layered);
  return decoder->serial ? CONIC_OK : conic_laz_serial_create(decoder->context, &decoder->serial);
}

conic_status conic_laz_begin(conic_laz_decoder *decoder, const conic_laz_format *format, const unsigned char *bytes,
                             size_t n_bytes, uint64_t n_points, unsigned wanted) {
  size_t n_first = format->point_bytes;
  decoder->format = format;
  decoder->bytes = bytes;
  decoder->n_left = 0;
  if (n_points == 0)
    return CONIC_OK;
  if (n_bytes < n_first)
    return CONIC_ERROR_INPUT;
  conic_laz_arena_rewind(&decoder->arena);
  conic_status status = make_state(decoder);
  if (status == CONIC_OK)
    status = format->compressor == 3 ? conic_laz_layered_begin(decoder->layered, format, &decoder->arena, wanted, bytes,
                                                               bytes + n_first, n_bytes - n_first)
                                     : conic_laz_serial_begin(decoder->serial, format, &decoder->arena, bytes,
                                                              bytes + n_first, n_bytes - n_first);
  if (status != CONIC_OK)
    return status;
  decoder->n_left = n_points;
  decoder->is_at_first = 1;
  return CONIC_OK;
}

conic_status conic_laz_next(conic_laz_decoder *decoder, size_t n, unsigned char *records) {
  const conic_laz_format *format = decoder->format;
  if (n > decoder->n_left)
    return CONIC_ERROR_INPUT;
  decoder->n_left -= n;
  if (n > 0 && decoder->is_at_first) {
    memcpy(records, decoder->bytes, format->point_bytes);
    records += format->point_bytes;
    decoder->is_at_first = 0;
    n--;
  }
  if (n == 0)
    return CONIC_OK;
  int is_whole = format->compressor == 3 ? conic_laz_layered_next(decoder->layered, n, records)
                                         : conic_laz_serial_next(decoder->serial, n, records);
  return decoder->arena.is_out ? CONIC_ERROR_MEMORY : is_whole ? CONIC_OK : CONIC_ERROR_INPUT;
}

conic_status conic_laz_decode(conic_laz_decoder *decoder, const conic_laz_format *format, const unsigned char *bytes,
                              size_t n_bytes, size_t n_points, unsigned wanted, unsigned char *records) {
  conic_status status = conic_laz_begin(decoder, format, bytes, n_bytes, n_points, wanted);
  return status == CONIC_OK ? conic_laz_next(decoder, n_points, records) : status;
}

void conic_laz_feed(conic_laz_decoder *decoder, const unsigned char *bytes, size_t n_bytes) {
  decoder->bytes = bytes;
  conic_laz_serial_feed(decoder->serial, bytes, n_bytes);
}

size_t conic_laz_taken(const conic_laz_decoder *decoder) {
  const unsigned char *end = decoder->format->compressor == 3 ? conic_laz_layered_end(decoder->layered)
                                                              : conic_laz_serial_end(decoder->serial);
  return (size_t)(end - decoder->bytes);
}

size_t conic_laz_head_bytes(const conic_laz_format *format) {
  return format->point_bytes + 4 + 4 * conic_laz_count_layers(format);
}

uint32_t conic_laz_layered_points(const conic_laz_format *format, const unsigned char *head) {
  return conic_load_32(head + format->point_bytes);
}

uint64_t conic_laz_layered_bytes(const conic_laz_format *format, const unsigned char *head) {
  size_t n_head = conic_laz_head_bytes(format);
  uint64_t sum = n_head;
  for (size_t i = format->point_bytes + 4; i < n_head; i += 4)
    sum += conic_load_32(head + i);
  return sum;
}
