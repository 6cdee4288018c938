/* Points in layers: point formats 6 to 10. Every attribute has its own bytes and models, and each of four scanner
 * channels has its own models. The layers are decoded one after the other, some points at a time. */
#include <string.h>

#include "core/base/memory.h"
#include "core/laz/laz_fields.h"
#include "core/laz/laz_points.h"

enum { CHANNELS = 4, RUN = 512, POINT_BYTES = 30 };

/* The layers in their order; extra bytes follow, with a layer for each byte. */
enum { XY, Z, CLASS, FLAGS, INTENSITY, ANGLE, USER, SOURCE, TIME, COLOR, NIR, WAVE, N_LAYERS };

static const unsigned wanted_bits[N_LAYERS] = {~0u,
                                               CONIC_LAZ_Z,
                                               CONIC_LAZ_CLASSIFICATION,
                                               CONIC_LAZ_FLAGS,
                                               CONIC_LAZ_INTENSITY,
                                               CONIC_LAZ_SCAN_ANGLE,
                                               CONIC_LAZ_USER_DATA,
                                               CONIC_LAZ_POINT_SOURCE,
                                               CONIC_LAZ_GPS_TIME,
                                               CONIC_LAZ_COLORS,
                                               CONIC_LAZ_NIR,
                                               CONIC_LAZ_WAVE_PACKET};

/* What the first layer tells the others about a point. */
typedef struct point_hints {
  unsigned char channel, item_channel; /* item_channel: for colours and all items after them */
  unsigned char z_context;
  unsigned char has_new_time, has_new_angle, has_new_source;
} point_hints;

/* The first layer's state of a channel: returns, x and y. */
typedef struct xy_state {
  int is_used, has_new_time;
  uint32_t x, y;
  unsigned n, r;
  conic_laz_median x_step[12], y_step[12];
  conic_laz_integer x_off, y_off;
  conic_laz_model changed[8], channel, n_returns[16], i_return[16], i_return_same;
} xy_state;

typedef struct z_state {
  int is_used;
  int32_t last[8];
  conic_laz_integer off;
} z_state;

/* Classes, flags and user data: a byte, predicted from the one before. */
typedef struct byte_state {
  int is_used;
  unsigned last;
  conic_laz_model models[64];
} byte_state;

/* Intensities, angles and sources: 16 bits, predicted from those before. */
typedef struct number_state {
  int is_used;
  uint32_t last[8];
  conic_laz_integer off;
} number_state;

typedef struct time_state {
  int is_used;
  conic_laz_times times;
} time_state;

/* For colours and later items: the channel whose last item the next one is compared with. */
typedef struct item_turn {
  unsigned current;
  unsigned char is_used[CHANNELS];
} item_turn;

struct conic_laz_layered {
  conic_context *context;
  const conic_laz_format *format;
  conic_laz_arena *arena;
  const unsigned char *end;
  int is_spoiled;
  conic_laz_stream streams[N_LAYERS];
  int is_there[N_LAYERS];
  unsigned channel;
  point_hints hints[RUN];
  unsigned char *first, *last; /* records: the chunk's first, and the previous one */
  /* extra bytes */
  size_t extra_room;
  conic_laz_stream *extra_streams;
  conic_laz_model (*extra_models)[CHANNELS];
  unsigned char (*extra_last)[CHANNELS];
  /* one for each channel */
  xy_state xy[CHANNELS];
  z_state z[CHANNELS];
  byte_state class[CHANNELS], flags[CHANNELS], user[CHANNELS];
  number_state intensity[CHANNELS], angle[CHANNELS], source[CHANNELS];
  time_state time[CHANNELS];
  conic_laz_colors colors[CHANNELS];
  conic_laz_nirs nirs[CHANNELS];
  conic_laz_waves waves[CHANNELS];
  unsigned char last_color[CHANNELS][6], last_nir[CHANNELS][2], last_wave[CHANNELS][CONIC_LAZ_WAVE_BYTES];
  item_turn color_turn, nir_turn, wave_turn, extra_turn;
};

conic_status conic_laz_layered_create(conic_context *context, conic_laz_layered **layered) {
  conic_laz_layered *l = conic_memory_allocate_zeroed(context, 1, sizeof *l);
  *layered = l;
  if (!l)
    return CONIC_ERROR_MEMORY;
  l->context = context;
  l->first = conic_memory_allocate(context, 2 * 65536, 1);
  if (l->first) {
    l->last = l->first + 65536;
    return CONIC_OK;
  }
  conic_memory_release(context, l);
  *layered = NULL;
  return CONIC_ERROR_MEMORY;
}

