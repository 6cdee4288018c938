/* The description of an E57 file's scans, from its XML. */
#ifndef CONIC_E57_TREE_H
#define CONIC_E57_TREE_H

#include "core/scans/e57_file.h"

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

#endif
