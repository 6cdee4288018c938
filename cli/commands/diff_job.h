/* One `conic diff`: of two images, or of two folders of images, view by view. */
#pragma once

#include "cli/json_write.h"
#include "cli/session.h"

/* Which of the images hold display values, even if they say otherwise. */
typedef enum cli_diff_display {
  CLI_DISPLAY_AUTO,
  CLI_DISPLAY_NONE,
  CLI_DISPLAY_A,
  CLI_DISPLAY_B,
  CLI_DISPLAY_BOTH
} cli_diff_display;

/* How the views of both folders are matched; AUTO: by name, else by number, else by order. */
typedef enum cli_diff_match { CLI_MATCH_AUTO, CLI_MATCH_NAME, CLI_MATCH_NUMBER, CLI_MATCH_ORDER } cli_diff_match;

typedef struct cli_diff_limits {
  double max_abs, min_psnr, min_ssim, max_flip;
  int has_max_abs, has_min_psnr, has_min_ssim, has_max_flip;
} cli_diff_limits;

typedef struct cli_diff_job {
  cli_session *session;
  const char *paths[2]; /* images, folders or patterns */
  const char *heatmap_path, *csv_path;
  int is_flip_map, display, match, reduces, is_subset;
  int is_told; /* of folders: a view was measured before, and what is to be said of such pictures was said */
  cli_diff_limits limits;
} cli_diff_job;

/* Compares two files as `job` says. The caller releases the images. Writes a heat map to `heatmap_path`, which may be
 * null. With `needs_size`, images of different sizes are an error that names them. Errors: INPUT, IO, MEMORY,
 * UNSUPPORTED. */
conic_status cli_diff_measure(const cli_diff_job *job, const char *const paths[2], const char *heatmap_path,
                              int needs_size, conic_image images[2], conic_difference *difference);

/* Whether both images have a plane that counts for max_abs. */
int cli_diff_has_values(const conic_difference *difference);

/* Whether the difference exceeds a limit or, without limits, the images are not identical. A limit on something that
 * cannot be measured is exceeded. */
int cli_diff_is_past(const cli_diff_limits *limits, const conic_difference *difference);

/* Writes the keys of a comparison, without those of the planes; null for what could not be measured. */
void cli_diff_report(cli_json *json, const conic_difference *difference);

/* Whether an argument is a folder, or a pattern with * or ?. */
int cli_diff_is_many(const char *path);

/* Compares two folders or patterns. Returns the exit code, after a message. The session is open. */
int cli_diff_folders(cli_diff_job *job);
