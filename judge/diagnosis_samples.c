#include "judge/diagnosis_samples.h"

#include "core/base/base.h"
#include "core/base/color.h"
#include "core/base/power.h"

static const struct {
  conic_plane plane;
  int channel;
} channel_of_plane[] = {{CONIC_PLANE_RGBA, 0},
                        {CONIC_PLANE_TRANSPARENCY, CONIC_CHANNEL_T},
                        {CONIC_PLANE_WEIGHT, CONIC_CHANNEL_WEIGHT},
                        {CONIC_PLANE_ALBEDO, CONIC_CHANNEL_ALBEDO},
                        {CONIC_PLANE_NORMAL, CONIC_CHANNEL_NORMAL},
                        {CONIC_PLANE_Z, CONIC_CHANNEL_Z},
                        {CONIC_PLANE_MEDIAN_Z, CONIC_CHANNEL_MEDIAN_Z},
                        {CONIC_PLANE_INVERSE_Z, CONIC_CHANNEL_INVERSE_Z},
                        {CONIC_PLANE_COUNT, CONIC_CHANNEL_COUNT}};

void conic_channels_of_image(const conic_image *image, size_t pixel, conic_channels channels) {
  memset(channels, 0, sizeof(conic_channels));
  for (size_t i = 0; i < sizeof channel_of_plane / sizeof *channel_of_plane; i++) {
    const conic_plane_description *about = conic_plane_describe(channel_of_plane[i].plane);
    const void *plane = image->planes[channel_of_plane[i].plane];
    for (int c = 0; plane && c < about->n_channels; c++) {
      size_t at = pixel * (size_t)about->n_channels + (size_t)c;
      channels[channel_of_plane[i].channel + c] =
          about->is_uint ? (float)((const uint32_t *)plane)[at] : ((const float *)plane)[at];
    }
  }
}

static unsigned find_channels(const conic_image *image) {
  unsigned channels = 0;
  for (size_t i = 0; i < sizeof channel_of_plane / sizeof *channel_of_plane; i++) {
    const conic_plane plane = channel_of_plane[i].plane;
    unsigned n = (unsigned)conic_plane_describe(plane)->n_channels;
    n -= plane == CONIC_PLANE_RGBA && image->lacks_alpha;
    if (image->planes[plane])
      channels |= ((1u << n) - 1u) << channel_of_plane[i].channel;
  }
  return channels;
}

static size_t cell_of_sample(const conic_image *image, size_t pixel) {
  size_t width = (size_t)image->width, across = (width + CONIC_CELL - 1) / CONIC_CELL;
  return pixel / width / CONIC_CELL * across + pixel % width / CONIC_CELL;
}

static size_t cells_of_image(const conic_image *image) {
  return cell_of_sample(image, (size_t)image->width * (size_t)image->height - 1) + 1;
}

/* Chooses cells of wrong pixels, evenly spaced in the order of all wrong pixels; then others, evenly spaced, where a
 * mistake must change nothing. */
static void choose_cells(const conic_judged_picture *picture, size_t n_wrong, size_t most_cells, uint8_t *is_chosen) {
  const size_t n = (size_t)picture->image->width * (size_t)picture->image->height;
  const size_t most_wrong = most_cells - most_cells / 4, n_cells = cells_of_image(picture->image);
  size_t i_wrong = 0, n_chosen = 0;
  size_t step = n_wrong / most_wrong + 1; /* NOLINT(clang-analyzer-core.DivideZero): 8 cells at least */
  for (size_t pixel = 0; pixel < n; pixel++) {
    if (picture->classes[pixel] != CONIC_PIXEL_WRONG || i_wrong++ % step != step / 2)
      continue;
    uint8_t *cell = &is_chosen[cell_of_sample(picture->image, pixel)];
    if (*cell || n_chosen == most_wrong)
      continue;
    *cell = 1;
    n_chosen++;
  }
  step = n_cells / (most_cells / 4 + 1) + 1;
  for (size_t cell = step / 2; cell < n_cells; cell += step)
    is_chosen[cell] = 1;
}

