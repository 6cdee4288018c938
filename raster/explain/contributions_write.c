/* Every pixel's visible splats and its visible triangle, line by line, into a deep image. */

#include "core/base/base.h"
#include "core/pictures/image_exr_deep.h"
#include "raster/explain/pixel_contributions.h"

/* A line that a thread works out; what it holds serves line after line. */
typedef struct line {
  int y;
  float *threshold;               /* a pixel; the nearest iz, where one pass asks for that */
  uint32_t *nearest;              /* a pixel: with one pass, the footprint that wins */
  conic_near_triangle *triangles; /* a pixel; iz = 0 where none is visible */
  uint32_t *counts;
  size_t *next; /* a pixel: where its next sample goes */
  conic_deep_sample *samples;
  size_t n_samples, room;
  conic_deep_packed packed;
  conic_status status;
} line;

typedef struct lines {
  const conic_contributions *contributions;
  const float *rgba; /* the picture's, which the samples make; null: they make the mean of their colours */
  line *lines;
  int is_counting; /* only the counts are asked for */
} lines;

typedef void visit_fragment(const conic_contributions *c, line *l, uint32_t i_footprint, int x,
                            const conic_fragment *fragment);

static void walk(const conic_contributions *c, line *l, visit_fragment *visit) {
  size_t band = (size_t)l->y / CONIC_CONTRIBUTION_BAND;
  for (size_t i = c->band_begin[band]; i < c->band_begin[band + 1]; i++) {
    uint32_t i_footprint = c->references[i];
    const conic_footprint *footprint = &c->projected.footprints[i_footprint];
    conic_reach reach = conic_reach_of(c, i_footprint);
    if (l->y < reach.y_begin || l->y >= reach.y_end)
      continue;
    for (int x = reach.x_begin; x < reach.x_end; x++) {
      conic_fragment fragment;
      if (conic_fragment_at(&c->view, &c->projected, footprint, x, l->y, &fragment))
        visit(c, l, i_footprint, x, &fragment);
    }
  }
}

static void raise_threshold(const conic_contributions *c, line *l, uint32_t i_footprint, int x,
                            const conic_fragment *fragment) {
  float hides = conic_contribution_hides(&c->view, &c->projected.footprints[i_footprint], fragment, x, l->y);
  l->threshold[x] = l->threshold[x] < hides ? hides : l->threshold[x];
}

static void keep_nearest_footprint(const conic_contributions *c, line *l, uint32_t i_footprint, int x,
                                   const conic_fragment *fragment) {
  (void)c;
  if (l->threshold[x] < fragment->iz) {
    l->threshold[x] = fragment->iz;
    l->nearest[x] = i_footprint;
  }
}

static int is_visible(const conic_contributions *c, const line *l, uint32_t i_footprint, int x,
                      const conic_fragment *fragment) {
  return c->options.passes == 1 ? l->nearest[x] == i_footprint : conic_seen_iz(fragment) >= l->threshold[x];
}

/* A pixel's triangle is visible unless splats hide it, and then hides them in turn. */
static void judge_triangles(const conic_contributions *c, line *l) {
  conic_contribution_triangle_line(c, l->y, l->triangles);
  for (int x = 0; x < c->view.width; x++) {
    conic_near_triangle *triangle = &l->triangles[x];
    if (c->options.passes == 1 ? !(triangle->iz > l->threshold[x]) : !(triangle->iz >= l->threshold[x]))
      triangle->iz = 0.0f;
    else if (c->options.passes == 1)
      l->nearest[x] = UINT32_MAX;
    else if (l->threshold[x] < triangle->hides)
      l->threshold[x] = triangle->hides;
  }
}

static void keep_triangles(const conic_contributions *c, line *l) {
  for (int x = 0; x < c->view.width; x++) {
    const conic_near_triangle *triangle = &l->triangles[x];
    if (!(triangle->iz > 0.0f))
      continue;
    conic_deep_sample *sample = &l->samples[l->next[x]++];
    conic_contribution_triangle_color(c, triangle, x, l->y, sample->rgba);
    sample->depth = 1.0f / triangle->iz;
    sample->id = c->triangles.first_id + triangle->triangle;
    sample->weight = 1.0f;
  }
}

