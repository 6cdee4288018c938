/* Files of splats of which each process of a team reads a part. For a picture, it then holds the splats that its
 * windows need. */
#pragma once

#include "conic/source.h"
#include "core/base/team.h"

/* Collective: opens files as conic_source_open does, with the same scale and facts. Files can be shared if they are
 * sets of splats (PLY, with axes or with normals and radii, without faces, dots or clip lines), if no splat needs its
 * neighbours, and if no option needs all splats at once. Then no process holds more than a part, and the source can
 * only be measured, framed and drawn in windows, by all processes together. Else each process has the whole. The team
 * must exist until the source is closed. Errors: as conic_source_open, CANCELLED. */
conic_status conic_source_open_shared(conic_context *context, const conic_team *team, const char *const *paths,
                                      size_t n_paths, const conic_source_options *options, conic_source **source);
