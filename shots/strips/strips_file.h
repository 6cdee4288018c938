/* The file OUT.strips, by which a picture that is drawn in strips (shots/strips.h) is gone on with. Behind
 * "conic strips 1", a key and zeros, 128 bytes together, come records: a conic_strip_piece, and what it says that
 * follows. Numbers are as in the memory of the machine, which heads tell: the bytes of another order do not have their
 * check.
 *
 * What is packed may stand in OUT.part instead, the picture as far as it is written. A record counts if all of its
 * bytes are as they were when it was made: whatever ended the run, and in which order a disk wrote. Behind a head that
 * does not count, none does. A strip is finished if its last record, of no rows, counts, and those of all of its rows.
 */
#pragma once

#include "core/files/pile.h"
#include "core/files/sha256.h"
#include "source/source_parts.h"

/* Some rows of a strip, packed or as pixels, or both where pixels are hashed; or that this was all of it. */
typedef struct conic_strip_piece {
  uint64_t check;         /* of the rest of this */
  uint64_t checks[2];     /* of what is packed, and of the pixels: conic_hash_bytes */
  uint64_t packed_bytes;  /* 0: only pixels */
  uint64_t pixel_bytes;   /* behind what is packed; without rows those of a conic_strip_end */
  uint64_t place;         /* in OUT.part, of what is packed; 0: it follows */
  int32_t y_begin, y_end; /* of the strip */
  int32_t y, n_rows;      /* of it; 0: there are no more */
} conic_strip_piece;

/* What was counted of a strip, and what else the picture must know of it. */
typedef struct conic_strip_end {
  conic_render_statistics statistics; /* without times and isa */
  uint64_t tallies[CONIC_SOURCE_TALLIES];
  uint64_t hashes[CONIC_MAX_PLANES]; /* of all rows before the strip's end, */
  int32_t has_hashes;                /* if they were known */
  int32_t is_display;
} conic_strip_end;

/* Of the picture. */
typedef struct conic_strips_size {
  int height, step, band_rows; /* as conic_source_windows has them */
  uint64_t row_bytes;          /* of a row's pixels */
  uint64_t most_bytes;         /* of a piece */
  int is_hashed;               /* pixels, or the hashes, are needed */
} conic_strips_size;

/* A record, and where in OUT.strips stands what follows its head. */
typedef struct conic_strip_record {
  conic_strip_piece piece;
  uint64_t at;
  size_t i; /* its number */
} conic_strip_record;

typedef struct conic_strips_file {
  conic_pile list;           /* OUT.strips; its length is where the next record goes */
  conic_scratch part;        /* OUT.part, to be read */
  conic_strip_record *found; /* of finished strips, from the top; each one's end behind its rows */
  size_t n_found;
} conic_strips_file;

/* Begins to keep a picture in the files LIST and PART, whose names are to outlive the file. With is_going_on, what is
 * finished is found, and what else there is goes; without, all goes. The caller ends it, also on failure. Errors: INPUT
 * (no such list, or of another key), IO, MEMORY, ARGUMENT (they are inputs). */
conic_status conic_strips_file_begin(conic_context *context, const char *list, const char *part, const char *key,
                                     const conic_strips_size *size, int is_going_on, conic_strips_file *file);
void conic_strips_file_end(conic_context *context, conic_strips_file *file);

/* What is packed and the pixels of a record, of packed_bytes + pixel_bytes. Errors: IO. */
conic_status conic_strips_file_get(const conic_strips_file *file, const conic_strip_record *record, void *bytes);

/* Adds a record; *at is where what follows its head stands. `bytes`: what is packed, unless it has a place, and the
 * pixels. Errors: IO. */
conic_status conic_strips_file_add(conic_strips_file *file, const conic_strip_piece *piece, const void *bytes,
                                   uint64_t *at);