static void count_samples(const conic_contributions *c, line *l, uint32_t i_footprint, int x,
                          const conic_fragment *fragment) {
  l->counts[x] += (uint32_t)is_visible(c, l, i_footprint, x, fragment);
}

static void keep_sample(const conic_contributions *c, line *l, uint32_t i_footprint, int x,
                        const conic_fragment *fragment) {
  if (!is_visible(c, l, i_footprint, x, fragment))
    return;
  conic_contribution contribution = conic_contribution_of(c, i_footprint, x, l->y, fragment);
  conic_deep_sample *sample = &l->samples[l->next[x]++];
  memcpy(sample->rgba, c->projected.surfaces[i_footprint].color, 3 * sizeof(float));
  sample->depth = contribution.depth;
  sample->id = contribution.splat;
  sample->weight = contribution.weight;
}

static conic_status make_room_for_line(conic_context *context, line *l) {
  return l->n_samples <= l->room
             ? CONIC_OK
             : conic_memory_reserve(context, &l->samples, 0, l->n_samples, &l->room, sizeof *l->samples);
}

CONIC_DEFINE_ORDER_BY_TWO(compare_depths, conic_deep_sample, depth, id)

/* Shading is of the pixel, not of its splats: what it makes of the mean colour it makes of each. Where the mean is
 * black, nothing but a highlight is seen, which all have alike. */
static void shade_samples(conic_deep_sample *samples, size_t n, const float shaded[3]) {
  double sum = 0.0;
  for (size_t i = 0; i < n; i++)
    sum += (double)samples[i].weight;
  for (int c = 0; c < 3; c++) {
    double mean = 0.0;
    for (size_t i = 0; i < n; i++)
      mean += (double)samples[i].weight / sum * (double)samples[i].rgba[c];
    for (size_t i = 0; i < n; i++)
      samples[i].rgba[c] = mean > 0.0 ? (float)((double)samples[i].rgba[c] * ((double)shaded[c] / mean)) : shaded[c];
  }
}

/* A sample lets through what those behind it are of the rest, so that each is seen with its share of the weights. */
static void cover_from(conic_deep_sample *samples, size_t n) {
  double behind = 0.0;
  for (size_t i = n; i-- > 0;) {
    conic_deep_sample *sample = &samples[i];
    behind += (double)sample->weight;
    double alpha = (double)sample->weight / behind;
    for (int c = 0; c < 3; c++)
      sample->rgba[c] = (float)((double)sample->rgba[c] * alpha);
    sample->rgba[3] = (float)alpha;
  }
}

/* The samples stand in the order of the sums, each with its own colour (rgba without A), depth, id and weight. They
 * come out in the order of their depths, colours times alpha, so that laying them over each other gives the pixel:
 * `shaded`, or where that is null the mean Σ w c / Σ w, with alpha 1. */
static void finish_deep_pixel(conic_deep_sample *samples, size_t n, const float *shaded) {
  if (n > 0 && shaded)
    shade_samples(samples, n, shaded);
  if (n > 1)
    qsort(samples, n, sizeof *samples, compare_depths);
  cover_from(samples, n);
}

/* The samples of the line's pixels, which are all there, as they go into the file. */
static conic_status pack_line(const lines *all, line *l) {
  const conic_contributions *c = all->contributions;
  size_t width = (size_t)c->view.width, first = 0;
  for (size_t x = 0; x < width && l->n_samples > 0; first += l->counts[x++])
    finish_deep_pixel(l->samples + first, l->counts[x], all->rgba ? all->rgba + 4 * ((size_t)l->y * width + x) : NULL);
  const conic_deep_line whole = {l->counts, l->n_samples, l->samples};
  return conic_deep_pack(c->context, &whole, c->view.width, &l->packed);
}

