/* Points in layers: point formats 6 to 10. Every attribute has its own bytes and models, and each of four scanner
 * channels has its own models. The layers are decoded one after the other, some points at a time. */

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
  int has_new_time;
  uint32_t x, y;
  unsigned n, r;
  conic_laz_median x_step[12], y_step[12];
  conic_laz_integer x_off, y_off;
  conic_laz_model changed[8], channel, n_returns[16], i_return[16], i_return_same;
} xy_state;

/* Classes, flags and user data: a byte, predicted from the one before. */
typedef struct byte_state {
  unsigned last;
  conic_laz_model models[64];
} byte_state;

/* Heights, intensities, angles and sources: 32 or 16 bits, predicted from those before. */
typedef struct number_state {
  uint32_t last[8];
  conic_laz_integer off;
} number_state;

/* For colours and later items: the channel whose last item the next one is compared with. */
typedef struct item_turn {
  unsigned current;
  unsigned char is_used[CHANNELS];
} item_turn;

/* A byte that follows the item of the format. */
typedef struct extra_byte {
  conic_laz_stream stream;
  conic_laz_model models[CHANNELS];
  unsigned char last[CHANNELS];
} extra_byte;

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
  unsigned char first[65536], last[POINT_BYTES]; /* records: the chunk's first, and the previous one */
  size_t extra_room;
  extra_byte *extra;
  unsigned char is_used[N_LAYERS]; /* channels that have begun, as bits */
  /* one for each channel */
  xy_state xy[CHANNELS];
  byte_state class[CHANNELS], flags[CHANNELS], user[CHANNELS];
  number_state z[CHANNELS], intensity[CHANNELS], angle[CHANNELS], source[CHANNELS];
  conic_laz_times times[CHANNELS];
  conic_laz_colors colors[CHANNELS];
  conic_laz_nirs nirs[CHANNELS];
  conic_laz_waves waves[CHANNELS];
  unsigned char last_items[N_LAYERS - COLOR][CHANNELS][CONIC_LAZ_WAVE_BYTES];
  item_turn turns[N_LAYERS - COLOR], extra_turn;
};

conic_status conic_laz_layered_create(conic_context *context, conic_laz_layered **layered) {
  *layered = conic_memory_allocate_zeroed(context, 1, sizeof **layered);
  if (!*layered)
    return CONIC_ERROR_MEMORY;
  (*layered)->context = context;
  return CONIC_OK;
}

void conic_laz_layered_destroy(conic_context *context, conic_laz_layered *l) {
  if (l)
    conic_memory_release_these(context, l->extra, l);
}

/* --- where the layers are --- */

static conic_status make_room_for_extra(conic_laz_layered *l) {
  size_t n = l->format->n_extra;
  conic_status status = conic_memory_reserve(l->context, &l->extra, 0, n, &l->extra_room, sizeof *l->extra);
  if (status == CONIC_OK && n)
    memset(l->extra, 0, n * sizeof *l->extra);
  return status;
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
    begin_layer(l, &l->extra[i].stream, (wanted & CONIC_LAZ_EXTRA) != 0, &at, conic_load_32(size), &is_there);
  }
  l->end = at;
  return CONIC_OK;
}

/* --- beginning --- */

/* Whether this is the first point of a channel; from now on it is not. */
static int begins_channel(conic_laz_layered *l, int layer, unsigned channel) {
  int is_used = l->is_used[layer] >> channel & 1;
  l->is_used[layer] |= (unsigned char)(1u << channel);
  return !is_used;
}

static void begin_turn(item_turn *turn, unsigned channel) {
  memset(turn, 0, sizeof *turn);
  turn->current = channel;
  turn->is_used[channel] = 1;
}

/* Colours, near infrared and waveforms: their bytes, and where they are in a record. */
static const size_t item_bytes[N_LAYERS - COLOR] = {6, 2, CONIC_LAZ_WAVE_BYTES};

static size_t item_place(const conic_laz_format *format, int layer) {
  return layer == COLOR ? POINT_BYTES
         : layer == NIR ? POINT_BYTES + 6
                        : format->point_bytes - format->n_extra - CONIC_LAZ_WAVE_BYTES;
}

