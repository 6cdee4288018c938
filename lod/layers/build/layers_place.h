/* Samples on the grid of the file, handed over one by one in the order in which they came. */
#ifndef CONIC_LAYERS_PLACE_H
#define CONIC_LAYERS_PLACE_H

#include "lod/layers/build/layers_intake.h"
#include "lod/layers/build/layers_kept.h"
#include "lod/layers/build/layers_tree.h"

/* Takes a sample, which is followed by its own bytes and valid during the call only. */
typedef conic_status conic_layers_take(void *to, const conic_layers_sample *sample);

/* Where samples come from: `run` hands them all over, and does so again when it is called again. */
typedef struct conic_layers_feed {
  conic_status (*run)(const void *from, conic_layers_take *take, void *to);
  const void *from;
  uint64_t n_samples;
} conic_layers_feed;

/* What came in, and the grid. */
typedef struct conic_layers_placing {
  const conic_layers_intake *intake;
  double origin[3], quantum, last; /* the greatest step of an axis */
  size_t sample_bytes;
  const char *task;              /* that progress is of */
  const conic_layers_kept *kept; /* samples in its branches are left out */
} conic_layers_placing;

void conic_layers_placing_init(const conic_layers_intake *intake, const conic_layers_plan *plan, const double origin[3],
                               const conic_layers_kept *kept, const char *task, conic_layers_placing *placing);

/* About the key of a place in world units. */
uint64_t conic_layers_key_about(const conic_layers_placing *placing, const double position[3]);

/* A feed's `run`, from a conic_layers_placing. Errors: MEMORY, IO, CANCELLED, the receiver's. */
conic_status conic_layers_place_all(const void *placing, conic_layers_take *take, void *to);

#endif
