/* What a command of a host's does otherwise than one of a shell's: where its pictures and its facts go, and what it
 * keeps. Without a host each of these does what the program does, or nothing. */
#pragma once

#include "cli/device_option.h"
#include "cli/host.h"
#include "cli/opening_key.h"

/* Adds a record to the host's facts. */
void cli_host_note(cli_host *host, char type, const char *key, const void *value, size_t n_bytes);

/* conic_image_allocate and conic_image_release; of a host, of its arrays. */
conic_status cli_host_allocate_image(cli_session *session, int width, int height, unsigned planes, conic_image *image);
void cli_host_release_image(cli_session *session, conic_image *image);
/* Hands a frame over. */
void cli_host_take(const cli_session *session, const cli_drawn *drawn);

/* A context of these options: the kept one, unless that has too few threads; else a new one. */
conic_status cli_kept_context(cli_kept *kept, const conic_context_options *options, conic_context **context);
/* Ends a context that is not kept; of one that is, takes back the loans. */
void cli_kept_leave(cli_kept *kept, conic_context *context);

/* The kept source of a key (cli/opening_key.h), or null; keeps one, which stays what it is for this run; whether one
 * is. A few are kept, those that were used last. */
conic_source *cli_kept_source(const cli_session *session, const char *key, const conic_source_options *options);
void cli_keep_source(const cli_session *session, const char *key, const conic_source_options *options,
                     conic_source *source);
int cli_source_is_kept(const cli_session *session, const conic_source *source);

/* conic_source_abilities, told from the files once. */
unsigned cli_kept_abilities(const cli_session *session, const char *const *paths, size_t n_paths,
                            const conic_source_options *options);

/* Whether a renderer of that device is kept, which this run then has; keeps one, or destroys it. */
int cli_kept_renderer(const cli_session *session, cli_device *device, conic_renderer **renderer);
void cli_keep_renderer(const cli_session *session, const cli_device *device, conic_renderer *renderer);