static void take_cell(const conic_judged_picture *picture, size_t i_cell, conic_diagnosis_samples *s) {
  const conic_image *image = picture->image, *greatest = picture->greatest ? picture->greatest : image;
  const size_t across = ((size_t)image->width + CONIC_CELL - 1) / CONIC_CELL;
  conic_sample_cell *cell = &s->cells[s->n_cells];
  *cell = (conic_sample_cell){
      .first = s->n, .x = (int)(i_cell % across) * CONIC_CELL, .y = (int)(i_cell / across) * CONIC_CELL};
  for (int y = cell->y; y < cell->y + CONIC_CELL && y < image->height; y++)
    for (int x = cell->x; x < cell->x + CONIC_CELL && x < image->width; x++) {
      size_t pixel = (size_t)y * (size_t)image->width + (size_t)x;
      if (picture->classes[pixel] > CONIC_PIXEL_WRONG)
        continue;
      s->places[s->n][0] = (uint16_t)x;
      s->places[s->n][1] = (uint16_t)y;
      s->is_wrong[s->n] = picture->classes[pixel] == CONIC_PIXEL_WRONG;
      conic_channels_of_image(image, pixel, s->low[s->n]);
      conic_channels_of_image(greatest, pixel, s->high[s->n++]);
    }
  cell->n = s->n - cell->first;
  s->n_cells += cell->n > 0;
}

static conic_status allocate_samples(conic_context *context, const conic_image *image, size_t n_cells,
                                     conic_diagnosis_samples *s) {
  const size_t room = n_cells * CONIC_CELL * CONIC_CELL;
  memset(s, 0, sizeof *s);
  s->context = context;
  s->width = image->width;
  s->height = image->height;
  s->channels = find_channels(image);
  return conic_memory_allocate_these(context, CONIC_ROOM(s->cells, n_cells), CONIC_ROOM(s->places, room),
                                     CONIC_ROOM(s->is_wrong, room), CONIC_ROOM(s->low, room),
                                     CONIC_ROOM(s->high, room));
}

conic_status conic_diagnosis_samples_choose(conic_context *context, const conic_judged_picture *picture,
                                            size_t most_cells, conic_diagnosis_samples *s) {
  const size_t n = (size_t)picture->image->width * (size_t)picture->image->height;
  const size_t n_cells = cells_of_image(picture->image);
  size_t n_wrong = 0;
  memset(s, 0, sizeof *s);
  for (size_t pixel = 0; pixel < n; pixel++)
    n_wrong += picture->classes[pixel] == CONIC_PIXEL_WRONG;
  if (!n_wrong)
    return CONIC_OK;
  uint8_t *is_chosen = conic_memory_allocate_zeroed(context, n_cells, 1);
  conic_status status =
      is_chosen ? allocate_samples(context, picture->image, most_cells < n_cells ? 2 * most_cells : n_cells, s)
                : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    choose_cells(picture, n_wrong, most_cells, is_chosen);
    for (size_t cell = 0; cell < n_cells; cell++)
      if (is_chosen[cell])
        take_cell(picture, cell, s);
  }
  conic_memory_release(context, is_chosen);
  return status;
}

conic_status conic_diagnosis_samples_take(conic_context *context, const conic_judged_picture *picture, size_t *next,
                                          conic_diagnosis_samples *s) {
  enum { MOST_TAKEN = 2048 };
  const size_t n_cells = cells_of_image(picture->image);
  const size_t room = n_cells - *next < MOST_TAKEN ? n_cells - *next : MOST_TAKEN;
  conic_status status = allocate_samples(context, picture->image, room, s);
  for (; status == CONIC_OK && *next < n_cells && s->n_cells < room; ++*next)
    take_cell(picture, *next, s);
  return status;
}

void conic_diagnosis_samples_release(conic_diagnosis_samples *s) {
  if (!s->context)
    return;
  conic_memory_release_these(s->context, s->cells, s->places, s->is_wrong, s->low, s->high);
  memset(s, 0, sizeof *s);
}

/* At most 1; 0 where the picture has NaN. */
static double channel_distance(int channel, float low, float high, float value) {
  double scale = 1.0, d = 0.0;
  if (low != low || high != high)
    return 0.0;
  if (!(value >= low))
    d = (double)low - (double)value;
  else if (value > high)
    d = (double)value - (double)high;
  if (channel >= CONIC_CHANNEL_Z)
    scale = fmax(fabs((double)(d > 0.0 && value > high ? high : low)), fabs((double)value));
  return d < scale ? d / scale : d == 0.0 ? 0.0 : 1.0;
}

