/* Points one after the other: point formats 0 to 5. */

#include "core/laz/laz_fields.h"
#include "core/laz/laz_points.h"

enum { POINT_BYTES = 20 };

/* State after the previous point, and the models of the next one's changes. */
struct conic_laz_serial {
  conic_context *context;
  const conic_laz_format *format;
  conic_laz_stream stream;
  unsigned char last[65536]; /* the previous record */
  conic_laz_model *extra;
  size_t extra_room;
  int has_times, has_colors, has_waves;
  struct serial_state {
    conic_laz_median x_step[16], y_step[16];
    uint32_t intensity[16];
    int32_t z[8];
    conic_laz_integer x, y, height, light, source;
    conic_laz_model changed, angle[2], returns[256], class[256], user[256];
    conic_laz_times times;
    conic_laz_colors colors;
    conic_laz_waves waves;
  } state;
};

conic_status conic_laz_serial_create(conic_context *context, conic_laz_serial **serial) {
  *serial = conic_memory_allocate_zeroed(context, 1, sizeof **serial);
  if (!*serial)
    return CONIC_ERROR_MEMORY;
  (*serial)->context = context;
  return CONIC_OK;
}

void conic_laz_serial_destroy(conic_context *context, conic_laz_serial *serial) {
  if (serial)
    conic_memory_release_these(context, serial->extra, serial);
}

conic_status conic_laz_serial_begin(conic_laz_serial *serial, const conic_laz_format *format, conic_laz_arena *arena,
                                    const unsigned char *first, const unsigned char *bytes, size_t n_bytes) {
  struct serial_state *s = &serial->state;
  unsigned kind = format->point_format;
  memset(s, 0, sizeof *s);
  serial->format = format;
  serial->has_times = kind != 0 && kind != 2;
  serial->has_colors = kind == 2 || kind == 3 || kind == 5;
  serial->has_waves = kind >= 4;
  conic_status status = conic_memory_reserve(serial->context, &serial->extra, 0, format->n_extra, &serial->extra_room,
                                             sizeof *serial->extra);
  if (status != CONIC_OK)
    return status;
  if (format->n_extra)
    memset(serial->extra, 0, format->n_extra * sizeof *serial->extra);
  memcpy(serial->last, first, format->point_bytes);
  conic_store_bits(serial->last + 12, 2, 0); /* an intensity is compared with that of the last return of the same
                                                kind */
  conic_laz_median_begin(s->x_step, 16);
  conic_laz_median_begin(s->y_step, 16);
  conic_laz_times_begin(&s->times, serial->has_times ? conic_load_64(first + POINT_BYTES) : 0);
  conic_laz_stream_begin(&serial->stream, arena, bytes, n_bytes);
  return CONIC_OK;
}

static void read_into(conic_laz_stream *stream, conic_laz_model *models, unsigned char *byte) {
  *byte = (unsigned char)conic_laz_symbol(stream, &models[*byte], 256);
}

/* Reads the other changes, once the returns are known. */
static void read_serial_attributes(conic_laz_serial *serial, unsigned changed, unsigned context) {
  struct serial_state *s = &serial->state;
  conic_laz_stream *stream = &serial->stream;
  unsigned char *p = serial->last;
  if (changed & 16)
    s->intensity[context] = conic_laz_integer_16(stream, &s->light, s->intensity[context], context < 3 ? context : 3);
  conic_store_bits(p + 12, 2, s->intensity[context]);
  if (changed & 8)
    read_into(stream, s->class, p + 15);
  if (changed & 4)
    p[16] = (unsigned char)(p[16] + conic_laz_symbol(stream, &s->angle[p[14] >> 6 & 1], 256));
  if (changed & 2)
    read_into(stream, s->user, p + 17);
  if (changed & 1)
    conic_store_bits(p + 18, 2, conic_laz_integer_16(stream, &s->source, conic_load_16(p + 18), 0));
}

static void add_to_32(unsigned char *number, int32_t step) {
  conic_store_32(number, conic_load_32(number) + (uint32_t)step);
}

static void read_serial_position(conic_laz_serial *serial, unsigned context, unsigned level, int is_single) {
  struct serial_state *s = &serial->state;
  conic_laz_stream *stream = &serial->stream;
  unsigned char *p = serial->last;
  add_to_32(p, conic_laz_step(stream, &s->x, &s->x_step[context], (unsigned)is_single));
  add_to_32(p + 4, conic_laz_step(stream, &s->y, &s->y_step[context], conic_laz_context(s->x.k, 20, is_single)));
  unsigned k = (s->x.k + s->y.k) / 2;
  s->z[level] = conic_laz_integer_32(stream, &s->height, s->z[level], conic_laz_context(k, 18, is_single));
  conic_store_32(p + 8, (uint32_t)s->z[level]);
}

static void read_point(conic_laz_serial *serial) {
  struct serial_state *s = &serial->state;
  conic_laz_stream *stream = &serial->stream;
  unsigned char *p = serial->last;
  unsigned changed = conic_laz_symbol(stream, &s->changed, 64);
  if (changed & 32)
    read_into(stream, s->returns, p + 14);
  unsigned r = p[14] & 7u, n = p[14] >> 3 & 7u;
  unsigned digit = (unsigned char)conic_laz_returns_16[n][r], context = digit <= '9' ? digit - '0' : digit - 'A' + 10;
  /* without changes the intensity stays, too, even if the last return of this kind had another */
  if (changed)
    read_serial_attributes(serial, changed, context);
  read_serial_position(serial, context, conic_laz_level(n, r), n == 1);
}

int conic_laz_serial_next(conic_laz_serial *serial, size_t n, unsigned char *records) {
  const conic_laz_format *format = serial->format;
  struct serial_state *s = &serial->state;
  conic_laz_stream *stream = &serial->stream;
  size_t n_core = format->point_bytes - format->n_extra;
  for (size_t i = 0; i < n && !stream->is_spoiled && !stream->arena->is_out; i++) {
    unsigned char *p = serial->last;
    read_point(serial);
    p += POINT_BYTES;
    if (serial->has_times) {
      conic_store_64(p, conic_laz_time(stream, &s->times, 1));
      p += 8;
    }
    if (serial->has_colors) {
      conic_laz_color(stream, &s->colors, p, p);
      p += 6;
    }
    if (serial->has_waves)
      conic_laz_wave(stream, &s->waves, p, p);
    p = serial->last + n_core;
    for (size_t k = 0; k < format->n_extra; k++)
      p[k] = (unsigned char)(p[k] + conic_laz_symbol(stream, &serial->extra[k], 256));
    memcpy(records + i * format->point_bytes, serial->last, format->point_bytes);
  }
  return !stream->is_spoiled;
}

void conic_laz_serial_feed(conic_laz_serial *serial, const unsigned char *bytes, size_t n_bytes) {
  serial->stream.next = bytes;
  serial->stream.end = bytes + n_bytes;
}

const unsigned char *conic_laz_serial_end(const conic_laz_serial *serial) {
  return serial->stream.next;
}
