#include "cli/host_keeps.h"

#include "core/base/context_struct.h"
#include "core/base/machine.h"

enum { MOST_SOURCES = 4, MOST_FACTS = 16 };

typedef struct kept_source {
  char key[CONIC_SHA256_ROOM];
  cli_opened opened;
  conic_source *source;
  uint64_t last_used;
} kept_source;

/* What files can do that are read in some way. */
typedef struct kept_fact {
  char key[CONIC_SHA256_ROOM];
  unsigned abilities;
} kept_fact;

struct cli_kept {
  conic_context *context;
  conic_renderer *renderer; /* on the processor */
  kept_source sources[MOST_SOURCES];
  uint64_t n_uses;
  kept_fact facts[MOST_FACTS];
  uint64_t n_facts; /* so far; the oldest go */
};

cli_kept *cli_kept_create(void) {
  return calloc(1, sizeof(cli_kept));
}

static void drop_source(kept_source *kept) {
  conic_source_close(kept->source);
  memset(kept, 0, sizeof *kept);
}

static void drop_all(cli_kept *kept) {
  for (int i = 0; i < MOST_SOURCES; i++)
    drop_source(&kept->sources[i]);
  conic_renderer_destroy(kept->renderer);
  conic_context_destroy(kept->context);
  kept->renderer = NULL;
  kept->context = NULL;
}

void cli_kept_destroy(cli_kept *kept) {
  if (kept)
    drop_all(kept);
  free(kept);
}

/* --- the context --- */

/* All of the machine's threads, of which a run uses as many as it asks for: sources stay when the next asks for others.
 */
static conic_status create_context(const conic_context_options *asked, conic_context **context) {
  conic_context_options options = *asked;
  const int n_all = conic_machine_threads();
  options.threads = asked->threads > n_all ? asked->threads : 0;
  return conic_context_create(&options, context);
}

conic_status cli_kept_context(cli_kept *kept, const conic_context_options *options, conic_context **context) {
  if (!kept)
    return conic_context_create(options, context);
  if (kept->context && options->threads > conic_context_threads(kept->context))
    drop_all(kept);
  conic_status status = kept->context ? CONIC_OK : create_context(options, &kept->context);
  *context = kept->context;
  if (status != CONIC_OK)
    return status;
  conic_context_options *now = &kept->context->options; /* what a run may have otherwise than the one before */
  now->log = options->log;
  now->log_cookie = options->log_cookie;
  now->progress = options->progress;
  now->progress_cookie = options->progress_cookie;
  now->isa = options->isa;
  now->large_pages = options->large_pages;
  now->max_texture_bytes = options->max_texture_bytes;
  now->allows_outside = options->allows_outside;
  conic_parallel_limit(kept->context, options->threads);
  return CONIC_OK;
}

void cli_kept_leave(cli_kept *kept, conic_context *context) {
  if (!kept)
    conic_context_destroy(context);
  else if (context) {
    conic_take_back_loans(context);
    context->options.log = NULL; /* whoever heard is gone */
    context->options.progress = NULL;
  }
}

/* --- sources and the renderer --- */

static cli_kept *kept_of(const cli_session *session) {
  return session->host ? session->host->kept : NULL;
}

static cli_kept *keeper_of_sources(const cli_session *session) {
  cli_kept *kept = kept_of(session);
  return kept && session->host->keeps_source ? kept : NULL;
}

conic_source *cli_kept_source(const cli_session *session, const char *key, const conic_source_options *options) {
  cli_kept *kept = keeper_of_sources(session);
  for (int i = 0; kept && i < MOST_SOURCES; i++) {
    kept_source *one = &kept->sources[i];
    if (one->source && strcmp(one->key, key) == 0 && cli_is_opened_alike(one->source, &one->opened, options)) {
      one->last_used = ++kept->n_uses;
      return one->source;
    }
  }
  return NULL;
}

void cli_keep_source(const cli_session *session, const char *key, const conic_source_options *options,
                     conic_source *source) {
  cli_kept *kept = keeper_of_sources(session);
  if (!kept || cli_source_is_kept(session, source))
    return;
  kept_source *place = kept->sources;
  for (int i = 1; i < MOST_SOURCES; i++)
    if (kept->sources[i].last_used < place->last_used)
      place = &kept->sources[i];
  drop_source(place);
  *place = (kept_source){.opened = cli_opened_with(options), .source = source, .last_used = ++kept->n_uses};
  snprintf(place->key, sizeof place->key, "%s", key);
}

