/* Fewer splats and triangles than a drawing has, within an error or a budget, of what is made of it in memory. */
#pragma once

#include "lod/octree/screen_cells.h"
#include "source/lean_cache.h"
#include "source/source_kind.h"

/* What was made, and is kept for further pictures. Zero before the first. */
typedef struct conic_lean_drawing {
  char *cache;  /* the folder that keeps octrees and levels; null: none */
  float cutoff; /* of the octree */
  conic_octree *octree;
  conic_selection nodes;
  conic_screen_cells cells;
  conic_hybrid *levels; /* of the triangles; null where none would do */
  int are_levels_cut;   /* they are for one picture */
  conic_hybrid_selection triangles;
  int is_alone;         /* the last picture's triangles are of levels for it alone, … */
  int is_cut;           /* … its splats of cells, not of the octree */
  size_t n_ids;         /* its triangles are called by numbers from here on */
  double build_seconds; /* of all that was made or read */
  int is_from_cache;
} conic_lean_drawing;

/* Fills in the choice for a picture with an error or a budget. Where nothing is left out, all is drawn, in its order.
 * `unturned` are its splats with dots as they are kept. Errors: ARGUMENT (a budget that is too small), MEMORY,
 * CANCELLED, UNSUPPORTED (transparency). */
conic_status conic_lean_choose(conic_source *source, const conic_drawing *all, const conic_splats *unturned,
                               const conic_camera *camera, const conic_render_options *render,
                               conic_lean_drawing *lean);
/* After a picture of all: how many times fewer splats an error of one pixel leaves. It looks at the middle of the
 * picture, an eighth as wide and high. 1: that is not known. It takes as long as a look at each splat. */
double conic_lean_saving(const conic_source *source, const conic_camera *camera, const conic_render_options *render);

/* Turns the numbers in the picture's plane of ids, where it has one, from those of what was chosen to those of all:
 * first the splats, then the octree's nodes, then the triangles. */
void conic_lean_name(const conic_lean_drawing *lean, const conic_source_choice *choice, conic_image *image);
/* Adds what stood for the splats and triangles of the last picture, and how long building it took. */
void conic_lean_tell(const conic_lean_drawing *lean, const conic_source_choice *choice, conic_facts *facts);
/* Leaves it as before the first picture, without a cache. */
void conic_lean_release(conic_context *context, conic_lean_drawing *lean);
