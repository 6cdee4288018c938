/* .lpc files: header and index as they are in memory, and how they come from and go to bytes
 * (docs/reference/format-lpc.md). */
#pragma once

#include "core/files/mapping.h"
#include "lod/layers/format/layers_schema.h"

enum {
  CONIC_LAYERS_VERSION = 3, /* that is written; 1 and 2 are read too */
  CONIC_LAYERS_HEADER_BYTES = 256,
  CONIC_LAYERS_ENTRY_BYTES = 128,
  CONIC_LAYERS_OLD_ENTRY_BYTES = 112 /* before version 3 */
};

/* What a reader believes of a file: more is refused. */
enum { CONIC_LAYERS_MOST_SAMPLES = 1 << 17, CONIC_LAYERS_MOST_LEVELS = 128, CONIC_LAYERS_MOST_BITS = 21 };

enum { CONIC_LAYERS_COLORS = 1, CONIC_LAYERS_UNORIENTED = 2, CONIC_LAYERS_ALL_FLAGS = 3 };

typedef struct conic_layers_header {
  uint32_t version, flags;
  uint64_t n_samples; /* of all clouds together */
  uint32_t n_clouds, n_levels;
  uint32_t bits;          /* B: steps of the positions' grid, 2^B an axis */
  uint32_t cloud_size;    /* M, as asked for */
  double origin[3];       /* low corner of the grid, in world units; positions of samples are relative to it */
  double quantum;         /* step of the grid, in world units */
  double low[3], high[3]; /* box of the finite centres that it was built from, in world units */
  double spacing;         /* median sampling distance */
  double splat_radius;    /* lower median over all samples of the outline at full resolution: F_g standard deviations */
  double near_z;
  uint64_t position_bytes, normal_bytes, color_bytes; /* of all clouds, compressed */
  uint64_t file_bytes;
  uint64_t index_sum;    /* conic_checksum of the index */
  uint32_t most_samples; /* of the largest cloud */
  uint32_t most_bytes;   /* of the largest cloud, compressed */
  conic_layers_schema schema;
  float up[3];   /* unit: what points up; zero: it is not known */
  uint32_t epsg; /* the code of the coordinate system; 0: it is not known */
} conic_layers_header;

/* A cloud, and the node of the tree that has it. Clouds are numbered in the order of the file: by level, then by key.
 *
 * A node's *place* is a cell of the grid: all samples, of its own and any other cloud, whose keys begin with the same
 * `depth` bits. Where the node is the finest drawn, its own samples are drawn there, and those of all nodes above it
 * that lie in its place: together T. Every sample is in exactly one cloud. Two nodes of one place lie one above the
 * other, or split samples that coincide. */
typedef struct conic_layers_entry {
  uint64_t key;     /* first of its place: the 3B-bit Morton code's first `depth` bits, then zeros */
  uint64_t offset;  /* of its bytes in the file */
  uint64_t sum;     /* conic_checksum of its bytes */
  uint64_t n_place; /* samples in its place, in all clouds */
  uint32_t n_bytes, n_samples;
  uint32_t parent;  /* number; the root's (0) is 0 */
  uint32_t child;   /* number of the first of its two, the other follows it; 0: a leaf */
  uint32_t n_drawn; /* |T| */
  uint16_t level;   /* 0: the root */
  uint16_t depth;   /* bits of the key that all of its place share, 0 to 3B */
  float spacing;    /* mean distance between neighbours in T (LPC Eq. 2, with the place's own sampling distance) */
  float covering;   /* every sample of its place is at most so far from one of T */
  float radius;     /* no outline with which T is drawn, when it is the finest, is larger */
  float error;      /* nothing then drawn, and nothing that full resolution draws, is farther from the other */
  float center[3], sphere; /* holds every sample of its place with its outline, at this and every finer level; from the
                              origin */
  float axis[3], cone;     /* unit; the least cosine of a normal of its place to it; -1: no bound */
  float growth, reach; /* a sample of T is drawn as large as it is itself, or as reach + growth × its own outline where
                          that is more, up to the radius */
  /* What is drawn in place of T in a coarse picture: circles, whose bytes lie before all clouds'. */
  uint64_t stand_in_sum; /* conic_checksum of these bytes */
  uint32_t stand_in_bytes;
  float stand_in_error, stand_in_radius; /* as those above, where they are drawn */
  uint16_t n_stand_ins, stand_in_cone;   /* the cone in steps of 1/32767, from −1 up */
} conic_layers_entry;

