/* The views of a file of cameras: which are drawn, and how cameras are written. */
#pragma once

#include "cli/json_write.h"
#include "cli/session.h"

/* What --camera, --view and --size say. */
typedef struct cli_views_wish {
  const char *path, *view; /* the view: a name or an index; null: the file's only one */
  int width, height;       /* both 0: the file's */
} cli_views_wish;

/* Whether every view is meant. */
int cli_views_are_all(const char *view);

/* Reads the cameras, which the caller releases, and finds the view; of all, the first. */
conic_status cli_views_read(cli_session *session, const cli_views_wish *wish, conic_cameras *cameras, size_t *i_view);

/* The name of a view without folder and ending, fit for that of a file; its number where it has none. */
void cli_view_stem(const conic_cameras *cameras, size_t i_view, char *stem, size_t room);

/* A camera's members, as a file of one has them. */
void cli_camera_write(cli_json *json, const conic_camera *camera);
