/* One `conic diff`: of two images, or of two folders of them, view by view. */
#ifndef CONIC_DIFF_JOB_H
#define CONIC_DIFF_JOB_H

#include "cli/json_write.h"
#include "cli/session.h"

/* Which of the images hold display values, whatever they say themselves. */
typedef enum cli_diff_display {
  CLI_DISPLAY_AUTO,
  CLI_DISPLAY_NONE,
  CLI_DISPLAY_A,
  CLI_DISPLAY_B,
  CLI_DISPLAY_BOTH
} cli_diff_display;

/* How views find each other; auto is by name, or else by number or order. */
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
  cli_diff_limits limits;
} cli_diff_job;

/* What `job` measures of two files, whose images the caller releases, and its heat map into `heatmap_path`, which may
 * be null. With `needs_size`, images of different sizes are an error, which names them. Errors: INPUT, IO, MEMORY,
 * UNSUPPORTED. */
conic_status cli_diff_measure(const cli_diff_job *job, const char *const paths[2], const char *heatmap_path,
                              int needs_size, conic_image images[2], conic_difference *difference);

/* Whether both images have a plane that max_abs looks at. */
int cli_diff_has_values(const conic_difference *difference);

/* Past a limit, or, where none is given, not identical. A limit cannot be kept by what is not there to be measured. */
int cli_diff_is_past(const cli_diff_limits *limits, const conic_difference *difference);

/* The keys of a comparison but the planes'; what could not be measured is null. */
void cli_diff_report(cli_json *json, const conic_difference *difference);

/* Whether what a user names is a folder, or a pattern with * or ?. */
int cli_diff_is_many(const char *path);

/* Compares two folders or patterns. Returns the exit code, after a message. The session is open. */
int cli_diff_folders(cli_diff_job *job);

#endif
