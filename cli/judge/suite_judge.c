/* A case is judged by the bounds in the suite. So the verdict depends only on the suite's bytes, not on the version of
 * conic, and anybody can compute it from the same files. */
#include "cli/judge/suite_judge.h"

#include "cli/judge/suite_files.h"
#include "cli/judge/suite_planes.h"
#include "core/files/file.h"
#include "core/files/mapping.h"

const char *const cli_suite_outcome_names[SUITE_OUTCOMES] = {"right", "wrong", "missing"};

static const unsigned suite_plane_bits = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z;

/* Reads the case's expectations, and checks their hash. */
static conic_status read_expected(conic_context *context, const char *folder, const suite_entry *entry,
                                  suite_planes *planes) {
  char path[4096], found[CONIC_SHA256_ROOM];
  conic_mapping file;
  conic_sha256 sum;
  *planes = (suite_planes){.width = cli_suite_judged(entry->width, entry->step),
                           .height = cli_suite_judged(entry->height, entry->step)};
  conic_status status = cli_suite_join(context, folder, entry->npy, path, sizeof path);
  if (status == CONIC_OK)
    status = conic_mapping_open(context, path, &file);
  if (status != CONIC_OK)
    return status;
  conic_sha256_begin(&sum);
  conic_sha256_add(&sum, file.bytes, file.n_bytes);
  conic_sha256_end(&sum, found);
  if (strcmp(found, entry->sha256) != 0)
    status = conic_fail(context, CONIC_ERROR_INPUT, "%s: it is not the file that the suite's manifest lists", path);
  if (status == CONIC_OK)
    status = cli_suite_take_npy(context, path, file.bytes, file.n_bytes, planes);
  conic_mapping_close(context, &file);
  return status;
}

/* The range that a number of the picture stands for; returns 0 where there is none. */
static int find_suite_number(const conic_picture *picture, size_t pixel, int channel, double *from, double *to) {
  const int plane = channel == 4 ? CONIC_PLANE_Z : CONIC_PLANE_RGBA;
  const size_t at = channel == 4 ? pixel : 4 * pixel + (size_t)channel;
  const float *values = picture->image.planes[plane], *greatest = picture->greatest.planes[plane];
  if (!values || (channel == 3 && picture->image.lacks_alpha))
    return 0;
  *from = (double)values[at];
  *to = greatest ? (double)greatest[at] : *from;
  return 1;
}

static int has_common(double from, double to, float low, float high) {
  return from <= (double)high && to >= (double)low;
}

/* How far a number is outside of its range. Colours count more than depths, as they tell more about a mistake. */
static double find_distance(double from, double to, double low, double high, int channel) {
  double off = from > high ? from - high : to < low ? low - to : INFINITY;
  return channel == 4 && off < INFINITY ? 1e-30 * off : off;
}

/* The i-th pixel that is judged. */
static conic_pixel_class judge_suite_pixel(const conic_picture *picture, const suite_planes *expected, size_t i,
                                           suite_verdict *verdict, double *farthest) {
  const int step = verdict->entry->step, x = cli_suite_judged_at((int)(i % (size_t)expected->width), step),
            y = cli_suite_judged_at((int)(i / (size_t)expected->width), step);
  const size_t pixel = (size_t)y * (size_t)verdict->entry->width + (size_t)x;
  conic_pixel_class class = CONIC_PIXEL_EQUAL;
  for (int c = 0; c < SUITE_CHANNELS; c++) {
    double from, to;
    float ends[SUITE_RANGES];
    if (!find_suite_number(picture, pixel, c, &from, &to))
      continue;
    for (int range = 0; range < SUITE_RANGES; range++)
      ends[range] = expected->numbers[cli_suite_at(expected, range, i) + (size_t)c];
    conic_pixel_class this_one = has_common(from, to, ends[SUITE_VALUE], ends[SUITE_VALUE])  ? CONIC_PIXEL_EQUAL
                                 : has_common(from, to, ends[SUITE_LOW], ends[SUITE_HIGH])   ? CONIC_PIXEL_ROUNDED
                                 : has_common(from, to, ends[SUITE_LEAST], ends[SUITE_MOST]) ? CONIC_PIXEL_EXPLAINED
                                                                                             : CONIC_PIXEL_WRONG;
    class = this_one > class ? this_one : class;
    if (this_one != CONIC_PIXEL_WRONG)
      continue;
    double low = (double)ends[SUITE_LEAST], high = (double)ends[SUITE_MOST];
    double distance = find_distance(from, to, low, high, c);
    if (!(distance > *farthest))
      continue;
    *farthest = distance;
    verdict->x = x;
    verdict->y = y;
    verdict->channel = c;
    verdict->found = from > high ? from : to;
    verdict->low = low;
    verdict->high = high;
  }
  return class;
}