static void begin_items(conic_laz_layered *l) {
  const conic_laz_format *format = l->format;
  memset(l->colors, 0, sizeof l->colors);
  memset(l->nirs, 0, sizeof l->nirs);
  memset(l->waves, 0, sizeof l->waves);
  for (int layer = COLOR; layer < N_LAYERS; layer++) {
    if (format_has(format, layer))
      memcpy(l->last_items[layer - COLOR][l->channel], l->first + item_place(format, layer), item_bytes[layer - COLOR]);
    begin_turn(&l->turns[layer - COLOR], l->channel);
  }
  for (size_t i = 0; i < format->n_extra; i++)
    l->extra[i].last[l->channel] = l->first[format->point_bytes - format->n_extra + i];
  begin_turn(&l->extra_turn, l->channel);
}

static void begin_xy(xy_state *s, uint32_t x, uint32_t y, unsigned returns) {
  memset(s, 0, sizeof *s);
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
    if (begins_channel(l, XY, channel))
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

static number_state *number_state_of(conic_laz_layered *l, int layer, number_state *states, unsigned channel,
                                     uint32_t before) {
  number_state *s = &states[channel];
  if (begins_channel(l, layer, channel)) {
    memset(s, 0, sizeof *s);
    for (int i = 0; i < 8; i++)
      s->last[i] = before;
  }
  return s;
}

static void read_z(conic_laz_layered *l, const point_hints *hints, const unsigned char *before, unsigned char *record) {
  number_state *s = number_state_of(l, Z, l->z, hints->channel, conic_load_32(before + 8));
  unsigned level = conic_laz_level(record[14] >> 4, record[14] & 15);
  int32_t last = (int32_t)s->last[level];
  s->last[level] = (uint32_t)conic_laz_integer_32(&l->streams[Z], &s->off, last, hints->z_context);
  conic_store_32(record + 8, s->last[level]);
}

static byte_state *byte_state_of(conic_laz_layered *l, int layer, byte_state *states, unsigned channel,
                                 unsigned before) {
  byte_state *s = &states[channel];
  if (begins_channel(l, layer, channel)) {
    memset(s, 0, sizeof *s);
    s->last = before;
  }
  return s;
}

static unsigned ends_of_record(const unsigned char *record) {
  return ends_of(record[14] >> 4, record[14] & 15);
}

static void read_class(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                       unsigned char *record) {
  byte_state *s = byte_state_of(l, CLASS, l->class, hints->channel, before[16]);
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
  byte_state *s = byte_state_of(l, FLAGS, l->flags, hints->channel, flags_of(before[15]));
  s->last = conic_laz_symbol(&l->streams[FLAGS], &s->models[s->last], 64);
  record[15] |= (unsigned char)((s->last & 15) | (s->last >> 4) << 6);
}

static void read_user(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                      unsigned char *record) {
  byte_state *s = byte_state_of(l, USER, l->user, hints->channel, before[17]);
  s->last = conic_laz_symbol(&l->streams[USER], &s->models[s->last >> 2], 256);
  record[17] = (unsigned char)s->last;
}

static void read_intensity(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                           unsigned char *record) {
  number_state *s = number_state_of(l, INTENSITY, l->intensity, hints->channel, conic_load_16(before + 12));
  unsigned ends = ends_of_record(record), kind = (ends & 1) << 1 | ends >> 1, which = kind << 1 | hints->has_new_time;
  s->last[which] = conic_laz_integer_16(&l->streams[INTENSITY], &s->off, s->last[which], kind);
  conic_store_bits(record + 12, 2, s->last[which]);
}

static void read_angle(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                       unsigned char *record) {
  number_state *s = number_state_of(l, ANGLE, l->angle, hints->channel, conic_load_16(before + 18));
  if (hints->has_new_angle)
    s->last[0] = conic_laz_integer_16(&l->streams[ANGLE], &s->off, s->last[0], hints->has_new_time);
  conic_store_bits(record + 18, 2, s->last[0]);
}

static void read_source(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                        unsigned char *record) {
  number_state *s = number_state_of(l, SOURCE, l->source, hints->channel, conic_load_16(before + 20));
  if (hints->has_new_source)
    s->last[0] = conic_laz_integer_16(&l->streams[SOURCE], &s->off, s->last[0], 0);
  conic_store_bits(record + 20, 2, s->last[0]);
}

static conic_laz_times *times_of(conic_laz_layered *l, unsigned channel, const unsigned char *before) {
  conic_laz_times *times = &l->times[channel];
  if (begins_channel(l, TIME, channel)) {
    memset(times, 0, sizeof *times);
    conic_laz_times_begin(times, conic_load_64(before + 22));
  }
  return times;
}

static void read_time_layer(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                            unsigned char *record) {
  conic_laz_times *times = times_of(l, hints->channel, before);
  uint64_t time = hints->has_new_time ? conic_laz_time(&l->streams[TIME], times, 0) : times->time[times->last];
  conic_store_64(record + 22, time);
}

/* The first point starts its channel, whenever that channel's next point comes. */
static void begin_channel(conic_laz_layered *l) {
  const unsigned char *first = l->first;
  begins_channel(l, XY, l->channel);
  begin_xy(&l->xy[l->channel], conic_load_32(first), conic_load_32(first + 4), first[14]);
  number_state_of(l, Z, l->z, l->channel, conic_load_32(first + 8));
  byte_state_of(l, CLASS, l->class, l->channel, first[16]);
  byte_state_of(l, FLAGS, l->flags, l->channel, flags_of(first[15]));
  byte_state_of(l, USER, l->user, l->channel, first[17]);
  number_state_of(l, INTENSITY, l->intensity, l->channel, conic_load_16(first + 12));
  number_state_of(l, ANGLE, l->angle, l->channel, conic_load_16(first + 18));
  number_state_of(l, SOURCE, l->source, l->channel, conic_load_16(first + 20));
  times_of(l, l->channel, first);
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

/* The item of the point before, which the next one takes the place of. */
static inline unsigned char *turn_item(conic_laz_layered *l, int layer, unsigned channel, unsigned version) {
  unsigned char(*last)[CONIC_LAZ_WAVE_BYTES] = l->last_items[layer - COLOR];
  unsigned from, which = take_turn(&l->turns[layer - COLOR], channel, version, &from);
  if (from != channel)
    memcpy(last[channel], last[from], item_bytes[layer - COLOR]);
  return last[which];
}

static void read_color_layer(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                             unsigned char *record) {
  unsigned char *last = turn_item(l, COLOR, hints->item_channel, l->format->color_version);
  (void)before;
  conic_laz_color(&l->streams[COLOR], &l->colors[hints->item_channel], last, last);
  memcpy(record + item_place(l->format, COLOR), last, 6);
}

static void read_nir_layer(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                           unsigned char *record) {
  unsigned char *last = turn_item(l, NIR, hints->item_channel, l->format->color_version);
  (void)before;
  conic_laz_nir(&l->streams[NIR], &l->nirs[hints->item_channel], last, last);
  memcpy(record + item_place(l->format, NIR), last, 2);
}

static void read_wave_layer(conic_laz_layered *l, const point_hints *hints, const unsigned char *before,
                            unsigned char *record) {
  unsigned char *last = turn_item(l, WAVE, hints->item_channel, l->format->wave_version);
  (void)before;
  conic_laz_wave(&l->streams[WAVE], &l->waves[hints->item_channel], last, last);
  memcpy(record + item_place(l->format, WAVE), last, CONIC_LAZ_WAVE_BYTES);
}

/* Reads one extra byte of n points. The turns of channels are the same for all extra bytes. */
static void read_extra_layer(conic_laz_layered *l, size_t i_extra, item_turn turn, size_t n, unsigned char *byte) {
  const conic_laz_format *format = l->format;
  extra_byte *extra = &l->extra[i_extra];
  unsigned char *last = extra->last;
  for (size_t i = 0; i < n; i++, byte += format->point_bytes) {
    unsigned channel = l->hints[i].item_channel, from, which = take_turn(&turn, channel, format->extra_version, &from);
    if (from != channel)
      last[channel] = last[from];
    last[which] = (unsigned char)(last[which] + conic_laz_symbol(&extra->stream, &extra->models[channel], 256));
    *byte = last[which];
  }
}

/* --- all layers of some points --- */

static void read_extra_layers(conic_laz_layered *l, size_t n, unsigned char *records) {
  const conic_laz_format *format = l->format;
  item_turn before = l->extra_turn;
  unsigned from;
  for (size_t i = 0; i < n; i++)
    take_turn(&l->extra_turn, l->hints[i].item_channel, format->extra_version, &from);
  for (size_t i = 0; i < format->n_extra; i++)
    if (l->extra[i].stream.length) {
      read_extra_layer(l, i, before, n, records + format->point_bytes - format->n_extra + i);
      l->is_spoiled |= l->extra[i].stream.is_spoiled;
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
  for (size_t i = 0; i < n; i++) /* fields without a layer are the first point's */
    memcpy(records + i * point_bytes, l->first, point_bytes);
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
  memset(l->is_used, 0, sizeof l->is_used);
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
