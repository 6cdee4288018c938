/* The chart of a Gaussian scene: the error of every profile against the truths over its time. */
#pragma once

#include "bench/chart.h"
#include "cli/json_write.h"

/* The truths: by overlap and by volume. */
enum { CLI_N_TRUTHS = 2 };
extern const char *const cli_truth_names[CLI_N_TRUTHS];

/* Of R, G and B, display values; at the pixels that were sampled. */
typedef struct cli_profile_error {
  double max, rmse, psnr;
  int is_front; /* no other profile is faster and nearer to this truth */
} cli_profile_error;

typedef struct cli_profile_point {
  conic_gaussian_profile profile;
  conic_gaussian_statistics statistics; /* of the fastest frame */
  double ms;                            /* its stages together */
  cli_profile_error errors[CLI_N_TRUTHS];
} cli_profile_point;

typedef struct cli_gaussian_chart {
  /* What is asked for. */
  const char *path, *camera_path, *view; /* without a camera it is framed as by conic render */
  int size[2], most_pixels, is_quick;

  /* What came of it. */
  size_t n_gaussians;
  int n_truths;                    /* flat Gaussians have no volume */
  int step, n_pixels;              /* every so many pixels across and down were compared */
  double quadrature[CLI_N_TRUTHS]; /* how far the truths are sure */
  int n_points;                    /* those of discs are for flat Gaussians */
  cli_profile_point points[CONIC_N_GAUSSIAN_PROFILES];
} cli_gaussian_chart;

/* Measures every profile. Errors: INPUT (no Gaussian scene), MEMORY, CANCELLED. */
conic_status cli_gaussian_chart_measure(cli_session *session, cli_gaussian_chart *chart);

/* FOLDER/profiles.csv and profiles.svg. */
conic_status cli_gaussian_chart_write(cli_session *session, const char *folder, const cli_gaussian_chart *chart);

/* The table on standard output, and the key "profiles" in JSON. */
void cli_gaussian_chart_print(const cli_gaussian_chart *chart);
void cli_gaussian_chart_report(cli_json *json, const cli_gaussian_chart *chart);
