#include "core/laz/laz_fields.h"

/* A row for each number of returns, a digit or letter for each return. */
const char conic_laz_returns_16[8][9] = {"FEDCBA98", "E0136AA9", "D1247BBA", "C3458CCB",
                                         "B6789DDC", "AABCDEED", "9ABCDEFE", "89ABCDEF"};

const char conic_laz_returns_6[16][17] = {
    "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
    "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
    "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
    "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455"};

/* --- times --- */

/* Multiples of the last step, as symbols: 0 is no multiple; 1 to 500 are themselves; then come −1 to −10, a time that
 * is written whole, and three for the other sequences. */
enum { MOST_MULTIPLE = 500, LEAST_MULTIPLE = -10, WHOLE = MOST_MULTIPLE - LEAST_MULTIPLE + 1, MOST_SWITCHES = 8 };

static void add_time_step(conic_laz_times *times, int32_t step) {
  times->time[times->last] += (uint64_t)(int64_t)step;
}

/* The upper half is predicted. */
static void read_whole_time(conic_laz_stream *stream, conic_laz_times *times) {
  int32_t upper = (int32_t)(uint32_t)(times->time[times->last] >> 32);
  times->next = (times->next + 1) & 3;
  uint64_t high = (uint32_t)conic_laz_integer_32(stream, &times->off, upper, 8);
  times->time[times->next] = high << 32 | conic_laz_bits(stream, 32);
  times->last = times->next;
  times->step[times->last] = times->n_extreme[times->last] = 0;
}

/* A step beyond the multiples becomes the last step, once there have been several. */
static void read_multiple(conic_laz_stream *stream, conic_laz_times *times, unsigned symbol) {
  static const struct {
    unsigned below, context;
  } groups[] = {{1, 7}, {2, 1}, {10, 2}, {MOST_MULTIPLE, 3}, {MOST_MULTIPLE + 1, 4}, {WHOLE - 1, 5}, {WHOLE, 6}};
  unsigned i = 0, last = times->last;
  while (symbol >= groups[i].below)
    i++;
  uint32_t multiple = symbol <= MOST_MULTIPLE ? symbol : (uint32_t)MOST_MULTIPLE - symbol;
  int32_t predicted = (int32_t)(multiple * (uint32_t)times->step[last]);
  int32_t step = conic_laz_integer_32(stream, &times->off, predicted, groups[i].context);
  int is_extreme = symbol == 0 || symbol == MOST_MULTIPLE || symbol == WHOLE - 1;
  times->n_extreme[last] = symbol == 1 ? 0 : times->n_extreme[last] + is_extreme;
  if (times->n_extreme[last] > 3 && is_extreme) {
    times->step[last] = step;
    times->n_extreme[last] = 0;
  }
  add_time_step(times, step);
}

/* Returns 0 where the symbol led to another sequence, which is read next. */
static int read_time(conic_laz_stream *stream, conic_laz_times *times, int may_be_same) {
  unsigned same = (unsigned)may_be_same, last = times->last;
  int is_first = times->step[last] == 0;
  unsigned symbol = is_first ? conic_laz_symbol(stream, &times->first, 5 + same)
                             : conic_laz_symbol(stream, &times->multiple, WHOLE + 4 + same);
  unsigned unchanged = is_first ? 0 : WHOLE, whole = is_first ? 1 : WHOLE;
  if (same && symbol == unchanged)
    return 1;
  symbol -= same && symbol > unchanged; /* numbered as if there were no symbol for an unchanged time */
  if (symbol > whole) {
    times->last = (last + symbol - whole) & 3;
    return 0;
  }
  if (symbol == whole)
    read_whole_time(stream, times);
  else if (!is_first)
    read_multiple(stream, times, symbol);
  else {
    times->step[last] = conic_laz_integer_32(stream, &times->off, 0, 0);
    times->n_extreme[last] = 0;
    add_time_step(times, times->step[last]);
  }
  return 1;
}

uint64_t conic_laz_time(conic_laz_stream *stream, conic_laz_times *times, int may_be_same) {
  int n_switches = 0;
  while (!read_time(stream, times, may_be_same) && n_switches < MOST_SWITCHES)
    n_switches++;
  stream->is_spoiled |= n_switches == MOST_SWITCHES;
  return times->time[times->last];
}

