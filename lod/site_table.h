/* Sites by where they are: which of them is nearest to a place. */
#ifndef LOD_SITE_TABLE_H
#define LOD_SITE_TABLE_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

/* Where the surface needs it, surfels lie closer: by halves, so many times at most. */
enum { CONIC_MOST_DEPTH = 3 };

#define CONIC_NO_SITE UINT32_MAX

/* The least cosine between two faces that may have a surfel in common. */
#define CONIC_SITES_ALIKE 0.7

/* What of a site is looked at for each place near it. */
typedef struct conic_site_place {
  double at[3], facing[3];
  uint32_t next[CONIC_MOST_DEPTH + 1]; /* in the cell that it shares with others, of each depth up to its own */
} conic_site_place;

/* Cells are twice as wide as the spacing of their depth: what is within that of a place lies in eight of them. Each
 * depth has two kinds of cells: for the sites of that depth, and for the deeper ones. Zero before the first use. */
typedef struct conic_site_table {
  double low[3], spacing; /* where cells begin; of depth 0 */
  int coarsest, finest;   /* depths that there are */
  size_t n_places, places_room;
  conic_site_place *places;
  size_t buckets_room, mask;
  uint32_t *buckets; /* the first of a cell's sites, by its hash: of each kind mask + 1 */
} conic_site_table;

/* Takes all sites out. `n_expected` is about how many will come. Errors: MEMORY. */
conic_status conic_site_table_clear(conic_context *context, conic_site_table *table, const double low[3],
                                    double spacing, int coarsest, int finest, size_t n_expected);

/* Sites are numbered in turn. Errors: MEMORY. */
conic_status conic_site_table_add(conic_context *context, conic_site_table *table, const double at[3],
                                  const double facing[3], int depth);

/* The nearest site, the first of several, that is nearer than the spacing at that depth and faces alike; or NO_SITE.
 * Sooner where `guess`, a site or NO_SITE, is near. */
uint32_t conic_site_table_nearest(const conic_site_table *table, const double at[3], const double facing[3], int depth,
                                  uint32_t guess);

/* Whether there is one. */
int conic_site_table_has(const conic_site_table *table, const double at[3], const double facing[3], int depth);

void conic_site_table_release(conic_context *context, conic_site_table *table);

#endif
