/* Places of a cluster, found by where they are. Each has the nearest of the sites that were put so far. */
#ifndef CONIC_PLACE_TABLE_H
#define CONIC_PLACE_TABLE_H

#include <stddef.h>
#include <stdint.h>

#include "conic/context.h"

/* Where the surface needs it, surfels lie closer: by halves, so many times at most. */
enum { CONIC_MOST_DEPTH = 3 };

#define CONIC_NO_SITE UINT32_MAX

/* The least cosine between two faces that may have a surfel in common. */
#define CONIC_SITES_ALIKE 0.7

/* The places that sites are to be found for, by groups that face alike and ask for sites of one spacing. */
typedef struct conic_places {
  size_t n;
  const double (*at)[3];
  const uint32_t *group;     /* of each place */
  const double (*facing)[3]; /* of each group: unit */
  const uint8_t *depth;      /* of each group: how often the spacing is halved */
  double spacing;            /* of depth 0 */
  int coarsest, finest;      /* depths that there are */
} conic_places;

/* Each depth has cells of its own, so that few are looked at. What lies in a cell is next to each other, so that they
 * are looked at fast. Zero before the first use. */
typedef struct conic_place_table {
  conic_places places;
  uint32_t *owner;
  size_t room, starts_room, mask;
  uint32_t *starts; /* of each cell in `place` and `at`, by its hash; mask + 1 for each depth */
  uint32_t *place;  /* its number */
  double *at[3];
  double *nearest2; /* the squared distance of its owner; without one, as far as one may be */
} conic_place_table;

/* Takes the places in; their arrays must last as long as the table is used. Sets all owners, for which the caller has
 * room, to NO_SITE. Errors: MEMORY. */
conic_status conic_place_table_fill(conic_context *context, conic_place_table *table, const conic_places *places,
                                    uint32_t *owner);

/* Puts a site there; their numbers ascend. Among the places from number `first` on, it becomes the owner of those that
 * are no farther than the spacing, face alike, and have no owner as near. */
void conic_place_table_put(conic_place_table *table, uint32_t site, const double at[3], const double facing[3],
                           size_t first);

void conic_place_table_release(conic_context *context, conic_place_table *table);

#endif