static void release_extra(conic_context *context, conic_laz_layered *l) {
  conic_memory_release_these(context, l->extra_streams, l->extra_models, l->extra_last);
  l->extra_streams = NULL;
  l->extra_models = NULL;
  l->extra_last = NULL;
  l->extra_room = 0;
}

void conic_laz_layered_destroy(conic_context *context, conic_laz_layered *l) {
  if (!l)
    return;
  release_extra(context, l);
  conic_memory_release_these(context, l->first, l);
}

/* --- where the layers are --- */

static conic_status make_room_for_extra(conic_laz_layered *l) {
  size_t n = l->format->n_extra;
  if (n > l->extra_room) {
    release_extra(l->context, l);
    l->extra_streams = conic_memory_allocate(l->context, n, sizeof *l->extra_streams);
    l->extra_models = conic_memory_allocate(l->context, n, sizeof *l->extra_models);
    l->extra_last = conic_memory_allocate(l->context, n, sizeof *l->extra_last);
    if (!l->extra_streams || !l->extra_models || !l->extra_last)
      return CONIC_ERROR_MEMORY;
    l->extra_room = n;
  }
  if (n)
    memset(l->extra_models, 0, n * sizeof *l->extra_models);
  return CONIC_OK;
}

static int format_has(const conic_laz_format *format, int layer) {
  unsigned kind = format->point_format;
  return layer < COLOR    ? 1
         : layer == COLOR ? kind == 7 || kind == 8 || kind == 10
         : layer == NIR   ? kind == 8 || kind == 10
                          : kind >= 9;
}

size_t conic_laz_count_layers(const conic_laz_format *format) {
  size_t n = format->n_extra;
  for (int layer = 0; layer < N_LAYERS; layer++)
    n += (size_t)format_has(format, layer);
  return n;
}

/* Begins a layer. A layer without bytes changes nothing in the whole chunk. */
static void begin_layer(conic_laz_layered *l, conic_laz_stream *stream, int is_wanted, const unsigned char **at,
                        size_t n_bytes, int *is_there) {
  *is_there = is_wanted && n_bytes > 0;
  *stream = (conic_laz_stream){.arena = l->arena};
  if (*is_there)
    conic_laz_stream_begin(stream, l->arena, *at, n_bytes);
  *at += n_bytes;
}

/* A chunk is the number of points, the sizes of all layers, and the layers. */
static conic_status find_layers(conic_laz_layered *l, unsigned wanted, const unsigned char *bytes, size_t n_bytes) {
  const conic_laz_format *format = l->format;
  size_t n_head = 4 + 4 * conic_laz_count_layers(format);
  if (n_bytes < n_head)
    return CONIC_ERROR_INPUT;
  uint64_t sum = n_head;
  for (size_t i = 4; i < n_head; i += 4)
    sum += conic_load_32(bytes + i);
  if (sum > n_bytes)
    return CONIC_ERROR_INPUT;
  const unsigned char *size = bytes + 4, *at = bytes + n_head;
  for (int layer = 0; layer < N_LAYERS; layer++) {
    int is_packed = format_has(format, layer);
    begin_layer(l, &l->streams[layer], is_packed && (wanted_bits[layer] & wanted), &at,
                is_packed ? conic_load_32(size) : 0, &l->is_there[layer]);
    size += is_packed ? 4 : 0;
  }
  for (size_t i = 0; i < format->n_extra; i++, size += 4) {
    int is_there;
    begin_layer(l, &l->extra_streams[i], (wanted & CONIC_LAZ_EXTRA) != 0, &at, conic_load_32(size), &is_there);
  }
  l->end = at;
  return CONIC_OK;
}

/* --- beginning --- */

static void mark_unused(conic_laz_layered *l) {
  for (int c = 0; c < CHANNELS; c++)
    l->xy[c].is_used = l->z[c].is_used = l->class[c].is_used = l->flags[c].is_used = l->user[c].is_used =
        l->intensity[c].is_used = l->angle[c].is_used = l->source[c].is_used = l->time[c].is_used = 0;
}

static void begin_turn(item_turn *turn, unsigned channel) {
  memset(turn, 0, sizeof *turn);
  turn->current = channel;
  turn->is_used[channel] = 1;
}

