/* What the stages of a frame must at least move and compute: a model, counted from the definitions, not measured. */
#include "bench/bench.h"
#include "raster/tiles/band.h"

const char *const cli_bench_stages[CLI_BENCH_N_STAGES] = {"setup", "bin", "visibility", "accumulate", "resolve"};

double cli_bench_stage_ms(const conic_render_milliseconds *ms, int i_stage) {
  const double stages[CLI_BENCH_N_STAGES] = {ms->setup, ms->bin, ms->visibility, ms->accumulate, ms->resolve};
  return stages[i_stage];
}

/* Operations of docs/reference/picture.md's formulas as raster/project/project_splats.c, coverage.h and resolve.c write
 * them, one a sign. */
enum {
  MOVE_CENTER = 18,    /* p and, below, both axes into camera space */
  MOVE_AXES = 36,      /* with the division by p_z */
  FACE = 20,           /* p·(t_u × t_v) in the world and the comparison that culls */
  DUAL_CONIC = 70,     /* variance, centre, dilation, Cholesky */
  DEPTH = 40,          /* iz, its two gradients, its range */
  BOX = 24,            /* the pixels of the outline */
  SURFACE = 25,        /* the normal, ε */
  RAY_SET_UP = 150,    /* in place of DUAL_CONIC: in double, with the box of the projected disc */
  COVERAGE = 12,       /* q, iz, plane_iz, two clamps, the comparison */
  RAY_COVERAGE = 56,   /* u, v, their Jacobian, S, q */
  RAISE_THRESHOLD = 3, /* the smaller iz, times s, the larger */
  KEEP_NEAREST = 1,    /* a comparison */
  SEE = 2,             /* the larger iz against the threshold */
  WEIGH = 20,          /* the exponential, amplitude, floor */
  SUM = 14,            /* Σ w, Σ w c, Σ w n, the heaviest */
  FINISH = 75          /* six divisions, two norms, Phong's shading, exposure */
};

/* Divisions and roots among them. */
enum {
  SPLAT_DIVISIONS = 10, /* 1/p_z, the gradients, Cholesky's four, two of the box, the normal's two */
  RAY_DIVISIONS = 2,    /* of a fragment */
  FINISH_DIVISIONS = 10
};

static double image_bytes_a_pixel(const conic_image *image) {
  double bytes = 0.0;
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (image->planes[plane])
      bytes += 4.0 * conic_plane_describe((conic_plane)plane)->n_channels;
  return bytes;
}

void cli_bench_work_of(const conic_render_statistics *s, const conic_splats *splats, const conic_image *image,
                       int passes, cli_bench_work work[CLI_BENCH_N_STAGES]) {
  const double floats = 4.0;
  double n = (double)s->splats_in, drawn = (double)s->splats_drawn, fragments = (double)s->fragments;
  double rays = (double)s->splats_by_method[CONIC_METHOD_RAY], ray_share = drawn > 0.0 ? rays / drawn : 0.0;
  double pixels = (double)image->width * (double)image->height;
  double footprints = sizeof(conic_footprint) * drawn + sizeof(conic_ray) * rays;
  double coverage = (1.0 - ray_share) * COVERAGE + ray_share * RAY_COVERAGE;

  /* Set-up: centres and axes of all, colours of what is drawn. Its records stay in the core's cache until they are
   * sorted. */
  work[0] = (cli_bench_work){floats * (9.0 * n + 3.0 * drawn + (splats && splats->opacity ? drawn : 0.0)),
                             sizeof(conic_ray) * rays,
                             FACE * n + (MOVE_CENTER + MOVE_AXES + DEPTH + BOX + SURFACE) * drawn +
                                 DUAL_CONIC * (drawn - rays) + RAY_SET_UP * rays,
                             0.0,
                             SPLAT_DIVISIONS * drawn,
                             3.0 * drawn};
  /* Bins: the records in the order of their tiles; at least one entry a splat. */
  work[1] = (cli_bench_work){0.0, sizeof(conic_tile_entry) * drawn, 2.0 * 8.0 * drawn,
                             (sizeof(conic_footprint) + sizeof(conic_projected_surface)) * drawn};
  /* The passes: each record once, what was evaluated for the first is kept for the second, and sums stay at hand. */
  work[2] = (cli_bench_work){sizeof(conic_tile_entry) * drawn + footprints, 0.0,
                             (coverage + (passes == 1 ? KEEP_NEAREST : RAISE_THRESHOLD)) * fragments, 0.0,
                             RAY_DIVISIONS * ray_share * fragments};
  work[3] = (cli_bench_work){sizeof(conic_projected_surface) * drawn, 0.0, (SEE + WEIGH + SUM) * fragments};
  if (passes == 1) /* the colours of those that are nearest somewhere */
    work[3] = (cli_bench_work){0.0, 0.0, (WEIGH + SUM) * (double)s->pixels_covered,
                               .gathered = 3.0 * (double)s->pixels_covered};
  work[4] = (cli_bench_work){0.0, image_bytes_a_pixel(image) * pixels, FINISH * (double)s->pixels_covered, 0.0,
                             FINISH_DIVISIONS * (double)s->pixels_covered};
}
