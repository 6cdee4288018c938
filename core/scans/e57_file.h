/* The bytes of an E57 file (ASTM E2807): pages whose last four bytes are the checksum of the others. */
#pragma once

#include "core/files/mapping.h"

typedef struct conic_e57_file {
  conic_context *context;
  const char *name; /* for messages */
  conic_mapping mapping;
  uint64_t page_bytes, xml_offset, xml_bytes; /* where the XML begins in the file, and how long it is */
  uint64_t sound_page;                        /* the last page whose sum was right; UINT64_MAX: none was checked */
} conic_e57_file;

/* Opens the file at the start of an input, which is not read any further afterwards. On success the caller closes it;
 * on failure it is closed. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_e57_file_open(conic_input *input, conic_e57_file *file);
void conic_e57_file_close(conic_e57_file *file);

/* Copies n bytes of content from *offset in the file, and moves *offset past them. Skips the sums of pages, and checks
 * them. Errors: INPUT. */
conic_status conic_e57_file_take(conic_e57_file *file, uint64_t *offset, void *to, size_t n);

/* The same without a copy. */
conic_status conic_e57_file_skip(conic_e57_file *file, uint64_t *offset, uint64_t n);

/* Corrects the sums of a file's pages, for tests and fuzzing, which the sums would otherwise stop. */
void conic_e57_mend(unsigned char *bytes, size_t n_bytes);

/* Logs "FILE: what (at byte N)" and returns INPUT. */
conic_status conic_e57_wrong(const conic_e57_file *file, const char *what, uint64_t at);

/* The description of an E57 file's scans, from its XML. */

enum { CONIC_E57_MOST_COLUMNS = 64, CONIC_E57_NAME_ROOM = 40 };

typedef enum conic_e57_type { CONIC_E57_INTEGER, CONIC_E57_SCALED, CONIC_E57_SINGLE, CONIC_E57_DOUBLE } conic_e57_type;

/* A value that every record of a scan has, in `bits` of the column's own stream: a float, or an integer's difference
 * from `low`; a scaled integer is multiplied by `scale`, then `offset` is added. */
typedef struct conic_e57_column {
  char name[CONIC_E57_NAME_ROOM]; /* "cartesianX", "intensity" …; cut */
  conic_e57_type type;
  unsigned bits; /* 0 to 64 */
  int64_t low, high;
  double scale, offset;
} conic_e57_column;

/* The range that a scan states for its colours or intensities. */
typedef struct conic_e57_limits {
  int is_there;
  double low, high;
} conic_e57_limits;

typedef struct conic_e57_scan {
  uint64_t records_offset; /* of the section with its points, in the file; 0: it has none */
  uint64_t n_records;
  int has_pose;
  double rotation[4];    /* w, x, y, z; unit */
  double translation[3]; /* where the scanner stood */
  conic_e57_limits color;
  size_t first_column, n_columns; /* in the tree's columns, CONIC_E57_MOST_COLUMNS at most */
  const conic_e57_column *columns;
} conic_e57_scan;

typedef struct conic_e57_tree {
  conic_e57_scan *scans;
  conic_e57_column *columns;
  size_t n_scans, n_columns;
} conic_e57_tree;

/* Reads the file's XML. On success the caller releases it. Errors: INPUT, MEMORY, UNSUPPORTED (a build without
 * libxml2). */
conic_status conic_e57_tree_read(conic_e57_file *file, conic_e57_tree *tree);
void conic_e57_tree_release(conic_context *context, conic_e57_tree *tree);

/* The column of that name; -1: none. */
int conic_e57_column_find(const conic_e57_scan *scan, const char *name);

/* The records of an E57 scan: a stream of bits for each column, in packets. */

enum { CONIC_E57_BLOCK = 256 };

/* Bytes of a column that have been read and not yet decoded. */
typedef struct conic_e57_stream {
  unsigned char *bytes;
  size_t n, room;
  uint64_t bit; /* of the next value, from the first byte on */
  int is_wanted;
} conic_e57_stream;

typedef struct conic_e57_records {
  conic_e57_file *file;
  const conic_e57_scan *scan;
  uint64_t packet; /* offset of the next packet in the file */
  uint64_t n_left; /* records */
  conic_e57_stream streams[CONIC_E57_MOST_COLUMNS];
} conic_e57_records;

/* Begins with the first record. The caller then says which streams it wants; their columns together take some bits a
 * record. The caller closes it, on failure too. Errors: INPUT. */
conic_status conic_e57_records_open(conic_e57_file *file, const conic_e57_scan *scan, conic_e57_records *records);
void conic_e57_records_close(conic_e57_records *records);

/* Makes the next records ready, at most CONIC_E57_BLOCK; *n says how many, 0 past the last. Errors: INPUT, MEMORY. */
conic_status conic_e57_records_fill(conic_e57_records *records, size_t *n);

/* Takes the next n values of a wanted column, at most as many as are ready. */
void conic_e57_records_take(conic_e57_records *records, int column, size_t n, double *values);