static void begin_items(conic_laz_layered *l) {
  const conic_laz_format *format = l->format;
  const unsigned char *item = l->first + POINT_BYTES;
  memset(l->colors, 0, sizeof l->colors);
  memset(l->nirs, 0, sizeof l->nirs);
  memset(l->waves, 0, sizeof l->waves);
  if (format_has(format, COLOR))
    memcpy(l->last_color[l->channel], item, 6);
  if (format_has(format, NIR))
    memcpy(l->last_nir[l->channel], item + 6, 2);
  if (format_has(format, WAVE))
    memcpy(l->last_wave[l->channel], l->first + format->point_bytes - format->n_extra - CONIC_LAZ_WAVE_BYTES,
           CONIC_LAZ_WAVE_BYTES);
  for (size_t i = 0; i < format->n_extra; i++)
    l->extra_last[i][l->channel] = l->first[format->point_bytes - format->n_extra + i];
  begin_turn(&l->color_turn, l->channel);
  begin_turn(&l->nir_turn, l->channel);
  begin_turn(&l->wave_turn, l->channel);
  begin_turn(&l->extra_turn, l->channel);
}

static void begin_xy(xy_state *s, uint32_t x, uint32_t y, unsigned returns) {
  memset(s, 0, sizeof *s);
  s->is_used = 1;
  s->x = x;
  s->y = y;
  s->r = returns & 15;
  s->n = returns >> 4;
  conic_laz_median_begin(s->x_step, 12);
  conic_laz_median_begin(s->y_step, 12);
}

/* --- the first layer --- */

/* Whether a return is the first (1) and the last (2) of its pulse. */
static unsigned ends_of(unsigned n, unsigned r) {
  return (unsigned)(r == 1) + 2u * (unsigned)(r >= n);
}

/* Finds the channel and its state, from a symbol that says what has changed. */
static xy_state *turn_channel(conic_laz_layered *l, unsigned changed, point_hints *hints) {
  xy_state *s = &l->xy[l->channel];
  unsigned item_channel = l->format->point_version == 4 ? l->channel : 0;
  if (changed & 64) {
    unsigned channel = (l->channel + conic_laz_symbol(&l->streams[XY], &s->channel, 3) + 1) & 3;
    if (!l->xy[channel].is_used)
      begin_xy(&l->xy[channel], s->x, s->y, s->n << 4 | s->r);
    l->channel = item_channel = channel;
  }
  hints->channel = (unsigned char)l->channel;
  hints->item_channel = (unsigned char)item_channel; /* in version 3 it is 0 whenever the channel stays */
  return &l->xy[l->channel];
}

static void read_returns(conic_laz_stream *stream, xy_state *s, unsigned changed) {
  unsigned r = s->r;
  if (changed & 4)
    s->n = conic_laz_symbol(stream, &s->n_returns[s->n], 16);
  switch (changed & 3) {
  case 1:
    s->r = (r + 1) & 15;
    break;
  case 2:
    s->r = (r + 15) & 15;
    break;
  case 3:
    s->r = changed & 16 ? conic_laz_symbol(stream, &s->i_return[r], 16)
                        : (r + 2 + conic_laz_symbol(stream, &s->i_return_same, 13)) & 15;
    break;
  default:
    break;
  }
}

static void read_xy(conic_laz_layered *l, point_hints *hints, unsigned char *record) {
  conic_laz_stream *stream = &l->streams[XY];
  xy_state *s = &l->xy[l->channel];
  unsigned changed = conic_laz_symbol(stream, &s->changed[ends_of(s->n, s->r) + 4u * (unsigned)s->has_new_time], 128);
  s = turn_channel(l, changed, hints);
  int has_new_time = (changed & 16) != 0;
  read_returns(stream, s, changed);
  unsigned which = (unsigned)(conic_laz_returns_6[s->n][s->r] - '0') * 2 + (unsigned)has_new_time;
  int is_single = s->n == 1;
  s->x += (uint32_t)conic_laz_step(stream, &s->x_off, &s->x_step[which], (unsigned)is_single);
  s->y += (uint32_t)conic_laz_step(stream, &s->y_off, &s->y_step[which], conic_laz_context(s->x_off.k, 20, is_single));
  s->has_new_time = has_new_time;
  hints->has_new_time = (unsigned char)has_new_time;
  hints->has_new_angle = (changed & 8) != 0;
  hints->has_new_source = (changed & 32) != 0;
  hints->z_context = (unsigned char)conic_laz_context((s->x_off.k + s->y_off.k) / 2, 18, is_single);
  conic_store_32(record, s->x);
  conic_store_32(record + 4, s->y);
  record[14] = (unsigned char)(s->n << 4 | s->r);
  record[15] = (unsigned char)(l->channel << 4);
}

