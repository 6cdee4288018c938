/* Measures two files for conic diff, and reports the result. */

#include "cli/commands/diff_job.h"
#include "core/files/file.h"
#include "core/image/compare.h"
#include "core/image/image_common.h"

int cli_diff_has_values(const conic_difference *difference) {
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (difference->planes[i].compared && !conic_plane_describe((conic_plane)i)->is_uint)
      return 1;
  return 0;
}

int cli_diff_is_past(const cli_diff_limits *limits, const conic_difference *difference) {
  int asks_color = limits->has_min_psnr || limits->has_min_ssim || limits->has_max_flip;
  if (!limits->has_max_abs && !asks_color)
    return !difference->identical;
  if (!difference->same_size || (asks_color && !difference->has_color))
    return 1;
  if (limits->has_max_abs && (!cli_diff_has_values(difference) || !(difference->max_abs <= limits->max_abs)))
    return 1;
  return (limits->has_min_psnr && !(difference->psnr >= limits->min_psnr)) ||
         (limits->has_min_ssim && !(difference->ssim >= limits->min_ssim)) ||
         (limits->has_max_flip && !(difference->flip <= limits->max_flip));
}

/* NaN becomes null. */
static void report_count(cli_json *json, const char *key, int is_known, size_t count) {
  if (is_known)
    cli_json_count(json, key, count);
  else
    cli_json_number(json, key, NAN);
}

void cli_diff_report(cli_json *json, const conic_difference *difference) {
  int has_values = cli_diff_has_values(difference), has_color = difference->has_color;
  cli_json_bool(json, "identical", difference->identical);
  cli_json_figures(json, NULL, {"max_abs", has_values ? difference->max_abs : NAN},
                   {"rmse", has_values ? difference->rmse : NAN}, {"p999", has_values ? difference->p999 : NAN},
                   {"psnr", has_color ? difference->psnr : NAN}, {"ssim", has_color ? difference->ssim : NAN},
                   {"ssim_padded", has_color ? difference->ssim_padded : NAN},
                   {"flip", has_color ? difference->flip : NAN});
  report_count(json, "over_code", has_color, difference->over_code);
  report_count(json, "differing_pixels", difference->same_size, difference->differing_pixels);
  report_count(json, "largest_hole", difference->same_size, difference->largest_hole);
  if (!has_color)
    return;
  cli_json_text(json, "color_channels", difference->lacks_alpha ? "RGB" : "RGBA");
  cli_json_bool(json, "display_values", difference->is_display != 0);
}

/* Whether a file holds colours as they were computed, and has no place to say whether they are display values. */
static int is_silent(const char *path) {
  static const char *const endings[] = {"pfm", "hdr", "npy", "npz"};
  int is_it = 0;
  for (int k = 0; k < 4; k++)
    is_it |= conic_file_has_ending(path, endings[k]);
  return is_it;
}

/* A file that cannot say what its colours are, beside one that says display values, most likely has the same. */
static void follow_partner(const cli_diff_job *job, const char *const paths[2], conic_image images[2]) {
  int i = images[0].is_display != 0;
  if (job->display != CLI_DISPLAY_AUTO || images[1 - i].is_display == images[i].is_display || !is_silent(paths[i]))
    return;
  images[i].is_display = 1;
  if (!job->is_told)
    cli_warn(job->session,
             "%s: it does not say what its colours are: taken as display values, which %s has; --display %s "
             "takes them as linear",
             paths[i], paths[1 - i], i ? "a" : "b");
}

/* Says where the picture of a file that cannot say what its colours are would be far nearer with the other meaning. */
static void warn_of_meaning(const cli_diff_job *job, const char *const paths[2], conic_image images[2],
                            const conic_difference *found) {
  conic_difference other;
  for (int i = 0; i < 2; i++) {
    if (job->display != CLI_DISPLAY_AUTO || found->is_display || !(found->psnr < 30.0) || !is_silent(paths[i]))
      continue;
    images[i].is_display = 1;
    if (conic_image_compare(job->session->context, &images[0], &images[1], &other) == CONIC_OK &&
        other.psnr > found->psnr + 10.0)
      cli_warn(job->session,
               "%s: as display values, its colours are far nearer, by %.2f dB: --display %s takes them so", paths[i],
               other.psnr - found->psnr, i ? "b" : "a");
    images[i].is_display = 0;
  }
}

