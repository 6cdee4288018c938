/* From places to splats: what the clouds have there, in the order of the file. */
#ifndef CONIC_LAYERS_GATHER_H
#define CONIC_LAYERS_GATHER_H

#include "core/pictures/georeference.h"
#include "lod/layers/draw/layers_cut.h"
#include "lod/layers/draw/layers_set.h"

typedef conic_status conic_layers_set_receiver(void *cookie, conic_layers_set *set);

typedef struct conic_layers_gathering {
  const conic_layers_cut *cut;
  const uint32_t *chosen; /* places of the cut, ascending */
  size_t n_chosen;
  const conic_layers_view *view;
  const conic_layers_view *part_view; /* null: for all of the picture; else what may meet the part of it is taken, */
  conic_window part;                  /* in the pixels of this view, */
  int samples;                        /* so many of which, a side, are one of the places', */
  int takes_counted;                  /* and all of the places that is_counted tells of */
  float cutoff;
  const conic_camera *camera;         /* that dots are turned to; null: they are left as they are */
  double until_s;                     /* by conic_seconds_now; infinite: clouds are waited for */
  conic_layers_set_receiver *receive; /* null: all is gathered at once; else it is handed over part by part, with the
                                         pieces that it came of; clip lines are not listed yet */
  conic_layers_set_receiver *look;    /* called where nothing is handed over, as more has come of the pieces; or null */
  void *cookie;
  const unsigned char *is_counted; /* a place of the cut: 0 where the set's numbers are not to tell of it; null: none */
  size_t most; /* splats of a part, but where one place's of one cloud are more; of all, which then are cut short, where
                  nobody receives parts (0: any number) */
} conic_layers_gathering;

/* How much of a chosen place is taken, about: 0 to 1. */
double conic_layers_share_of_place(const conic_layers_gathering *gathering, uint32_t i_place);

/* Fills the set with what is to be drawn of the places that are shown or grazing; those hidden give nothing. Clouds are
 * read once each, in the order of the file, no more of them at a time than the cache holds. Errors: as
 * conic_layers_store_load, and the receiver's. */
conic_status conic_layers_gather(conic_layers *layers, const conic_layers_gathering *gathering, conic_layers_set *set);

/* Fills the layers' own set, which *set becomes, with the samples that conic_layers_read_samples gives for a part, and
 * those beside it that reach into it: all at once, in the order of the file, the dots as they are. Where there are more
 * than `most` (0: any number) the set is cut short. Errors: as there. */
conic_status conic_layers_gather_part(conic_layers *layers, float cutoff, const conic_layers_region *part, size_t most,
                                      conic_layers_set **set);

/* Which world its coordinates are of, as far as the file says so; the caller releases it. Errors: MEMORY. */
conic_status conic_layers_find_georeference(const conic_layers *layers, conic_georeference *reference);

#endif
