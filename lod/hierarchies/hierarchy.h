/* Hierarchies of points as others write them: octrees whose nodes hold points, with an index that is read page by page.
 * A kind is a file that fills a table of functions, and a line in the list of hierarchy.c. lod/layers/draw makes of it
 * what it draws.
 *
 * A node's place is a cell of the octree: the root's, or an eighth of its parent's. Its name is the 63-bit Morton code
 * of its low corner (lod/layers/format/layers_key.h), and its level. The points of its node and of all nodes above it
 * that lie in a place are drawn there. */
#pragma once

#include "core/files/json_read.h"
#include "core/pictures/georeference.h"
#include "lod/ranges/ranges.h"

/* --- points in records --- */

/* A number in a record. */
typedef struct conic_point_field {
  uint32_t at;
  uint8_t n_bytes; /* 0: there is none */
  char type;       /* 'i': two's complement, 'u': unsigned, 'f': IEEE 754 */
} conic_point_field;

typedef struct conic_point_layout {
  uint32_t n_bytes; /* of a record */
  conic_point_field position[3], color[3], intensity;
  double scale[3], offset[3]; /* a position is its number · scale + offset */
} conic_point_layout;

/* Points as they come: each array has room for all of a node. */
typedef struct conic_hierarchy_points {
  size_t n;
  double *position[3]; /* in world units */
  uint16_t *color[3];  /* as in the file, or else the intensity thrice; null: not wanted */
} conic_hierarchy_points;

/* Whether a number can be such a field. */
int conic_point_field_is_good(const conic_point_field *field);

/* Whether points of this layout have colours, or an intensity in place of them. */
int conic_point_layout_has_colors(const conic_point_layout *layout);

/* Takes points->n of them from as many records. */
void conic_point_layout_take(const conic_point_layout *layout, const unsigned char *records,
                             conic_hierarchy_points *points);

/* The same of nothing but colours, or the intensity. */
void conic_point_layout_take_colors(const conic_point_layout *layout, const unsigned char *records,
                                    conic_hierarchy_points *points);

/* Where LAS 1.4 has these in a record of a point format, 0 to 10; 0 where there is no such format. */
int conic_point_layout_of_las(unsigned format, uint32_t n_bytes, conic_point_layout *layout);

enum {
  CONIC_HIERARCHY_LEVELS = 21,             /* at most */
  CONIC_HIERARCHY_NODE_POINTS = 1 << 22,   /* of one node, at most */
  CONIC_HIERARCHY_PAGE_BYTES = 1 << 26,    /* of one page, at most */
  CONIC_HIERARCHY_POINTS_A_BYTE = 1 << 10, /* no bytes hold more */
};

typedef struct conic_hierarchy_node {
  uint64_t key;
  uint64_t offset;  /* of its points; or of the page that tells of it, where only that is known yet */
  uint64_t n_bytes; /* likewise; 0 where they are a file of their own */
  uint32_t n_points;
  uint8_t level;
  uint8_t is_page;
} conic_hierarchy_node;

typedef struct conic_hierarchy_kind conic_hierarchy_kind;

/* What opening finds out. Pages are read as they are needed. */
typedef struct conic_hierarchy {
  conic_context *context;
  const conic_hierarchy_kind *kind;
  const char *name;     /* of the file that was opened: for messages */
  conic_ranges *ranges; /* of the points, */
  conic_ranges *pages;  /* and of the pages: the same, or another */
  conic_ranges_options access;
  double low[3], edge[3];         /* the root's cell, in world units */
  double box_low[3], box_high[3]; /* of the points, as the file says */
  double spacing;                 /* of the root's points; every level halves it */
  uint64_t n_points;              /* of all nodes, as the file says */
  int has_colors;                 /* or an intensity */
  conic_hierarchy_node *nodes;    /* those that are known, in no order; the first: the root's page, or the root */
  size_t n_nodes, nodes_room;
  conic_point_layout layout;
  conic_georeference reference; /* all zero: the file does not say */
  void *own;                    /* the kind's; null, or released as one block */
} conic_hierarchy;

/* Functions that return text say what is wrong, or null. */
struct conic_hierarchy_kind {
  const char *name;
  /* Whether a file that begins with these bytes is one, by its name too. */
  int (*is_one)(const char *name, const unsigned char *head, size_t n_head);
  /* Opens a hierarchy: its members from context to access are given, and `pages` is `ranges`. Fills in the rest, and
   * adds the node of the root's page. What it made is closed on failure, too. */
  conic_status (*open)(conic_hierarchy *hierarchy);
  /* Finds the bytes that hold a node's page, in `pages`, or its points, in `ranges`. */
  void (*locate)(const conic_hierarchy *hierarchy, const conic_hierarchy_node *node, conic_range *range);
  /* Adds the nodes that a page tells of; the page's own node goes. */
  const char *(*take_page)(conic_hierarchy *hierarchy, const conic_hierarchy_node *page, const unsigned char *bytes,
                           size_t n_bytes);
  /* Unpacks a node's points->n points. Any thread. */
  const char *(*decode)(const conic_hierarchy *hierarchy, const conic_hierarchy_node *node, const unsigned char *bytes,
                        size_t n_bytes, conic_hierarchy_points *points);
};

