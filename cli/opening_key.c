#include "cli/opening_key.h"

#include <string.h>

static void add_double(conic_sha256 *sum, double number) {
  conic_sha256_add(sum, &number, sizeof number);
}

static void add_count(conic_sha256 *sum, uint64_t count) {
  conic_sha256_add(sum, &count, sizeof count);
}

/* With its length: no two lists of words are the same bytes. */
static void add_text(conic_sha256 *sum, const char *text) {
  add_count(sum, text ? strlen(text) + 1 : 0);
  if (text)
    conic_sha256_add(sum, text, strlen(text));
}

/* Of what reads parts of a file, or a URL. A deadline is another for each picture, but whether there is one counts: it
 * decides whether the source is looked at all around. */
static void add_access(conic_sha256 *sum, const conic_layers_access *access) {
  add_count(sum, access->memory_bytes);
  add_double(sum, access->connect_seconds);
  add_double(sum, access->stall_seconds);
  add_count(sum, (uint64_t)access->n_retries);
  add_double(sum, access->pause_seconds);
  add_count(sum, (uint64_t)access->n_connections);
  add_count(sum, access->seconds > 0.0);
}

static void add_patches(conic_sha256 *sum, const conic_patches_options *patches, int h_in_spacings) {
  const conic_surface_options *surface = &patches->surface;
  add_count(sum, (uint64_t)surface->type);
  add_count(sum, (uint64_t)surface->plane);
  add_count(sum, (uint64_t)surface->weight);
  add_count(sum, (uint64_t)surface->degree);
  add_double(sum, surface->h);
  add_double(sum, surface->neglect);
  add_count(sum, (uint64_t)surface->n_local);
  add_double(sum, surface->cluster);
  add_count(sum, surface->is_sharp);
  add_double(sum, patches->step_px);
  add_double(sum, patches->most_off);
  add_count(sum, (uint64_t)h_in_spacings);
}

static void add_coloring(conic_sha256 *sum, const conic_coloring_options *coloring) {
  add_text(sum, coloring->by);
  add_text(sum, coloring->ramp);
  add_count(sum, (uint64_t)coloring->has_range);
  if (coloring->has_range) {
    add_double(sum, coloring->minimum);
    add_double(sum, coloring->maximum);
  }
}

void cli_opening_key(const char *const *paths, size_t n_paths, const conic_source_options *options, unsigned abilities,
                     char key[CONIC_SHA256_ROOM]) {
  const unsigned in_parts = CONIC_SOURCE_CHOOSES | CONIC_SOURCE_STREAMS;
  conic_sha256 sum;
  conic_sha256_begin(&sum);
  add_count(&sum, n_paths);
  for (size_t i = 0; i < n_paths; i++)
    add_text(&sum, paths[i]);
  add_count(&sum, (uint64_t)options->as);
  add_count(&sum, !options->is_whole && abilities & in_parts && !(abilities & CONIC_SOURCE_CLUSTERS));
  add_count(&sum, (uint64_t)options->n_neighbours);
  add_text(&sum, options->texture_path);
  add_count(&sum, (uint64_t)options->is_smooth);
  add_double(&sum, options->crease_deg);
  add_count(&sum, (uint64_t)options->projects_degrees);
  add_count(&sum, (uint64_t)options->finds_dots);
  add_text(&sum, options->columns);
  add_text(&sum, options->where);
  add_count(&sum, (uint64_t)options->keeps_alpha);
  add_count(&sum, options->gaussians != NULL);
  add_count(&sum, options->coloring != NULL);
  if (options->coloring)
    add_coloring(&sum, options->coloring);
  if (options->access && abilities & (CONIC_SOURCE_READS_PARTS | CONIC_SOURCE_STREAMS))
    add_access(&sum, options->access);
  if (options->patches && options->as == CONIC_AS_PATCHES)
    add_patches(&sum, options->patches, options->h_in_spacings);
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