static void work_out(void *data, size_t i_item) {
  const lines *all = data;
  const conic_contributions *c = all->contributions;
  line *l = &all->lines[i_item];
  size_t width = (size_t)c->view.width;
  memset(l->threshold, 0, width * sizeof *l->threshold);
  memset(l->nearest, 0xff, width * sizeof *l->nearest);
  memset(l->counts, 0, width * sizeof *l->counts);
  walk(c, l, c->options.passes == 1 ? keep_nearest_footprint : raise_threshold);
  judge_triangles(c, l);
  walk(c, l, count_samples);
  l->n_samples = 0;
  for (size_t x = 0; x < width; x++) {
    l->counts[x] += l->triangles[x].iz > 0.0f;
    l->next[x] = l->n_samples;
    l->n_samples += l->counts[x];
  }
  if (all->is_counting)
    return;
  l->status = make_room_for_line(c->context, l);
  if (l->status != CONIC_OK)
    return;
  walk(c, l, keep_sample);
  keep_triangles(c, l);
  l->status = pack_line(all, l);
}

static conic_status allocate_line(conic_context *context, size_t width, line *l) {
  return conic_memory_allocate_these(context, CONIC_ROOM(l->threshold, width), CONIC_ROOM(l->nearest, width),
                                     CONIC_ROOM(l->triangles, width), CONIC_ROOM(l->counts, width),
                                     CONIC_ROOM(l->next, width));
}

static void release_line(conic_context *context, line *l) {
  void *all[] = {l->threshold, l->nearest, l->triangles, l->counts, l->next, l->samples};
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
    conic_memory_release(context, all[i]);
  conic_deep_packed_release(context, &l->packed);
}

/* Works out every line, `n_lines` at a time; appends them to the writer, or without one finds the largest count. */
static conic_status do_lines(lines *all, size_t n_lines, conic_deep_writer *writer, uint32_t *most) {
  const conic_contributions *c = all->contributions;
  conic_status status = CONIC_OK;
  all->is_counting = !writer;
  for (int y = 0; y < c->view.height && status == CONIC_OK; y += (int)n_lines) {
    size_t left = (size_t)(c->view.height - y), n = left < n_lines ? left : n_lines;
    for (size_t i = 0; i < n; i++)
      all->lines[i].y = y + (int)i;
    double from = (double)y / (double)c->view.height, to = (double)(y + (int)n) / (double)c->view.height;
    status = conic_parallel_told(c->context, "deep", writer ? 0.4 + 0.6 * from : 0.4 * from,
                                 writer ? 0.4 + 0.6 * to : 0.4 * to, n, work_out, all);
    for (size_t i = 0; i < n && status == CONIC_OK; i++) {
      for (int x = 0; x < c->view.width; x++)
        *most = all->lines[i].counts[x] > *most ? all->lines[i].counts[x] : *most;
      if (writer)
        status =
            all->lines[i].status == CONIC_OK ? conic_deep_append(writer, &all->lines[i].packed) : all->lines[i].status;
    }
  }
  return status;
}

conic_status conic_contributions_write(conic_contributions *c, const char *path, const conic_image *header) {
  size_t n_lines = 8 * (size_t)conic_context_threads(c->context);
  uint32_t most = 0;
  conic_deep_writer *writer = NULL;
  lines all = {.contributions = c};
  if (header && header->width == c->view.width && header->height == c->view.height)
    all.rgba = header->planes[CONIC_PLANE_RGBA];
  all.lines = conic_memory_allocate_zeroed(c->context, n_lines, sizeof *all.lines);
  conic_status status = all.lines ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n_lines && status == CONIC_OK; i++)
    status = allocate_line(c->context, (size_t)c->view.width, &all.lines[i]);
  if (status == CONIC_OK)
    status = do_lines(&all, n_lines, NULL, &most); /* the header has to say how many there are at most */
  if (status == CONIC_OK)
    status = conic_deep_open(c->context, path, c->view.width, c->view.height, most, header, &writer);
  if (status == CONIC_OK)
    status = do_lines(&all, n_lines, writer, &most);
  status = conic_deep_end(writer, status);
  for (size_t i = 0; i < n_lines && all.lines; i++)
    release_line(c->context, &all.lines[i]);
  conic_memory_release(c->context, all.lines);
  return status;
}