/* The kind of a file by its name and first bytes (CONIC_HIERARCHY_HEAD_BYTES, or all there are), or null. */
enum { CONIC_HIERARCHY_HEAD_BYTES = 429 };
const conic_hierarchy_kind *conic_hierarchy_kind_of(const char *name, const unsigned char *head, size_t n_head);

/* Finds the file that is opened: `path`, or the first EPT or Potree 2 in it where that is a folder. 0: it takes more
 * than `room`. */
enum { CONIC_HIERARCHY_PATH_ROOM = 4096 };
int conic_hierarchy_find_file(const char *path, char *file, size_t room);

/* Whether a path, of a file that can be read or of a folder, is one. */
int conic_hierarchy_is_file(const char *path);

/* The name of its kind; null where it is none. */
const char *conic_hierarchy_name_of(const char *path);

/* Takes over the ranges, of the whole first file; `name` must outlive it. On success the caller owns *hierarchy.
 * Errors: INPUT, IO, MEMORY, UNSUPPORTED, CANCELLED. */
conic_status conic_hierarchy_open(conic_context *context, const conic_hierarchy_kind *kind, const char *name,
                                  conic_ranges *ranges, const conic_ranges_options *access,
                                  conic_hierarchy **hierarchy);
void conic_hierarchy_close(conic_hierarchy *hierarchy);

/* --- for kinds --- */

/* Fails while a kind opens: "NAME: what is wrong". */
conic_status conic_hierarchy_wrong(const conic_hierarchy *hierarchy, const char *what);
/* Reads the first bytes of the opened file. Errors: as conic_ranges_read. */
conic_status conic_hierarchy_read(const conic_hierarchy *hierarchy, size_t n_bytes, unsigned char **bytes);
/* Adds a node, checked on its own. */
const char *conic_hierarchy_add(conic_hierarchy *hierarchy, const conic_hierarchy_node *node);
/* A node's key from its cell's number along each axis; 0 where its level has no such cell. */
int conic_hierarchy_key(uint32_t level, const uint32_t cell[3], uint64_t *key);
/* And back. */
void conic_hierarchy_cell(const conic_hierarchy_node *node, uint32_t cell[3]);
/* Takes all points from records that lie one after the other. */
const char *conic_hierarchy_take_records(const conic_hierarchy *hierarchy, const unsigned char *records, size_t n_bytes,
                                         conic_hierarchy_points *points);
/* What is wrong with the facts, or null: boxes, spacing and scales that are not finite, or too large. */
const char *conic_hierarchy_check(const conic_hierarchy *hierarchy);

extern const conic_hierarchy_kind conic_hierarchy_kind_copc, conic_hierarchy_kind_ept, conic_hierarchy_kind_potree;

/* --- JSON --- */

/* Whether a name ends with this file; what a URL has from "?" on does not count. */
int conic_hierarchy_is_named(const char *name, const char *file);

/* Reads a member of the object that the opened file is; what it does not know it skips. */
typedef conic_status conic_hierarchy_member(conic_hierarchy *hierarchy, conic_json *json, const char *key, void *data);

/* Reads the opened file, member by member. Errors: as conic_ranges_read; INPUT. */
conic_status conic_hierarchy_read_json(conic_hierarchy *hierarchy, conic_hierarchy_member *read, void *data);

/* Reads the array that comes next, of exactly n numbers. */
conic_status conic_hierarchy_numbers(conic_json *json, double *values, size_t n);

/* A whole number from 0 to `most`. */
conic_status conic_hierarchy_count(conic_json *json, uint64_t most, uint64_t *count);

/* --- LAZ --- */

/* Finds how points are packed in a file's bytes up to the points, and keeps it as the hierarchy's own. Errors: INPUT,
 * MEMORY. */
conic_status conic_hierarchy_find_laz(conic_hierarchy *hierarchy, const unsigned char *bytes, size_t n_bytes);

/* Points of one chunk, packed as was found; null, or what is wrong with it. */
const char *conic_hierarchy_take_chunk(const conic_hierarchy *hierarchy, const unsigned char *bytes, size_t n_bytes,
                                       conic_hierarchy_points *points);

/* The same of a whole .laz, or .las, of so many points. */
const char *conic_hierarchy_take_laz(conic_context *context, const unsigned char *bytes, size_t n_bytes,
                                     conic_hierarchy_points *points);
