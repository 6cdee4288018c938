/* Splits each attribute of a cloud's records into streams of bytes that are alike, and joins them again. */
#include "lod/layers/format/layers_code.h"

#include "core/base/byte_order.h"
#include "lod/layers/format/layers_axes.h"

/* How many of a float's 23 bits of fraction are dropped, the last ones: so many of the axes' lengths, and those of
 * sizes beyond `type`. */
enum { AXES_DROPPED = 11, FRACTION_BITS = 23 };

/* Numbers of so many bytes as streams, one for each byte, the lowest first. Coded is the difference of a number to the
 * one before, modulo 2^(8 bytes), with the sign as the lowest bit. */
typedef struct byte_planes {
  unsigned n_bytes;
  uint64_t before;
} byte_planes;

static uint64_t all_ones(unsigned n_bytes) {
  return n_bytes < 8 ? (UINT64_C(1) << 8 * n_bytes) - 1 : UINT64_MAX;
}

static void put_folded(byte_planes *p, uint64_t number, size_t i, unsigned char *const *streams) {
  unsigned n_bits = 8 * p->n_bytes;
  uint64_t difference = (number - p->before) & all_ones(p->n_bytes);
  uint64_t folded = difference << 1 ^ (difference >> (n_bits - 1) ? UINT64_MAX : 0);
  p->before = number;
  for (unsigned k = 0; k < p->n_bytes; k++)
    streams[k][i] = (unsigned char)(folded >> 8 * k);
}

static uint64_t get_folded(byte_planes *p, size_t i, const unsigned char *const *streams) {
  uint64_t folded = 0;
  for (unsigned k = 0; k < p->n_bytes; k++)
    folded |= (uint64_t)streams[k][i] << 8 * k;
  uint64_t difference = folded >> 1 ^ (folded & 1 ? UINT64_MAX : 0);
  p->before = (p->before + difference) & all_ones(p->n_bytes);
  return p->before;
}

/* The code of a length, and back: the bits of the float, without the last `n_dropped`, above those of the least length.
 */
static uint32_t layers_code_length(const conic_layers_attribute *attribute, unsigned n_dropped, uint32_t most,
                                   float length) {
  int64_t code = (int64_t)(((uint64_t)conic_bits_of_float(length) + (UINT64_C(1) << (n_dropped - 1))) >> n_dropped) -
                 (int64_t)attribute->offset;
  return (uint32_t)(code > 0 ? code < (int64_t)most ? code : (int64_t)most : 0);
}

static float layers_length_of(const conic_layers_attribute *attribute, unsigned n_dropped, uint32_t code) {
  uint64_t bits = ((uint64_t)attribute->offset + code) << n_dropped;
  return conic_float_of_bits(bits < 0x7f000000 ? (uint32_t)bits : 0x7f000000);
}

static void split_colors(const conic_layers_schema *schema, uint32_t i_attribute, const unsigned char *samples,
                         size_t n, unsigned char *const *streams) {
  (void)i_attribute;
  static const conic_layers_sample zero;
  const conic_layers_sample *before = &zero;
  for (size_t i = 0; i < n; i++) {
    const conic_layers_sample *sample = conic_layers_sample_at(samples, schema->sample_bytes, i);
    int green = sample->color[1] - before->color[1];
    streams[0][i] = (unsigned char)green;
    streams[1][i] = (unsigned char)(sample->color[0] - before->color[0] - green);
    streams[2][i] = (unsigned char)(sample->color[2] - before->color[2] - green);
    before = sample;
  }
}

static void rejoin_colors(const conic_layers_schema *schema, uint32_t i_attribute, size_t n,
                          const unsigned char *const *streams, unsigned char *samples) {
  (void)i_attribute;
  uint8_t red = 0, green = 0, blue = 0;
  for (size_t i = 0; i < n; i++) {
    conic_layers_sample *sample = conic_layers_sample_in(samples, schema->sample_bytes, i);
    uint8_t difference = streams[0][i];
    sample->color[0] = red = (uint8_t)(red + streams[1][i] + difference);
    sample->color[1] = green = (uint8_t)(green + difference);
    sample->color[2] = blue = (uint8_t)(blue + streams[2][i] + difference);
  }
}