int cli_source_is_kept(const cli_session *session, const conic_source *source) {
  const cli_kept *kept = kept_of(session);
  for (int i = 0; source && kept && i < MOST_SOURCES; i++)
    if (kept->sources[i].source == source)
      return 1;
  return 0;
}

unsigned cli_kept_abilities(const cli_session *session, const char *const *paths, size_t n_paths,
                            const conic_source_options *options) {
  cli_kept *kept = keeper_of_sources(session);
  char key[CONIC_SHA256_ROOM];
  if (!kept)
    return conic_source_abilities(paths, n_paths, options);
  conic_source_options told = *options;
  told.keeps_alpha = 0;                                              /* which decides nothing here */
  cli_opening_key(paths, n_paths, &told, CONIC_SOURCE_CHOOSES, key); /* whether it is read whole decides it, too */
  for (int i = 0; i < MOST_FACTS; i++)
    if (strcmp(kept->facts[i].key, key) == 0)
      return kept->facts[i].abilities;
  kept_fact *fact = &kept->facts[kept->n_facts++ % MOST_FACTS];
  fact->abilities = conic_source_abilities(paths, n_paths, options);
  memcpy(fact->key, key, sizeof key);
  return fact->abilities;
}

int cli_kept_renderer(const cli_session *session, cli_device *device, conic_renderer **renderer) {
  cli_kept *kept = kept_of(session);
  if (!kept || !kept->renderer || strcmp(device->name, "cpu") != 0)
    return 0;
  snprintf(device->used, sizeof device->used, "cpu");
  *renderer = kept->renderer;
  kept->renderer = NULL;
  return 1;
}

void cli_keep_renderer(const cli_session *session, const cli_device *device, conic_renderer *renderer) {
  cli_kept *kept = kept_of(session);
  if (kept && !kept->renderer && strcmp(device->name, "cpu") == 0)
    kept->renderer = renderer;
  else
    conic_renderer_destroy(renderer);
}

/* --- pictures and facts --- */

void cli_host_note(cli_host *host, char type, const char *key, const void *value, size_t n_bytes) {
  const size_t n_key = type == 'e' ? 0 : key ? strlen(key) + 1 : 1, n = 1 + n_key + n_bytes;
  if (host->n_facts_bytes + n > host->facts_room) {
    const size_t room = 2 * host->facts_room + n + 4096;
    char *larger = realloc(host->facts, room);
    if (!larger) {
      host->facts_are_lost = 1;
      return;
    }
    host->facts = larger;
    host->facts_room = room;
  }
  char *to = host->facts + host->n_facts_bytes;
  *to++ = type;
  if (n_key)
    memcpy(to, key ? key : "", n_key);
  if (n_bytes)
    memcpy(to + n_key, value, n_bytes);
  host->n_facts_bytes += n;
}

void cli_host_release(cli_host *host) {
  free(host->facts);
  host->facts = NULL;
  host->n_facts_bytes = host->facts_room = 0;
  host->facts_are_lost = 0;
}

conic_status cli_host_allocate_image(cli_session *session, int width, int height, unsigned planes, conic_image *image) {
  const cli_host *host = session->host;
  if (!host || !host->lay_out)
    return conic_image_allocate(session->context, width, height, planes, image);
  memset(image, 0, sizeof *image);
  if (host->lay_out(host->cookie, width, height, planes, image->planes) != 0)
    return CONIC_ERROR_MEMORY;
  image->width = width;
  image->height = height;
  return CONIC_OK;
}

void cli_host_release_image(cli_session *session, conic_image *image) {
  if (session->host && session->host->lay_out)
    memset(image, 0, sizeof *image);
  else
    conic_image_release(session->context, image);
}

void cli_host_take(const cli_session *session, const cli_drawn *drawn) {
  const cli_host *host = session->host;
  if (host && host->take)
    host->take(host->cookie, drawn);
}
