/* Places of a cluster, by where they are, each with the nearest of the sites that were put so far. */
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

/* Each depth has cells of its own, and what lies in a cell is next to each other, so that few cells are looked at and
 * those fast. Zero before the first use. */
typedef struct conic_place_table {
  conic_places places;
  uint32_t *owner;
  size_t room, starts_room, mask;
  uint32_t *starts; /* of each cell, by its hash, in what follows; of each depth mask + 1 */
  uint32_t *place;  /* its number */
  double *at[3];
  double *nearest2; /* the squared distance of its owner; of none, as far as one may be */
} conic_place_table;

/* Takes the places in, for use as long as the arrays behind them last, and sets all of their owners, room for which is
 * the caller's, to NO_SITE. Errors: MEMORY. */
conic_status conic_place_table_fill(conic_context *context, conic_place_table *table, const conic_places *places,
                                    uint32_t *owner);

/* Puts a site there, their numbers ascending: of the places from number `first` on it becomes the owner where it is no
 * farther than the spacing, faces alike, and is nearer than the owner. */
void conic_place_table_put(conic_place_table *table, uint32_t site, const double at[3], const double facing[3],
                           size_t first);

void conic_place_table_release(conic_context *context, conic_place_table *table);

#endif
