/* From places to splats: what the clouds have there is gathered into a set, in the order of the file. */
#pragma once

#include "lod/layers/draw/layers_cut.h"

/* --- the set --- */

/* What a cloud has in a place of the cut. */
typedef struct conic_layers_piece {
  uint32_t cloud, i_place;
  uint32_t first, end;  /* its samples */
  uint32_t n_chosen;    /* of these, to be drawn: in the set, from `at` on */
  uint32_t n_turned;    /* facing away, and culled */
  uint32_t n_elsewhere; /* meeting no pixel of the part that is gathered for */
  size_t at;
} conic_layers_piece;

/* Splats to draw. Zero before the first use; the memory is kept from set to set. */
struct conic_layers_set {
  conic_splats splats;
  uint32_t *ids;             /* number of each in the file */
  conic_layers_lines *lines; /* of each, where the file has some */
  size_t room;               /* of all three */
  size_t clips_room;
  float *arrays;                    /* conic_layers_set_arrays, each of `room` */
  struct conic_point_values *named; /* the splats' values, where some are kept */
  conic_layers_piece *pieces;       /* those of the last clouds in memory, in the order of the file */
  size_t n_pieces, pieces_room;
  uint64_t n_chosen, n_turned; /* of all pieces since gathering began */
  int is_cut_short;            /* there were more splats than asked for at most */
};
typedef struct conic_layers_set conic_layers_set;

/* Bytes that drawing takes for a splat of a set, with those in the set and with room to grow. */
enum { CONIC_LAYERS_SPLAT_BYTES = 176 };

/* Empties the set, and names the values that its splats are to have. Errors: MEMORY. */
conic_status conic_layers_set_begin(const conic_layers *layers, conic_layers_set *set);

/* How many arrays of floats the splats of a set have. */
size_t conic_layers_set_arrays(const conic_layers *layers);

/* Makes room for `count` splats, and keeps the first `used`. Errors: MEMORY. */
conic_status conic_layers_set_reserve(const conic_layers *layers, conic_layers_set *set, size_t used, size_t count);

/* Makes records of the splats' clip lines, now that all splats are there. Errors: MEMORY. */
conic_status conic_layers_set_list_lines(const conic_layers *layers, conic_layers_set *set);

void conic_layers_set_release(conic_context *context, conic_layers_set *set);

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
double conic_layers_share_of_place(const conic_layers_gathering *asked, uint32_t i_place);

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

/* --- occlusion culling --- */

/* How many surfaces lie behind each other, on average over the pixels that the places cover. It tells whether much is
 * hidden. Each place is taken to show as much of its area as it does on average from all sides. */
double conic_layers_depth_complexity(const conic_layers *layers, const conic_layers_view *view,
                                     const conic_layers_cut *cut);

/* Sets the states of the cut's places. Of places, only how deep they hide is drawn, from front to back, a share at a
 * time. What lies wholly behind what was drawn so far is not drawn any more. Errors: as conic_layers_gather. */
conic_status conic_layers_hide(conic_layers *layers, conic_renderer *renderer, const conic_layers_view *view,
                               const conic_camera *camera, const conic_render_options *render, double until_s,
                               conic_layers_cut *cut, conic_layers_set *set);