/* --- other layers of a point: `before` is the record of the point before --- */

static z_state *z_state_of(z_state *states, unsigned channel, const unsigned char *before) {
  z_state *s = &states[channel];
  if (!s->is_used) {
    memset(s, 0, sizeof *s);
    s->is_used = 1;
    for (int i = 0; i < 8; i++)
      s->last[i] = (int32_t)conic_load_32(before + 8);
  }
  return s;
}

static void read_z(conic_laz_layered *l, const point_hints *hints, const unsigned char *before, unsigned char *record) {
  z_state *s = z_state_of(l->z, hints->channel, before);
  unsigned level = conic_laz_level(record[14] >> 4, record[14] & 15);
  s->last[level] = conic_laz_integer_32(&l->streams[Z], &s->off, s->last[level], hints->z_context);
  conic_store_32(record + 8, (uint32_t)s->last[level]);
}

static byte_state *byte_state_of(byte_state *states, unsigned channel, unsigned before) {
  byte_state *s = &states[channel];
  if (!s->is_used) {
    memset(s, 0, sizeof *s);
    s->is_used = 1;
    s->last = before;
  }
  return s;
}

static unsigned ends_of_record(const unsigned char *record) {
  return ends_of(record[14] >> 4, record[14] & 15);
}

static void read_class(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                       unsigned char *record) {
  byte_state *s = byte_state_of(l->class, hints->channel, before[16]);
  unsigned model = (s->last & 31) << 1 | (unsigned)(ends_of_record(record) == 3);
  s->last = conic_laz_symbol(&l->streams[CLASS], &s->models[model], 256);
  record[16] = (unsigned char)s->last;
}

/* The flags of a record's byte; the channel is between them. */
static unsigned flags_of(unsigned byte) {
  return (byte & 15) | (byte >> 6) << 4;
}

static void read_flags(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                       unsigned char *record) {
  byte_state *s = byte_state_of(l->flags, hints->channel, flags_of(before[15]));
  s->last = conic_laz_symbol(&l->streams[FLAGS], &s->models[s->last], 64);
  record[15] |= (unsigned char)((s->last & 15) | (s->last >> 4) << 6);
}

static void read_user(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                      unsigned char *record) {
  byte_state *s = byte_state_of(l->user, hints->channel, before[17]);
  s->last = conic_laz_symbol(&l->streams[USER], &s->models[s->last >> 2], 256);
  record[17] = (unsigned char)s->last;
}

static number_state *number_state_of(number_state *states, unsigned channel, const unsigned char *before) {
  number_state *s = &states[channel];
  if (!s->is_used) {
    memset(s, 0, sizeof *s);
    s->is_used = 1;
    for (int i = 0; i < 8; i++)
      s->last[i] = conic_load_16(before);
  }
  return s;
}

static void read_intensity(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                           unsigned char *record) {
  number_state *s = number_state_of(l->intensity, hints->channel, before + 12);
  unsigned ends = ends_of_record(record), kind = (ends & 1) << 1 | ends >> 1, which = kind << 1 | hints->has_new_time;
  s->last[which] = conic_laz_integer_16(&l->streams[INTENSITY], &s->off, s->last[which], kind);
  conic_store_bits(record + 12, 2, s->last[which]);
}

static void read_angle(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                       unsigned char *record) {
  number_state *s = number_state_of(l->angle, hints->channel, before + 18);
  if (hints->has_new_angle)
    s->last[0] = conic_laz_integer_16(&l->streams[ANGLE], &s->off, s->last[0], hints->has_new_time);
  conic_store_bits(record + 18, 2, s->last[0]);
}

static void read_source(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                        unsigned char *record) {
  number_state *s = number_state_of(l->source, hints->channel, before + 20);
  if (hints->has_new_source)
    s->last[0] = conic_laz_integer_16(&l->streams[SOURCE], &s->off, s->last[0], 0);
  conic_store_bits(record + 20, 2, s->last[0]);
}

