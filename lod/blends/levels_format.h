/* A .lpc that holds Gaussians in levels: header, index and clouds (docs/reference/format-lpc.md). */
#pragma once

#include "core/files/file_body.h"
#include "core/files/zstd.h"
#include "lod/blends/blend.h"

enum {
  CONIC_LEVELS_VERSION = 5,
  CONIC_LEVELS_ENTRY_BYTES = 24,
  CONIC_LEVELS_CHILDREN = 4,       /* of a cloud */
  CONIC_LEVELS_MOST_CLOUD = 16384, /* that may be asked for */
  CONIC_LEVELS_MOST_DEPTH = 18
};

/* Flags. */
enum { CONIC_LEVELS_ANTIALIASED = 1, CONIC_LEVELS_LINEAR = 2 };

typedef struct conic_levels_header {
  uint32_t version, flags;
  uint64_t n, n_merged;                           /* Gaussians as they came, and such as stand for others */
  uint32_t cloud_size, n_leaves, sh_degree, most; /* clouds of Gaussians as they came; Gaussians in the largest cloud */
  double origin[3], low[3], high[3];
  float up[3];
  char frame[4];
  uint64_t index_at, index_sum;
} conic_levels_header;

typedef struct conic_levels_entry {
  uint64_t offset, sum;
  uint32_t n_bytes, n;
} conic_levels_entry;

/* Clouds by levels, from the root down: a level's first cloud, and how many it has. */
typedef struct conic_levels_shape {
  int n_levels;
  uint32_t first[CONIC_LEVELS_MOST_DEPTH], count[CONIC_LEVELS_MOST_DEPTH], n_clouds;
} conic_levels_shape;

void conic_levels_find_shape(uint32_t n_leaves, conic_levels_shape *shape);

/* A cloud has columns of 32 bits a Gaussian: its row, then of what came its number, of what is merged what is known of
 * its parts, and last its link: the number of what stands for it in the cloud above, and which children have parts of
 * it from bit 16 up. */
static inline size_t conic_levels_row(const conic_levels_header *header) {
  return CONIC_BLEND_HARMONICS + conic_harmonics_of_degree((int)header->sh_degree);
}
static inline size_t conic_levels_columns(const conic_levels_header *header, int is_leaf) {
  return conic_levels_row(header) + (is_leaf ? 1 : CONIC_BLEND_PARTS) + 1;
}
enum { CONIC_LEVELS_PARENT = 0xffff, CONIC_LEVELS_PARTS_BIT = 16 };

/* Whether a file begins as one does, or a URL's name ends in .gaussians.lpc. */
int conic_levels_is_file(const char *path);

/* Errors: INPUT. */
conic_status conic_levels_read_header(conic_context *context, const char *name, const unsigned char *bytes,
                                      size_t n_bytes, uint64_t file_bytes, conic_levels_header *header);
void conic_levels_write_header(const conic_levels_header *header, unsigned char bytes[CONIC_FILE_HEADER_BYTES]);

/* The index: entries by level from the root down. Reading checks every range. Errors: INPUT. */
conic_status conic_levels_read_index(conic_context *context, const char *name, const conic_levels_header *header,
                                     const unsigned char *bytes, conic_levels_entry *entries);
void conic_levels_write_entries(const conic_levels_entry *entries, size_t n, unsigned char *bytes);

/* Packs columns, which it makes into bytes by planes in `planes`, of as many bytes. Returns how many bytes `to`, with
 * room for conic_zstd_bound of them, then has; 0 where memory failed. */
size_t conic_levels_pack(conic_zstd *zstd, const uint32_t *columns, size_t n_columns, size_t n, unsigned char *planes,
                         unsigned char *to);
/* And back. Returns whether that gives exactly so many. */
int conic_levels_unpack(conic_zstd *zstd, const unsigned char *from, size_t n_bytes, size_t n_columns, size_t n,
                        unsigned char *planes, uint32_t *columns);
