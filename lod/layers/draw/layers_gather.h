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
  const conic_layers_view *part_view; /* null: for all of the picture; else only what may meet `part` is taken */
  conic_window part;                  /* in the pixels of that view */
  int samples;                        /* so many of these pixels, a side, are one of the places' */
  int takes_counted;                  /* also takes all of the places that is_counted tells of */
  float cutoff;
  const conic_camera *camera; /* to which dots are turned; null: they are left as they are */
  double until_s;             /* by conic_seconds_now; infinite: clouds are waited for */
  /* Takes what is gathered, part by part, with the pieces that it came from; clip lines are not listed yet. Null: all
   * is gathered at once. */
  conic_layers_set_receiver *receive;
  conic_layers_set_receiver *look; /* without `receive`: called when more of the pieces has come; or null */
  void *cookie;
  const unsigned char *is_counted; /* a place of the cut: 0 where the set's numbers are not to tell of it; null: none */
  size_t most; /* splats of a part, which has more only where one place's of one cloud are more; without `receive`, of
                  all, and then the set is cut short; 0: any number */
} conic_layers_gathering;

/* About how much of a chosen place is taken: 0 to 1. */
double conic_layers_share_of_place(const conic_layers_gathering *gathering, uint32_t i_place);

/* Fills the set with what is to be drawn of the places that are shown or grazing. Hidden ones give nothing. Each cloud
 * is read once, in the order of the file, and no more at a time than the cache holds. Errors: as
 * conic_layers_store_load, and the receiver's. */
conic_status conic_layers_gather(conic_layers *layers, const conic_layers_gathering *gathering, conic_layers_set *set);

/* Fills the layers' own set, which *set becomes, with the samples that conic_layers_read_samples gives for a part, and
 * with those beside it that reach into it. All come at once, in the order of the file, with the dots as they are. Where
 * there are more than `most` (0: any number), the set is cut short. Errors: as there. */
conic_status conic_layers_gather_part(conic_layers *layers, float cutoff, const conic_layers_region *part, size_t most,
                                      conic_layers_set **set);

/* The world to which the coordinates belong, as far as the file says so. The caller releases it. Errors: MEMORY. */
conic_status conic_layers_find_georeference(const conic_layers *layers, conic_georeference *reference);

#endif
