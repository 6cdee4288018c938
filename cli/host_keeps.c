#include "cli/host_keeps.h"

#include <stdlib.h>
#include <string.h>

#include "cli/shell.h"
#include "core/base/context_struct.h"

struct cli_kept {
  conic_context_options options; /* of the context, as they were asked for */
  conic_context *context;
  conic_renderer *renderer; /* on the processor */
  conic_source *source;
  char *source_key;
};

cli_kept *cli_kept_create(void) {
  return calloc(1, sizeof(cli_kept));
}

static void drop_source(cli_kept *kept) {
  conic_source_close(kept->source);
  free(kept->source_key);
  kept->source = NULL;
  kept->source_key = NULL;
}

static void drop_all(cli_kept *kept) {
  drop_source(kept);
  conic_renderer_destroy(kept->renderer);
  conic_context_destroy(kept->context);
  memset(kept, 0, sizeof *kept);
}

void cli_kept_destroy(cli_kept *kept) {
  if (kept)
    drop_all(kept);
  free(kept);
}

/* --- the context --- */

static int is_same_context(const conic_context_options *a, const conic_context_options *b) {
  return a->threads == b->threads && a->isa == b->isa && a->large_pages == b->large_pages &&
         a->max_texture_bytes == b->max_texture_bytes;
}

conic_status cli_kept_context(cli_kept *kept, const conic_context_options *options, conic_context **context) {
  if (!kept)
    return conic_context_create(options, context);
  if (kept->context && !is_same_context(&kept->options, options))
    drop_all(kept);
  if (kept->context) { /* messages and progress are this run's */
    kept->context->options.log = options->log;
    kept->context->options.log_cookie = options->log_cookie;
    kept->context->options.progress = options->progress;
    kept->context->options.progress_cookie = options->progress_cookie;
    *context = kept->context;
    return CONIC_OK;
  }
  kept->options = *options;
  conic_status status = conic_context_create(options, &kept->context);
  *context = kept->context;
  return status;
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

/* --- the source and the renderer --- */

static cli_kept *kept_of(const cli_session *session) {
  return session->host ? session->host->kept : NULL;
}

conic_source *cli_kept_source(const cli_session *session) {
  cli_kept *kept = kept_of(session);
  const char *key = kept ? session->host->source_key : NULL;
  if (!kept || !kept->source)
    return NULL;
  if (key && strcmp(key, kept->source_key) == 0)
    return kept->source;
  drop_source(kept);
  return NULL;
}

void cli_keep_source(const cli_session *session, conic_source *source) {
  cli_kept *kept = kept_of(session);
  const char *key = kept ? session->host->source_key : NULL;
  if (!key || kept->source == source)
    return;
  const size_t room = strlen(key) + 1;
  char *copy = malloc(room);
  if (!copy)
    return;
  drop_source(kept);
  kept->source_key = memcpy(copy, key, room);
  kept->source = source;
}

int cli_source_is_kept(const cli_session *session, const conic_source *source) {
  const cli_kept *kept = kept_of(session);
  return source && kept && kept->source == source;
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

/* --- pictures and JSON --- */

FILE *cli_host_open_json(cli_host *host) {
  cli_host_release(host);
  return cli_shell_open_memory(&host->json, &host->json_bytes);
}

int cli_host_close_json(cli_host *host, FILE *json) {
  return cli_shell_close_memory(json, &host->json, &host->json_bytes);
}

void cli_host_release(cli_host *host) {
  free(host->json);
  host->json = NULL;
  host->json_bytes = 0;
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

void cli_host_take(const cli_session *session, int i_frame, const char *view, const conic_image *image,
                   const conic_camera *camera) {
  const cli_host *host = session->host;
  if (host && host->take)
    host->take(host->cookie, i_frame, view, image, camera);
}
