/* What a sample of a layered point cloud has: the table of attributes at the begin of a file, and where each attribute
 * lies in a record in memory (docs/reference/format-lpc.md). */
#pragma once

#include "core/base/base.h"

/* The head of a sample, while a file is built and in its cloud: 16 bytes. Its other attributes may follow it; only
 * their coders look into them. Samples are `stride` bytes apart, a multiple of 8. */
typedef struct conic_layers_sample {
  uint64_t key;
  uint8_t normal[2]; /* octahedron */
  uint16_t size;     /* outline's radius: the upper half of a float's bits, rounded up; 0: not known */
  uint8_t color[3];  /* sRGB codes */
  uint8_t bare;      /* without a normal yet: conic_layers_bareness, and where in its step it is, in quarters, 2 bits an
                        axis; else 0 */
} conic_layers_sample;

/* SEEN: `normal` is the direction to the scanner, to which the normal is to turn. */
typedef enum conic_layers_bareness { CONIC_LAYERS_BARE = 64, CONIC_LAYERS_SEEN = 64 + 128 } conic_layers_bareness;

static inline const conic_layers_sample *conic_layers_sample_at(const unsigned char *samples, size_t stride, size_t i) {
  return (const conic_layers_sample *)(const void *)(samples + i * stride);
}

static inline conic_layers_sample *conic_layers_sample_in(unsigned char *samples, size_t stride, size_t i) {
  return (conic_layers_sample *)(void *)(samples + i * stride);
}

/* From one sample to the next, where so many bytes follow each. */
static inline size_t conic_layers_stride(size_t extra_bytes) {
  return (sizeof(conic_layers_sample) + extra_bytes + 7) / 8 * 8;
}

typedef enum conic_layers_kind {
  CONIC_LAYERS_POSITION = 0,
  CONIC_LAYERS_NORMAL = 1,
  CONIC_LAYERS_COLOR = 2,
  CONIC_LAYERS_SIZE = 3,
  CONIC_LAYERS_AXES = 4,    /* conic_layers_axes */
  CONIC_LAYERS_OPACITY = 5, /* two bytes, the lower first: 65535 times the opacity */
  CONIC_LAYERS_DOT = 6,     /* a uint8_t: 1 for a dot */
  CONIC_LAYERS_CLIP = 7,    /* conic_layers_lines */
  CONIC_LAYERS_VALUE = 8,   /* a number by name, as its type says */
  CONIC_LAYERS_KINDS = 9
} conic_layers_kind;

/* A flag of an attribute: a reader that does not know it has to give the file up. */
enum { CONIC_LAYERS_NEEDED = 1 };

/* How the numbers of a value are stored. */
typedef enum conic_layers_number {
  CONIC_LAYERS_UINT8 = 0,
  CONIC_LAYERS_INT8 = 1,
  CONIC_LAYERS_UINT16 = 2,
  CONIC_LAYERS_INT16 = 3,
  CONIC_LAYERS_UINT32 = 4,
  CONIC_LAYERS_INT32 = 5,
  CONIC_LAYERS_FLOAT = 6,
  CONIC_LAYERS_DOUBLE = 7,
  CONIC_LAYERS_NUMBERS = 8
} conic_layers_number;

enum { CONIC_LAYERS_ATTRIBUTE_BYTES = 112, CONIC_LAYERS_MOST_ATTRIBUTES = 80, CONIC_LAYERS_MOST_STREAMS = 16 };

typedef struct conic_layers_attribute {
  char name[40]; /* what is shown of it; of a value, what it goes by */
  uint16_t kind, n_streams, type, flags;
  double scale, offset; /* by kind */
  double low, high;     /* of a value, the least and the greatest that is finite */
  double typical[2];    /* and the 2nd and the 98th percentile: the ends of a ramp of colours */
  double error;         /* no value is off by more, in its own unit or, of lengths, as a fraction */
  uint64_t n_bytes;     /* of all clouds */
} conic_layers_attribute;

typedef struct conic_layers_schema {
  uint32_t n;
  uint32_t n_streams;                        /* of all */
  uint32_t extra_bytes, sample_bytes;        /* of a record behind its head; from one record to the next */
  uint32_t at[CONIC_LAYERS_MOST_ATTRIBUTES]; /* in a record; 0: it has none of it */
  conic_layers_attribute list[CONIC_LAYERS_MOST_ATTRIBUTES];
} conic_layers_schema;

/* An ellipse: the lengths of its axes, its normal as an octahedron of half 32767, and how far its first axis is turned
 * from the first axis of conic_layers_frame: the diamond angle, 65536 a turn. */
typedef struct conic_layers_axes {
  float length[2];
  uint16_t normal[2], turn;
} conic_layers_axes;

/* Clip lines. `kind` is 0: none, 1: one, 2: two that both hold, 3: two of which either holds. A line is the diamond
 * angle of (a, b), 2²⁴ a turn, and c over the length of (a, b), from −8 to 8. */
typedef struct conic_layers_lines {
  uint32_t kind;
  uint32_t line[2][2]; /* 24 bits each */
} conic_layers_lines;

/* Adds an attribute of a kind at the end of a record. Returns it; null where there are too many. */
conic_layers_attribute *conic_layers_schema_add(conic_layers_schema *schema, conic_layers_kind kind, const char *name,
                                                unsigned type);

/* Takes an attribute out of the table; records stay as they are. */
void conic_layers_schema_drop(conic_layers_schema *schema, uint32_t i);

/* The first of its kind, as its number; −1: there is none. */
int conic_layers_schema_find(const conic_layers_schema *schema, conic_layers_kind kind);

/* The value that goes by a name, or by one that means the same; −1: there is none. */
int conic_layers_schema_value(const conic_layers_schema *schema, const char *name);

/* Lays records out without the attributes that are not wanted. */
void conic_layers_schema_narrow(conic_layers_schema *schema, const unsigned char *is_wanted);

/* Where attributes lie in records, for a table that was read. Null, or what is wrong with it. */
const char *conic_layers_schema_lay_out(conic_layers_schema *schema);

/* What stand-ins have, where samples have what `schema` says. 0: there are none of these. */
int conic_layers_stand_in_schema(const conic_layers_schema *schema, double quantum, conic_layers_schema *stand_ins);

/* "uint8" …, the name of a number's type; null for one that is none. And back; −1: none. */
const char *conic_layers_number_name(unsigned type);
int conic_layers_number_of(const char *name);

/* From numbers as they lie in a record, little-endian, to values and back. A value that the type does not hold becomes
 * the nearest that it does. */
double conic_layers_number_get(const conic_layers_attribute *attribute, const void *from);
void conic_layers_number_put(const conic_layers_attribute *attribute, double value, void *to);

/* The bytes of attribute k of sample i. */
static inline const unsigned char *conic_layers_value_at(const conic_layers_schema *schema,
                                                         const unsigned char *samples, size_t i, uint32_t k) {
  return samples + i * schema->sample_bytes + schema->at[k];
}

static inline unsigned char *conic_layers_value_in(const conic_layers_schema *schema, unsigned char *samples, size_t i,
                                                   uint32_t k) {
  return samples + i * schema->sample_bytes + schema->at[k];
}