static void split_normals(const conic_layers_schema *schema, uint32_t i_attribute, const unsigned char *samples,
                          size_t n, unsigned char *const *streams) {
  (void)i_attribute;
  uint8_t before[2] = {0, 0};
  for (size_t i = 0; i < n; i++) {
    const conic_layers_sample *sample = conic_layers_sample_at(samples, schema->sample_bytes, i);
    for (int k = 0; k < 2; k++) {
      streams[k][i] = (unsigned char)(sample->normal[k] - before[k]);
      before[k] = sample->normal[k];
    }
  }
}

static void rejoin_normals(const conic_layers_schema *schema, uint32_t i_attribute, size_t n,
                           const unsigned char *const *streams, unsigned char *samples) {
  (void)i_attribute;
  uint8_t codes[2] = {0, 0};
  for (size_t i = 0; i < n; i++) {
    conic_layers_sample *sample = conic_layers_sample_in(samples, schema->sample_bytes, i);
    for (int k = 0; k < 2; k++)
      sample->normal[k] = codes[k] = (uint8_t)(codes[k] + streams[k][i]);
  }
}

/* The sizes' own precision is that of the upper half of a float. */
static unsigned dropped_of_size(const conic_layers_attribute *attribute) {
  return FRACTION_BITS - attribute->type;
}

uint16_t conic_layers_size_as_read(const conic_layers_attribute *sizes, uint16_t size) {
  unsigned n_dropped = dropped_of_size(sizes);
  uint32_t code = layers_code_length(sizes, n_dropped, 255, conic_layers_size_of(size));
  return (uint16_t)(conic_bits_of_float(layers_length_of(sizes, n_dropped, code)) >> 16);
}

uint16_t conic_layers_size_of_axes(float cutoff, const unsigned char *axes) {
  conic_layers_axes ellipse;
  memcpy(&ellipse, axes, sizeof ellipse);
  float longer = ellipse.length[0] > ellipse.length[1] ? ellipse.length[0] : ellipse.length[1];
  return conic_layers_code_size(longer * cutoff);
}

float conic_layers_axis_length(float length) {
  const uint32_t below = (UINT32_C(1) << AXES_DROPPED) - 1;
  return conic_float_of_bits((conic_bits_of_float(length) + (below >> 1) + 1) & ~below);
}

static void split_sizes(const conic_layers_schema *schema, uint32_t i_attribute, const unsigned char *samples, size_t n,
                        unsigned char *const *streams) {
  const conic_layers_attribute *attribute = &schema->list[i_attribute];
  byte_planes p = {1, 0};
  for (size_t i = 0; i < n; i++) {
    float size = conic_float_of_bits((uint32_t)conic_layers_sample_at(samples, schema->sample_bytes, i)->size << 16);
    put_folded(&p, layers_code_length(attribute, dropped_of_size(attribute), 255, size), i, streams);
  }
}

static void rejoin_sizes(const conic_layers_schema *schema, uint32_t i_attribute, size_t n,
                         const unsigned char *const *streams, unsigned char *samples) {
  const conic_layers_attribute *attribute = &schema->list[i_attribute];
  byte_planes p = {1, 0};
  for (size_t i = 0; i < n; i++) {
    float size = layers_length_of(attribute, dropped_of_size(attribute), (uint32_t)get_folded(&p, i, streams));
    conic_layers_sample_in(samples, schema->sample_bytes, i)->size = (uint16_t)(conic_bits_of_float(size) >> 16);
  }
}

