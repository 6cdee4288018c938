/* What decides how files are read: the key by which an opened source is found again. */
#ifndef CONIC_OPENING_KEY_H
#define CONIC_OPENING_KEY_H

#include "conic/source.h"
#include "core/files/sha256.h"

/* A hash of the paths, and of all fields of the options that count where a source has such abilities; but for the
 * cutoff, which counts of some sources alone (conic_source_scale.follows_cutoff), and for how Gaussians are composited,
 * which each picture says anew. */
void cli_opening_key(const char *const *paths, size_t n_paths, const conic_source_options *options, unsigned abilities,
                     char key[CONIC_SHA256_ROOM]);

#endif
