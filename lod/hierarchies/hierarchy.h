/* Hierarchies of points as others write them: octrees whose nodes hold points, with an index that is read page by page.
 * A kind is a file that fills a table of functions, and a line in the list of hierarchy.c. lod/layers/draw makes of it
 * what it draws.
 *
 * A node's place is a cell of the octree: the root's, or an eighth of its parent's. Its name is the 63-bit Morton code
 * of its low corner (lod/layers/format/layers_key.h), and its level. The points of its node and of all nodes above it
 * that lie in a place are drawn there. */
#ifndef CONIC_HIERARCHY_H
#define CONIC_HIERARCHY_H

#include "core/pictures/georeference.h"
#include "lod/hierarchies/point_layout.h"
#include "lod/ranges/ranges.h"

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
/* Reads bytes of the opened file. Errors: as conic_ranges_read. */
conic_status conic_hierarchy_read(const conic_hierarchy *hierarchy, uint64_t offset, size_t n_bytes,
                                  unsigned char **bytes);
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

#endif