/* Five numbers of two bytes each. */
static void split_axes(const conic_layers_schema *schema, uint32_t i_attribute, const unsigned char *samples, size_t n,
                       unsigned char *const *streams) {
  const conic_layers_attribute *attribute = &schema->list[i_attribute];
  byte_planes p[5] = {{2, 0}, {2, 0}, {2, 0}, {2, 0}, {2, 0}};
  for (size_t i = 0; i < n; i++) {
    conic_layers_axes axes;
    memcpy(&axes, conic_layers_value_at(schema, samples, i, i_attribute), sizeof axes);
    const uint32_t numbers[5] = {layers_code_length(attribute, AXES_DROPPED, 65535, axes.length[0]),
                                 layers_code_length(attribute, AXES_DROPPED, 65535, axes.length[1]), axes.normal[0],
                                 axes.normal[1], axes.turn};
    for (int k = 0; k < 5; k++)
      put_folded(&p[k], numbers[k], i, streams + (size_t)k * 2);
  }
}

static void rejoin_axes(const conic_layers_schema *schema, uint32_t i_attribute, size_t n,
                        const unsigned char *const *streams, unsigned char *samples) {
  const conic_layers_attribute *attribute = &schema->list[i_attribute];
  byte_planes p[5] = {{2, 0}, {2, 0}, {2, 0}, {2, 0}, {2, 0}};
  for (size_t i = 0; i < n; i++) {
    uint32_t numbers[5];
    for (int k = 0; k < 5; k++)
      numbers[k] = (uint32_t)get_folded(&p[k], i, streams + (size_t)k * 2);
    const conic_layers_axes axes = {
        {layers_length_of(attribute, AXES_DROPPED, numbers[0]), layers_length_of(attribute, AXES_DROPPED, numbers[1])},
        {(uint16_t)numbers[2], (uint16_t)numbers[3]},
        (uint16_t)numbers[4]};
    memcpy(conic_layers_value_in(schema, samples, i, i_attribute), &axes, sizeof axes);
  }
}

static unsigned lines_of_kind(unsigned kind) {
  return kind < 2 ? kind : 2;
}

size_t conic_layers_count_lines(const unsigned char *kinds, size_t n) {
  size_t n_lines = 0;
  for (size_t i = 0; i < n; i++) {
    if (kinds[i] > 3)
      return SIZE_MAX;
    n_lines += lines_of_kind(kinds[i]);
  }
  return n_lines;
}

static void split_lines(const conic_layers_schema *schema, uint32_t i_attribute, const unsigned char *samples, size_t n,
                        unsigned char *const *streams) {
  byte_planes turn = {3, 0}, off = {3, 0};
  size_t at = 0;
  for (size_t i = 0; i < n; i++) {
    conic_layers_lines lines;
    memcpy(&lines, conic_layers_value_at(schema, samples, i, i_attribute), sizeof lines);
    streams[0][i] = (unsigned char)lines.kind;
    for (unsigned k = 0; k < lines_of_kind(lines.kind); k++, at++) {
      put_folded(&turn, lines.line[k][0], at, streams + 1);
      put_folded(&off, lines.line[k][1], at, streams + 4);
    }
  }
}

static void rejoin_lines(const conic_layers_schema *schema, uint32_t i_attribute, size_t n,
                         const unsigned char *const *streams, unsigned char *samples) {
  byte_planes turn = {3, 0}, off = {3, 0};
  size_t at = 0;
  for (size_t i = 0; i < n; i++) {
    conic_layers_lines lines = {.kind = streams[0][i]};
    for (unsigned k = 0; k < lines_of_kind(lines.kind); k++, at++) {
      lines.line[k][0] = (uint32_t)get_folded(&turn, at, streams + 1);
      lines.line[k][1] = (uint32_t)get_folded(&off, at, streams + 4);
    }
    memcpy(conic_layers_value_in(schema, samples, i, i_attribute), &lines, sizeof lines);
  }
}

/* A float's bits in the order of the floats: what is negative is turned round. */
/* NOLINTBEGIN(clang-analyzer-core.*): every type has bytes */
static uint64_t order_bits(uint64_t bits, unsigned n_bytes) {
  uint64_t sign = UINT64_C(1) << (8 * n_bytes - 1);
  return bits & sign ? ~bits & all_ones(n_bytes) : bits | sign;
}