double conic_diagnosis_distance_at(const conic_diagnosis_samples *s, size_t i, const conic_channels values) {
  double sum = 0.0;
  for (int channel = 0; channel < CONIC_N_COMPARED_CHANNELS; channel++)
    if (s->channels >> channel & 1)
      sum += channel_distance(channel, s->low[i][channel], s->high[i][channel], values[channel]);
  return sum;
}

double conic_diagnosis_distance(const conic_diagnosis_samples *s, const conic_channels *values,
                                const conic_channels *ours) {
  static const double far = 1e-2; /* this far off, a decision went the other way */
  double sum = 0.0;
  for (size_t i = 0; i < s->n; i++)
    if (s->is_wrong[i] || !ours || conic_diagnosis_distance_at(s, i, ours[i]) < far)
      sum += conic_diagnosis_distance_at(s, i, values[i]);
  return sum;
}

static double transferred(conic_planted_transfer transfer, double v) {
  const double above = v > 0.0 ? v : 0.0;
  switch (transfer) {
  case CONIC_TRANSFER_DECODED:
    return conic_srgb_decode(v);
  case CONIC_TRANSFER_DECODED_BY_POWER:
    return conic_power(above, 2.2);
  case CONIC_TRANSFER_DECODED_TWICE:
    return conic_srgb_decode(conic_srgb_decode(v));
  case CONIC_TRANSFER_ENCODED:
    return conic_srgb_encode(v);
  case CONIC_TRANSFER_ENCODED_BY_POWER:
    return conic_power(above, 1.0 / 2.2);
  case CONIC_TRANSFER_ENCODED_TWICE:
    return conic_srgb_encode(conic_srgb_encode(v));
  case CONIC_TRANSFER_OWN:
    break;
  }
  return v;
}

float conic_planted_transferred(conic_planted_transfer transfer, float value) {
  return (float)transferred(transfer, (double)value);
}

static float alpha_factor(conic_planted_alpha alpha, const conic_channels v) {
  const float a = 1.0f - v[CONIC_CHANNEL_T], w = v[CONIC_CHANNEL_WEIGHT];
  switch (alpha) {
  case CONIC_ALPHA_MULTIPLIED:
    return a;
  case CONIC_ALPHA_DIVIDED:
    return a > 0.0f ? 1.0f / a : 1.0f;
  case CONIC_ALPHA_WEIGHTED:
    return w;
  case CONIC_ALPHA_WEIGHTED_LIMITED:
    return w < 1.0f ? w : 1.0f;
  case CONIC_ALPHA_OWN:
    break;
  }
  return 1.0f;
}

void conic_planted_finish(const conic_planted *p, size_t n, conic_channels *values) {
  const int is_weighted = p->alpha >= CONIC_ALPHA_WEIGHTED;
  for (size_t i = 0; i < n; i++) {
    float *v = values[i], factor = alpha_factor(p->alpha, v), gloss = is_weighted ? 1.0f : factor;
    const float T = v[CONIC_CHANNEL_T];
    for (int c = 0; c < 3; c++) {
      v[c] = factor * (v[c] + (p->adds_whole ? 1.0f : T) * p->behind[c]) + gloss * v[CONIC_CHANNEL_GLOSS + c];
      v[CONIC_CHANNEL_ALBEDO + c] *= is_weighted ? factor : 1.0f;
      if (p->transfer)
        v[c] = conic_planted_transferred(p->transfer, v[c]);
    }
    if (p->is_bgr) {
      const float red = v[0];
      v[0] = v[2];
      v[2] = red;
    }
    for (int c = 0; c < 3 && p->is_clipped; c++)
      v[c] = v[c] > 0.0f ? (v[c] < 1.0f ? v[c] : 1.0f) : 0.0f;
    v[CONIC_CHANNEL_Z] *= p->has_raw_z ? v[CONIC_CHANNEL_WEIGHT] : 1.0f;
    v[CONIC_CHANNEL_A] = p->is_opaque ? 1.0f : 1.0f - T;
  }
}
