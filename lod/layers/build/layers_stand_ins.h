/* What stands for a node's samples in a coarse picture: circles, each of which holds a few of them and has their mean
 * place, normal and colour (docs/reference/layers.md). */
#pragma once

#include "lod/layers/build/layers_node.h"

/* Where stand-ins are made; each thread has its own. */
typedef struct conic_layers_standing conic_layers_standing;

/* Null where samples of these kinds have none. Errors: MEMORY, UNSUPPORTED. */
conic_status conic_layers_standing_create(const conic_layers_plan *plan, conic_layers_standing **standing);
void conic_layers_standing_destroy(conic_context *context, conic_layers_standing *standing);

/* About what that takes. */
size_t conic_layers_standing_bytes(const conic_layers_plan *plan);

/* Finds the stand-ins of a node whose samples are these, and widens its bounds so that they hold them, too. They stay
 * as those of the first (0) or the second (1) of two. */
void conic_layers_stand_in(conic_layers_standing *standing, const conic_layers_plan *plan, int which,
                           const unsigned char *samples, conic_layers_node *node);

/* Packs them, and fills in what the entry says of them. *bytes is valid until the next call. */
void conic_layers_stand_ins_encode(conic_layers_standing *standing, int which, const conic_layers_node *node,
                                   conic_layers_entry *entry, const unsigned char **bytes);