/* Whether a header of CONIC_LAYERS_HEADER_BYTES is as it was written, by its sum. */
int conic_layers_header_is_whole(const unsigned char *bytes);

/* Bytes to header: checks sum and ranges. `name` is for messages; `n_bytes` at least CONIC_LAYERS_HEADER_BYTES, or what
 * there is. Errors: INPUT. */
conic_status conic_layers_read_header(conic_context *context, const char *name, const unsigned char *bytes,
                                      size_t n_bytes, conic_layers_header *header);

/* The index lies behind the header: the table of attributes, then n_clouds × CONIC_LAYERS_ENTRY_BYTES. */
uint64_t conic_layers_index_bytes(const conic_layers_header *header);

/* How many entries there are in memory: a cloud's, and as many again where clouds have stand-ins. Those of cloud i are
 * an entry n_clouds + i, as if a leaf had them as its cloud. */
static inline size_t conic_layers_all_entries(const conic_layers_header *header) {
  return (header->version < 3 ? 1 : 2) * (size_t)header->n_clouds;
}

/* Bytes to index: checks the sum, every range, and that the entries are a tree in the file's order; `entries` has room
 * for conic_layers_all_entries. Fills in the header's schema. Errors: INPUT, MEMORY. */
conic_status conic_layers_read_index(conic_context *context, const char *name, conic_layers_header *header,
                                     const unsigned char *bytes, conic_layers_entry *entries);

/* The table of attributes, in bytes. */
size_t conic_layers_table_bytes(const conic_layers_header *header);
void conic_layers_write_table(const conic_layers_header *header, unsigned char *bytes);

/* The other way. The header gets its own sum. */
void conic_layers_write_entries(const conic_layers_entry *entries, size_t n, unsigned char *bytes);
void conic_layers_write_header(const conic_layers_header *header, unsigned char bytes[CONIC_LAYERS_HEADER_BYTES]);

/* The outline with which a sample is drawn where the node is the finest. `outline` is its own. */
static inline float conic_layers_outline(const conic_layers_entry *entry, float outline) {
  float grown = entry->reach + entry->growth * outline;
  grown = grown > outline ? grown : outline;
  return grown < entry->radius ? grown : entry->radius;
}

/* The last key of a node's place. */
static inline uint64_t conic_layers_last_key(const conic_layers_header *header, const conic_layers_entry *entry) {
  return entry->key + ((UINT64_C(1) << (3 * header->bits - entry->depth)) - 1);
}

/* A cloud's bytes and its stand-ins'. */
static inline uint64_t conic_layers_bytes_together(const conic_layers_entry *entry) {
  return (uint64_t)entry->n_bytes + entry->stand_in_bytes;
}

/* How far rounding moved a sample at most. */
double conic_layers_position_error(const conic_layers_header *header);

/* --- a whole file in memory --- */

typedef struct conic_layers_file {
  conic_context *context;
  const char *name; /* for messages */
  conic_mapping mapping;
  conic_layers_header header;
  conic_layers_entry *entries;
} conic_layers_file;

/* Maps the file and checks header and index; `path` must outlive the file. Errors: INPUT, MEMORY. */
conic_status conic_layers_file_open(conic_context *context, const char *path, conic_layers_file *file);
void conic_layers_file_close(conic_layers_file *file);
