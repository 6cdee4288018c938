/* Files of splats of which each of a team's processes reads a part: of a picture it then holds what its windows see. */
#ifndef CONIC_SHARED_SOURCE_H
#define CONIC_SHARED_SOURCE_H

#include "conic/source.h"
#include "core/base/team.h"

/* Collective, as conic_source_open, with the same scale and facts. Where the files are sets of splats (of PLY, with
 * axes or with normals and radii, and without faces, dots or clip lines), of which none needs its neighbours, and
 * nothing is asked for that looks at all of them, nobody holds more than some: the source is then one that is measured,
 * framed and drawn in windows by all processes together, and nothing else. Else each process has the whole. The team
 * stays where it is until the source is closed. Errors: as conic_source_open, CANCELLED. */
conic_status conic_source_open_shared(conic_context *context, const conic_team *team, const char *const *paths,
                                      size_t n_paths, const conic_source_options *options, conic_source **source);

#endif
