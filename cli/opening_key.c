#include "cli/opening_key.h"

#include "shots/shot_key.h"

/* Of what reads parts of a file, or a URL. A deadline is another for each picture, but whether there is one counts: it
 * decides whether the source is looked at all around. */
static void add_access(conic_sha256 *sum, const conic_layers_access *access) {
  const double reals[] = {access->connect_seconds, access->stall_seconds, access->pause_seconds};
  conic_key_add_number(sum, access->memory_bytes);
  conic_key_add_number(sum, (uint64_t)access->n_retries);
  conic_key_add_number(sum, (uint64_t)access->n_connections);
  conic_key_add_number(sum, access->seconds > 0.0);
  for (size_t i = 0; i < sizeof reals / sizeof *reals; i++)
    conic_key_add_real(sum, reals[i]);
}

/* With their number: no two lists of words are the same bytes. */
static void add_paths(conic_sha256 *sum, const char *const *paths, size_t n_paths, const char *texture_path) {
  conic_key_add_number(sum, n_paths);
  for (size_t i = 0; i < n_paths; i++)
    conic_key_add_text(sum, paths[i]);
  conic_key_add_text(sum, texture_path ? texture_path : "");
}

void cli_opening_key(const char *const *paths, size_t n_paths, const conic_source_options *options, unsigned abilities,
                     char key[CONIC_SHA256_ROOM]) {
  const unsigned in_parts = CONIC_SOURCE_CHOOSES | CONIC_SOURCE_STREAMS;
  conic_sha256 sum;
  conic_shot_file file;
  conic_coloring_options coloring;
  conic_shot_file_init(&file);
  const float usual_cutoff = file.reading.cutoff;
  file.reading = *options;
  file.reading.cutoff = usual_cutoff;
  file.reading.is_whole = !options->is_whole && abilities & in_parts && !(abilities & CONIC_SOURCE_CLUSTERS);
  if (options->coloring) {
    coloring = *options->coloring;
    memset(coloring.up, 0, sizeof coloring.up);
    file.reading.coloring = &coloring;
  }
  if (options->as != CONIC_AS_PATCHES) {
    file.reading.patches = NULL;
    file.reading.h_in_spacings = 0;
  }
  conic_sha256_begin(&sum);
  add_paths(&sum, paths, n_paths, options->texture_path);
  conic_key_add_number(&sum, options->coloring != NULL);
  conic_key_add_fields(&sum, &file, "reading.");
  if (options->access && abilities & (CONIC_SOURCE_READS_PARTS | CONIC_SOURCE_STREAMS))
    add_access(&sum, options->access);
  conic_sha256_end(&sum, key);
}

cli_opened cli_opened_with(const conic_source_options *options) {
  cli_opened opened = {.cutoff = options->cutoff};
  if (options->coloring)
    memcpy(opened.up, options->coloring->up, sizeof opened.up);
  return opened;
}

int cli_is_opened_alike(const conic_source *source, const cli_opened *opened, const conic_source_options *options) {
  const cli_opened wanted = cli_opened_with(options);
  const conic_coloring *coloring = conic_source_coloring(source);
  const int is_height = coloring && strcmp(coloring->field, "height") == 0;
  return (wanted.cutoff == opened->cutoff || !conic_source_measure(source)->follows_cutoff) &&
         (memcmp(wanted.up, opened->up, sizeof wanted.up) == 0 || !is_height);
}