static time_state *time_state_of(time_state *states, unsigned channel, const unsigned char *before) {
  time_state *s = &states[channel];
  if (!s->is_used) {
    memset(s, 0, sizeof *s);
    s->is_used = 1;
    conic_laz_times_begin(&s->times, conic_load_64(before + 22));
  }
  return s;
}

static void read_time_layer(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                            unsigned char *record) {
  time_state *s = time_state_of(l->time, hints->channel, before);
  uint64_t time = hints->has_new_time ? conic_laz_time(&l->streams[TIME], &s->times, 0) : s->times.time[s->times.last];
  conic_store_64(record + 22, time);
}

/* The first point starts its channel, whenever that channel's next point comes. */
static void begin_channel(conic_laz_layered *l) {
  const unsigned char *first = l->first;
  z_state_of(l->z, l->channel, first);
  byte_state_of(l->class, l->channel, first[16]);
  byte_state_of(l->flags, l->channel, flags_of(first[15]));
  byte_state_of(l->user, l->channel, first[17]);
  number_state_of(l->intensity, l->channel, first + 12);
  number_state_of(l->angle, l->channel, first + 18);
  number_state_of(l->source, l->channel, first + 20);
  time_state_of(l->time, l->channel, first);
}

typedef void layer_reader(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                          unsigned char *record);

/* --- items that follow the point --- */

/* Finds the channel whose last item the next one is compared with. A new channel begins with a copy of the previous
 * channel's item: *from is that channel; else it is `channel`. Version 3 compares with the previous channel's item
 * whenever it changes to a known channel. */
static unsigned take_turn(item_turn *turn, unsigned channel, unsigned version, unsigned *from) {
  unsigned before = turn->current;
  *from = channel;
  turn->current = channel;
  if (before == channel)
    return channel;
  if (!turn->is_used[channel]) {
    turn->is_used[channel] = 1;
    *from = before;
    return channel;
  }
  return version == 4 ? channel : before;
}

static void read_color_layer(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                             unsigned char *record) {
  unsigned from, which = take_turn(&l->color_turn, hints->item_channel, l->format->color_version, &from);
  (void)before;
  if (from != hints->item_channel)
    memcpy(l->last_color[hints->item_channel], l->last_color[from], 6);
  conic_laz_color(&l->streams[COLOR], &l->colors[hints->item_channel], l->last_color[which], l->last_color[which]);
  memcpy(record + POINT_BYTES, l->last_color[which], 6);
}

static void read_nir_layer(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                           unsigned char *record) {
  unsigned from, which = take_turn(&l->nir_turn, hints->item_channel, l->format->color_version, &from);
  (void)before;
  if (from != hints->item_channel)
    memcpy(l->last_nir[hints->item_channel], l->last_nir[from], 2);
  conic_laz_nir(&l->streams[NIR], &l->nirs[hints->item_channel], l->last_nir[which], l->last_nir[which]);
  memcpy(record + POINT_BYTES + 6, l->last_nir[which], 2);
}

static void read_wave_layer(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                            unsigned char *record) {
  const conic_laz_format *format = l->format;
  unsigned from, which = take_turn(&l->wave_turn, hints->item_channel, format->wave_version, &from);
  (void)before;
  if (from != hints->item_channel)
    memcpy(l->last_wave[hints->item_channel], l->last_wave[from], CONIC_LAZ_WAVE_BYTES);
  conic_laz_wave(&l->streams[WAVE], &l->waves[hints->item_channel], l->last_wave[which], l->last_wave[which]);
  memcpy(record + format->point_bytes - format->n_extra - CONIC_LAZ_WAVE_BYTES, l->last_wave[which],
         CONIC_LAZ_WAVE_BYTES);
}

/* Reads one extra byte of n points. The turns of channels are the same for all extra bytes. */
static void read_extra_layer(conic_laz_layered *l, size_t i_extra, item_turn turn, size_t n, unsigned char *byte) {
  const conic_laz_format *format = l->format;
  conic_laz_stream *stream = &l->extra_streams[i_extra];
  unsigned char *last = l->extra_last[i_extra];
  for (size_t i = 0; i < n; i++, byte += format->point_bytes) {
    unsigned channel = l->hints[i].item_channel, from, which = take_turn(&turn, channel, format->extra_version, &from);
    if (from != channel)
      last[channel] = last[from];
    last[which] = (unsigned char)(last[which] + conic_laz_symbol(stream, &l->extra_models[i_extra][channel], 256));
    *byte = last[which];
  }
}