/* Says where one picture shows something in all that the other leaves transparent. */
static void warn_of_background(const cli_diff_job *job, const char *const paths[2], const conic_image images[2]) {
  for (int i = 0; i < 2; i++) {
    const float *front = images[i].planes[CONIC_PLANE_RGBA], *back = images[1 - i].planes[CONIC_PLANE_RGBA];
    const size_t n = 4 * conic_image_pixels(&images[i]);
    size_t n_behind = 0, n_whole = 0;
    for (size_t k = 0; k < n; k += 4) {
      n_whole += back[k + 3] == 1.0f;
      n_behind += front[k + 3] == 0.0f && (back[k] != 0.0f || back[k + 1] != 0.0f || back[k + 2] != 0.0f);
    }
    if (n_behind && 4 * n_whole == n)
      cli_warn(job->session,
               "%s has a background, of %zu pixels that %s leaves transparent: their colours are compared "
               "with black",
               paths[1 - i], n_behind, paths[i]);
  }
}

/* Files of floats hold the values that were written; all others hold codes for a screen. */
static void set_display(const cli_diff_job *job, int i, const char *path, conic_image *image) {
  int is_asked = job->display == CLI_DISPLAY_BOTH || job->display == (i ? CLI_DISPLAY_B : CLI_DISPLAY_A);
  if (job->display == CLI_DISPLAY_NONE)
    image->is_display = 0;
  if (is_asked && (is_silent(path) || conic_file_has_ending(path, "exr")))
    image->is_display = 1;
  if (is_asked)
    conic_image_encode(image);
}

/* Whether a picture of the size of `small` has the proportions of `large`, up to rounding of the sides. */
static int is_smaller(const conic_image *small, const conic_image *large) {
  long long across = (long long)large->width * small->height, down = (long long)small->width * large->height;
  long long off = across > down ? across - down : down - across;
  return small->width <= large->width && small->height <= large->height && (off < large->width || off < large->height);
}

/* --reduce: averages display values, as programs that scale photographs do. */
static conic_status reduce_larger(const cli_diff_job *job, const char *const paths[2], conic_image images[2]) {
  conic_context *context = job->session->context;
  conic_image reduced, *large = &images[0], *small = &images[1];
  if (images[0].width < images[1].width)
    large = &images[1], small = &images[0];
  if (!is_smaller(small, large) || !large->planes[CONIC_PLANE_RGBA])
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %d × %d pixels cannot be reduced to %d × %d of %s",
                      paths[large - images], large->width, large->height, small->width, small->height,
                      paths[small - images]);
  conic_image_encode(large);
  conic_status status = conic_image_reduce(context, large, small->width, small->height, &reduced);
  if (status != CONIC_OK)
    return status;
  conic_image_release(context, large);
  *large = reduced;
  return CONIC_OK;
}

static conic_status fit_sizes(const cli_diff_job *job, const char *const paths[2], int needs_size,
                              conic_image images[2]) {
  if (images[0].width == images[1].width && images[0].height == images[1].height)
    return CONIC_OK;
  if (job->reduces)
    return reduce_larger(job, paths, images);
  if (needs_size)
    return conic_fail(job->session->context, CONIC_ERROR_INPUT, "%s: %d × %d pixels, but %d × %d in %s; see --reduce",
                      paths[1], images[1].width, images[1].height, images[0].width, images[0].height, paths[0]);
  return CONIC_OK;
}

static conic_status write_heatmap(const cli_diff_job *job, const char *path, const conic_image images[2],
                                  const conic_difference *difference) {
  conic_context *context = job->session->context;
  conic_image heatmap;
  if (!path)
    return CONIC_OK;
  if (!difference->same_size) {
    conic_log(context, CONIC_LOG_WARNING, "%s: not written: the images differ in size", path);
    return CONIC_OK;
  }
  if (!difference->has_color)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: not written: not both images have colour", path);
  conic_status status = job->is_flip_map ? conic_image_flip_heatmap(context, &images[0], &images[1], &heatmap)
                                         : conic_image_heatmap(context, &images[0], &images[1], &heatmap);
  if (status != CONIC_OK)
    return status;
  status = conic_image_write(context, path, &heatmap);
  conic_image_release(context, &heatmap);
  return status;
}

conic_status cli_diff_measure(const cli_diff_job *job, const char *const paths[2], const char *heatmap_path,
                              int needs_size, conic_image images[2], conic_difference *difference) {
  conic_context *context = job->session->context;
  conic_status status = CONIC_OK;
  for (int i = 0; i < 2 && status == CONIC_OK; i++) {
    status = conic_image_read(context, paths[i], &images[i]);
    if (status == CONIC_OK)
      set_display(job, i, paths[i], &images[i]);
  }
  if (status == CONIC_OK)
    status = fit_sizes(job, paths, needs_size, images);
  if (status == CONIC_OK) {
    follow_partner(job, paths, images);
    status = conic_image_compare(context, &images[0], &images[1], difference);
  }
  if (status == CONIC_OK && difference->has_color && !job->is_told) {
    warn_of_meaning(job, paths, images, difference);
    warn_of_background(job, paths, images);
  }
  if (status == CONIC_OK)
    status = write_heatmap(job, heatmap_path, images, difference);
  return status;
}