/* --- colours --- */

static unsigned to_byte(int value) {
  return value < 0 ? 0 : value > 255 ? 255 : (unsigned)value;
}

/* A byte that may have changed; its symbol says by how much. */
static unsigned read_byte(conic_laz_stream *stream, conic_laz_model *model, int has_changed, unsigned predicted,
                          unsigned last) {
  return has_changed ? (predicted + conic_laz_symbol(stream, model, 256)) & 255 : last;
}

/* One byte of each channel. Green is predicted to change as red does, blue as both do on average. */
static void read_others(conic_laz_stream *stream, conic_laz_colors *colors, unsigned changed, const int last[3],
                        int which, unsigned value[3]) {
  int step = (int)value[0] - last[0];
  value[1] = read_byte(stream, &colors->off[2 + which], changed >> (2 + which) & 1, to_byte(step + last[1]),
                       (unsigned)last[1]);
  step = (step + ((int)value[1] - last[1])) / 2;
  value[2] = read_byte(stream, &colors->off[4 + which], changed >> (4 + which) & 1, to_byte(step + last[2]),
                       (unsigned)last[2]);
}

void conic_laz_color(conic_laz_stream *stream, conic_laz_colors *colors, const unsigned char *last,
                     unsigned char *color) {
  int before[2][3];
  unsigned value[2][3], changed = conic_laz_symbol(stream, &colors->changed, 128);
  for (int which = 0; which < 2; which++) {
    for (int channel = 0; channel < 3; channel++)
      before[which][channel] = last[2 * channel + which];
    unsigned red = (unsigned)before[which][0];
    value[which][0] = read_byte(stream, &colors->off[which], changed >> which & 1, red, red);
    value[which][1] = value[which][2] = value[which][0];
  }
  for (int which = 0; which < 2 && changed & 64; which++)
    read_others(stream, colors, changed, before[which], which, value[which]);
  for (int channel = 0; channel < 3; channel++)
    for (int which = 0; which < 2; which++)
      color[2 * channel + which] = (unsigned char)value[which][channel];
}

void conic_laz_nir(conic_laz_stream *stream, conic_laz_nirs *nirs, const unsigned char *last, unsigned char *nir) {
  unsigned changed = conic_laz_symbol(stream, &nirs->changed, 4);
  for (unsigned which = 0; which < 2; which++)
    nir[which] = (unsigned char)read_byte(stream, &nirs->off[which], changed >> which & 1, last[which], last[which]);
}

/* --- waveforms --- */

static uint64_t read_offset(conic_laz_stream *stream, conic_laz_waves *waves, const unsigned char *last) {
  uint64_t offset = conic_load_64(last + 1);
  waves->last_kind = conic_laz_symbol(stream, &waves->offset_kind[waves->last_kind], 4);
  if (waves->last_kind == 3) {
    uint64_t low = conic_laz_bits(stream, 32);
    return (uint64_t)conic_laz_bits(stream, 32) << 32 | low;
  }
  if (waves->last_kind == 2)
    waves->last_step = conic_laz_integer_32(stream, &waves->offset, waves->last_step, 0);
  return waves->last_kind == 0   ? offset
         : waves->last_kind == 1 ? offset + conic_load_32(last + 9)
                                 : offset + (uint64_t)(int64_t)waves->last_step;
}

static void read_wave_number(conic_laz_stream *stream, conic_laz_integer *integer, unsigned context,
                             const unsigned char *last, unsigned char *number) {
  int32_t predicted = (int32_t)conic_load_32(last);
  conic_store_32(number, (uint32_t)conic_laz_integer_32(stream, integer, predicted, context));
}

void conic_laz_wave(conic_laz_stream *stream, conic_laz_waves *waves, const unsigned char *last, unsigned char *wave) {
  wave[0] = (unsigned char)conic_laz_symbol(stream, &waves->index, 256);
  conic_store_64(wave + 1, read_offset(stream, waves, last));
  read_wave_number(stream, &waves->n_bytes, 0, last + 9, wave + 9);
  read_wave_number(stream, &waves->location, 0, last + 13, wave + 13);
  for (unsigned axis = 0; axis < 3; axis++)
    read_wave_number(stream, &waves->direction, axis, last + 17 + (size_t)4 * axis, wave + 17 + (size_t)4 * axis);
}