/* --- all layers of some points --- */

/* Fields without a layer are the first point's. */
static void fill_from_first(const conic_laz_layered *l, size_t n, unsigned char *records) {
  size_t point_bytes = l->format->point_bytes;
  for (size_t i = 0; i < n; i++)
    memcpy(records + i * point_bytes, l->first, point_bytes);
}

static void read_extra_layers(conic_laz_layered *l, size_t n, unsigned char *records) {
  const conic_laz_format *format = l->format;
  item_turn before = l->extra_turn;
  unsigned from;
  for (size_t i = 0; i < n; i++)
    take_turn(&l->extra_turn, l->hints[i].item_channel, format->extra_version, &from);
  for (size_t i = 0; i < format->n_extra; i++)
    if (l->extra_streams[i].length) {
      read_extra_layer(l, i, before, n, records + format->point_bytes - format->n_extra + i);
      l->is_spoiled |= l->extra_streams[i].is_spoiled;
    }
}

/* Reads a layer of a run of points, each layer in a loop of its own. */
static inline void read_layer(conic_laz_layered *l, int layer, layer_reader *read_one, size_t n,
                              unsigned char *records) {
  size_t point_bytes = l->format->point_bytes;
  if (!l->is_there[layer])
    return;
  read_one(l, &l->hints[0], l->last, records);
  for (size_t i = 1; i < n; i++)
    read_one(l, &l->hints[i], records + (i - 1) * point_bytes, records + i * point_bytes);
  l->is_spoiled |= l->streams[layer].is_spoiled;
}

static void read_run(conic_laz_layered *l, size_t n, unsigned char *records) {
  size_t point_bytes = l->format->point_bytes;
  unsigned first_flags = l->is_there[FLAGS] ? 0 : l->first[15] & 0xcfu;
  fill_from_first(l, n, records);
  for (size_t i = 0; i < n; i++) {
    read_xy(l, &l->hints[i], records + i * point_bytes);
    records[i * point_bytes + 15] |= (unsigned char)first_flags;
  }
  l->is_spoiled |= l->streams[XY].is_spoiled;
  read_layer(l, Z, read_z, n, records);
  read_layer(l, CLASS, read_class, n, records);
  read_layer(l, FLAGS, read_flags, n, records);
  read_layer(l, INTENSITY, read_intensity, n, records);
  read_layer(l, ANGLE, read_angle, n, records);
  read_layer(l, USER, read_user, n, records);
  read_layer(l, SOURCE, read_source, n, records);
  read_layer(l, TIME, read_time_layer, n, records);
  read_layer(l, COLOR, read_color_layer, n, records);
  read_layer(l, NIR, read_nir_layer, n, records);
  read_layer(l, WAVE, read_wave_layer, n, records);
  read_extra_layers(l, n, records);
  memcpy(l->last, records + (n - 1) * point_bytes, POINT_BYTES);
}

conic_status conic_laz_layered_begin(conic_laz_layered *l, const conic_laz_format *format, conic_laz_arena *arena,
                                     unsigned wanted, const unsigned char *first, const unsigned char *bytes,
                                     size_t n_bytes) {
  l->format = format;
  l->arena = arena;
  l->is_spoiled = 0;
  memcpy(l->first, first, format->point_bytes);
  memcpy(l->last, first, POINT_BYTES);
  l->channel = first[15] >> 4 & 3;
  conic_status status = make_room_for_extra(l);
  if (status == CONIC_OK)
    status = find_layers(l, wanted, bytes, n_bytes);
  if (status != CONIC_OK)
    return status;
  mark_unused(l);
  begin_xy(&l->xy[l->channel], conic_load_32(first), conic_load_32(first + 4), first[14]);
  begin_channel(l);
  begin_items(l);
  return CONIC_OK;
}

int conic_laz_layered_next(conic_laz_layered *l, size_t n, unsigned char *records) {
  l->is_spoiled |= n > 0 && !l->is_there[XY];
  for (size_t i = 0; i < n && !l->is_spoiled && !l->arena->is_out; i += RUN)
    read_run(l, n - i < RUN ? n - i : RUN, records + i * l->format->point_bytes);
  return !l->is_spoiled;
}

const unsigned char *conic_laz_layered_end(const conic_laz_layered *l) {
  return l->end;
}