static void judge_suite_picture(const conic_picture *picture, const suite_planes *expected,
                                const suite_judging *judging, suite_verdict *verdict) {
  const size_t n_pixels = (size_t)expected->width * (size_t)expected->height;
  double farthest = -1.0;
  for (size_t i = 0; i < n_pixels; i++)
    verdict->pixels[judge_suite_pixel(picture, expected, i, verdict, &farthest)]++;
  const size_t n_wrong = verdict->pixels[CONIC_PIXEL_WRONG];
  verdict->outcome = n_wrong <= judging->max_wrong ? SUITE_IS_RIGHT : SUITE_IS_WRONG;
  if (n_wrong)
    snprintf(verdict->message, sizeof verdict->message,
             "%s%s%zu of %zu pixels are wrong; at %d,%d %s is %.6g, and may be %.6g to %.6g", verdict->entry->stage,
             verdict->entry->stage[0] ? ": " : "", n_wrong, n_pixels, verdict->x, verdict->y,
             cli_suite_channel_names[verdict->channel], verdict->found, verdict->low, verdict->high);
}

/* Finds the case's picture; returns 0 where there is none. */
static int find_suite_picture(const suite_judging *judging, suite_verdict *verdict, char *path, size_t room) {
  static const char *const endings[] = {"exr", "pfm", "npy", "npz", "png"};
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
    int n = snprintf(path, room, "%s/%s.%s", judging->pictures, verdict->entry->name, endings[i]);
    if (n > 0 && (size_t)n < room && conic_file_is_there(path)) {
      verdict->ending = endings[i];
      return 1;
    }
  }
  return 0;
}

conic_status cli_suite_judge_case(conic_context *context, const suite_judging *judging, const suite_entry *entry,
                                  suite_verdict *verdict) {
  char path[4096];
  suite_planes expected;
  conic_picture picture;
  double start = cli_seconds();
  *verdict = (suite_verdict){.entry = entry, .outcome = SUITE_IS_MISSING};
  conic_status status = read_expected(context, judging->suite, entry, &expected);
  if (status == CONIC_OK && !find_suite_picture(judging, verdict, path, sizeof path))
    snprintf(verdict->message, sizeof verdict->message, "there is no picture of it");
  else if (status == CONIC_OK) {
    verdict->outcome = SUITE_IS_WRONG;
    conic_picture_options reading = judging->reading;
    reading.is_srgb = strcmp(entry->colors, "linear") == 0;
    status = conic_picture_read(context, path, suite_plane_bits, &reading, &picture);
    if (status == CONIC_ERROR_INPUT || status == CONIC_ERROR_UNSUPPORTED) {
      snprintf(verdict->message, sizeof verdict->message, "its picture cannot be read");
      status = CONIC_OK;
    } else if (status == CONIC_OK) {
      const conic_image *image = &picture.image;
      if (image->width != entry->width || image->height != entry->height)
        snprintf(verdict->message, sizeof verdict->message, "the picture has %d x %d pixels, and not %d x %d",
                 image->width, image->height, entry->width, entry->height);
      else if (!(conic_image_planes(image) & 1u << CONIC_PLANE_RGBA))
        snprintf(verdict->message, sizeof verdict->message, "the picture has no colours");
      else
        judge_suite_picture(&picture, &expected, judging, verdict);
      conic_picture_release(context, &picture);
    }
  }
  verdict->seconds = cli_seconds() - start;
  conic_memory_release(context, expected.numbers);
  return status;
}