static uint64_t restore_bits(uint64_t ordered, unsigned n_bytes) {
  uint64_t sign = UINT64_C(1) << (8 * n_bytes - 1);
  return ordered & sign ? ordered & ~sign : ~ordered & all_ones(n_bytes);
}
/* NOLINTEND(clang-analyzer-core.*) */

static int is_floating(const conic_layers_attribute *attribute) {
  return attribute->kind == CONIC_LAYERS_VALUE &&
         (attribute->type == CONIC_LAYERS_FLOAT || attribute->type == CONIC_LAYERS_DOUBLE);
}

/* Whatever is one number in the record, its bytes as they are. */
static void split_bare_numbers(const conic_layers_schema *schema, uint32_t i_attribute, const unsigned char *samples,
                               size_t n, unsigned char *const *streams) {
  const conic_layers_attribute *attribute = &schema->list[i_attribute];
  byte_planes p = {attribute->n_streams, 0};
  for (size_t i = 0; i < n; i++) {
    uint64_t bits = conic_load_bits(conic_layers_value_at(schema, samples, i, i_attribute), p.n_bytes);
    put_folded(&p, is_floating(attribute) ? order_bits(bits, p.n_bytes) : bits, i, streams);
  }
}

static void rejoin_bare_numbers(const conic_layers_schema *schema, uint32_t i_attribute, size_t n,
                                const unsigned char *const *streams, unsigned char *samples) {
  const conic_layers_attribute *attribute = &schema->list[i_attribute];
  byte_planes p = {attribute->n_streams, 0};
  for (size_t i = 0; i < n; i++) {
    uint64_t bits = get_folded(&p, i, streams);
    unsigned char bytes[8];
    conic_store_64(bytes, is_floating(attribute) ? restore_bits(bits, p.n_bytes) : bits);
    memcpy(conic_layers_value_in(schema, samples, i, i_attribute), bytes, p.n_bytes);
  }
}

/* How an attribute becomes streams, and comes back; the kinds that are not here are bare numbers. */
static const struct layers_way {
  void (*split)(const conic_layers_schema *schema, uint32_t i_attribute, const unsigned char *samples, size_t n,
                unsigned char *const *streams);
  void (*rejoin)(const conic_layers_schema *schema, uint32_t i_attribute, size_t n, const unsigned char *const *streams,
                 unsigned char *samples);
} bare_numbers = {split_bare_numbers, rejoin_bare_numbers},
  ways[CONIC_LAYERS_KINDS] = {[CONIC_LAYERS_NORMAL] = {split_normals, rejoin_normals},
                              [CONIC_LAYERS_COLOR] = {split_colors, rejoin_colors},
                              [CONIC_LAYERS_SIZE] = {split_sizes, rejoin_sizes},
                              [CONIC_LAYERS_AXES] = {split_axes, rejoin_axes},
                              [CONIC_LAYERS_CLIP] = {split_lines, rejoin_lines}};

static const struct layers_way *way_of(const conic_layers_attribute *attribute) {
  return ways[attribute->kind].split ? &ways[attribute->kind] : &bare_numbers;
}

void conic_layers_split(const conic_layers_schema *schema, uint32_t i, const unsigned char *samples, size_t n,
                        unsigned char *const *streams, size_t *n_bytes) {
  const conic_layers_attribute *attribute = &schema->list[i];
  way_of(attribute)->split(schema, i, samples, n, streams);
  const size_t n_more = attribute->kind == CONIC_LAYERS_CLIP ? conic_layers_count_lines(streams[0], n) : n;
  for (unsigned k = 0; k < attribute->n_streams; k++)
    n_bytes[k] = k ? n_more : n;
}

void conic_layers_join(const conic_layers_schema *schema, uint32_t i, size_t n, const unsigned char *const *streams,
                       unsigned char *samples) {
  way_of(&schema->list[i])->rejoin(schema, i, n, streams, samples);
}
