/* What decides how files are read: the key by which an opened source is found again. */
#pragma once

#include "conic/source.h"
#include "core/files/sha256.h"

/* A hash of the paths, and of all fields of the options that count where a source has such abilities; but for those
 * that count of some sources alone, which cli_is_opened_alike compares, and for how Gaussians are composited, which
 * each picture says anew. */
void cli_opening_key(const char *const *paths, size_t n_paths, const conic_source_options *options, unsigned abilities,
                     char key[CONIC_SHA256_ROOM]);

/* What a source was opened with that may count of it. */
typedef struct cli_opened {
  float cutoff; /* counts where sizes follow it */
  double up[3]; /* counts where colours are heights */
} cli_opened;

cli_opened cli_opened_with(const conic_source_options *options);
/* Whether these options, of the same key, make the same source. */
int cli_is_opened_alike(const conic_source *source, const cli_opened *opened, const conic_source_options *options);
