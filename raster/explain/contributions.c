#include "core/image/view_arguments.h"
#include "raster/explain/pixel_contributions.h"

#include "core/base/base.h"
#include "core/base/vectors.h"

/* Splats that a thread projects at a time. */
enum { CHUNK = 1 << 14 };

const char *conic_fate_name(conic_fate fate) {
  static const char *const names[] = {"variance", "ray", "culled", "skipped"};
  return (unsigned)fate < sizeof names / sizeof names[0] ? names[fate] : NULL;
}

CONIC_DEFINE_NAMES(conic_contribution_verdict_name, conic_contribution_verdict, CONIC_N_CONTRIBUTION_VERDICTS,
                   "visible", "hidden", "clipped", "outside")

static void project_task(void *data, size_t i_chunk) {
  conic_contributions *c = data;
  conic_project_chunk(&c->view, c->splats, i_chunk, &c->projected);
  if (c->projected.clips)
    conic_clip_chunk(&c->view, c->splats, i_chunk * CHUNK, &c->projected, &c->projected.chunks[i_chunk]);
}

static conic_status project_all(conic_contributions *c) {
  conic_projected *projected = &c->projected;
  size_t n = c->splats->count;
  projected->chunk_size = CHUNK;
  projected->n_chunks = n / CHUNK + 1;
  if (conic_memory_allocate_these(c->context, CONIC_ROOM(projected->chunks, projected->n_chunks),
                                  CONIC_ROOM(projected->footprints, n), CONIC_ROOM(projected->boxes, n),
                                  CONIC_ROOM(projected->surfaces, n), CONIC_ROOM(projected->rays, n)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  if (c->splats->n_clips) {
    projected->clips = conic_memory_allocate(c->context, n, sizeof *projected->clips);
    if (!projected->clips)
      return CONIC_ERROR_MEMORY;
  }
  return conic_parallel_told(c->context, "deep", 0.0, 0.0, projected->n_chunks, project_task, c);
}

/* Adds one to `next` for every band that the footprint touches; with references, enters it at that place. */
static void enter_bands(const conic_contributions *c, uint32_t i_footprint, size_t *next, uint32_t *references) {
  conic_reach reach = conic_reach_of(c, i_footprint);
  size_t end = ((size_t)reach.y_end + CONIC_CONTRIBUTION_BAND - 1) / CONIC_CONTRIBUTION_BAND;
  for (size_t band = (size_t)reach.y_begin / CONIC_CONTRIBUTION_BAND; band < end; band++) {
    if (references)
      references[next[band]] = i_footprint;
    next[band]++;
  }
}

static void enter_all(const conic_contributions *c, size_t *next, uint32_t *references) {
  for (size_t i_chunk = 0; i_chunk < c->projected.n_chunks; i_chunk++) {
    const conic_chunk *chunk = &c->projected.chunks[i_chunk];
    for (size_t i = chunk->first; i < chunk->first + chunk->n_drawn; i++)
      enter_bands(c, (uint32_t)i, next, references);
  }
}

static conic_status list_bands(conic_contributions *c) {
  size_t n_bands = ((size_t)c->view.height + CONIC_CONTRIBUTION_BAND - 1) / CONIC_CONTRIBUTION_BAND, total = 0;
  c->band_begin = conic_memory_allocate_zeroed(c->context, n_bands + 2, sizeof *c->band_begin);
  if (!c->band_begin)
    return CONIC_ERROR_MEMORY;
  size_t *next = c->band_begin + 1; /* first how many, then where the next goes; in the end where a band ends */
  enter_all(c, next, NULL);
  for (size_t band = 0; band < n_bands; band++) {
    size_t n = next[band];
    next[band] = total;
    total += n;
  }
  c->references = conic_memory_allocate(c->context, total, sizeof *c->references);
  if (!c->references)
    return CONIC_ERROR_MEMORY;
  enter_all(c, next, c->references);
  return CONIC_OK;
}

conic_status conic_contributions_create(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                        const conic_render_options *options, conic_contributions **contributions) {
  const conic_drawing alone = {.splats = splats};
  *contributions = NULL;
  if (!splats)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "contributions: the splats are null");
  return conic_contributions_create_drawing(context, &alone, camera, options, contributions);
}

conic_status conic_contributions_create_drawing(conic_context *context, const conic_drawing *drawing,
                                                const conic_camera *camera, const conic_render_options *options,
                                                conic_contributions **contributions) {
  *contributions = NULL;
  conic_render_options own;
  conic_status status = conic_view_arguments_take(context, "contributions", camera, options, &own);
  if (status != CONIC_OK)
    return status;
  conic_contributions *c = conic_memory_allocate_zeroed(context, 1, sizeof *c);
  if (!c)
    return CONIC_ERROR_MEMORY;
  c->context = context;
  status = conic_whole_drawing_enter(context, "contributions", drawing, &c->drawing);
  c->splats = c->drawing.splats;
  c->options = own;
  if (status == CONIC_OK)
    status = conic_whole_drawing_scale(context, &c->drawing, &c->options);
  if (status == CONIC_OK)
    status =
        conic_view_init(context, c->splats, camera, &c->options, c->options.near_z, c->options.splat_length, &c->view);
  if (status == CONIC_OK)
    status = conic_whole_drawing_prepare(context, &c->drawing, &c->view, camera, c->options.isa, &c->triangles);
  if (status == CONIC_OK)
    status = project_all(c);
  if (status == CONIC_OK)
    status = list_bands(c);
  if (status == CONIC_OK)
    *contributions = c;
  else
    conic_contributions_destroy(c);
  return status;
}

void conic_contributions_destroy(conic_contributions *c) {
  if (!c)
    return;
  void *all[] = {c->projected.chunks,    c->projected.footprints,
                 c->projected.boxes,     c->projected.surfaces,
                 c->projected.rays,      c->projected.clips,
                 c->band_begin,          c->references,
                 c->list_memory.pointer, c->triangle_list_memory.pointer};
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
    conic_memory_release(c->context, all[i]);
  conic_triangle_frame_release(c->context, &c->triangles);
  conic_drawing_leave(c->context, &c->drawing.entered);
  conic_memory_release(c->context, c);
}

/* The ellipse of δ: (s₁δ_x + s₂δ_y)² + (s₃δ_y)². */
static void describe_ellipse(const conic_footprint *footprint, conic_projection *to) {
  double s1 = (double)footprint->s1, s2 = (double)footprint->s2, s3 = (double)footprint->s3;
  double determinant = (s1 * s3) * (s1 * s3);
  to->center_px[0] = (double)footprint->x + 0.5 - (double)footprint->dx0;
  to->center_px[1] = (double)footprint->y + 0.5 - (double)footprint->dy0;
  to->conic[0] = s1 * s1;
  to->conic[1] = s1 * s2;
  to->conic[2] = s2 * s2 + s3 * s3;
  to->variance_px[0] = to->conic[2] / determinant;
  to->variance_px[1] = -to->conic[1] / determinant;
  to->variance_px[2] = to->conic[0] / determinant;
}

/* s at the centre, which a wide splat has for no other place. */
static double nearness_of(const conic_contributions *c, size_t i, const conic_footprint *footprint) {
  conic_disc disc = conic_disc_of(&c->view, c->splats, i);
  double distance = conic_length(disc.p);
  if (!conic_is_wide(footprint))
    return (double)footprint->nearness;
  return distance > 0.0 ? 1.0 / (1.0 - (double)footprint->nearness / distance) : 0.0;
}

conic_status conic_contributions_project(const conic_contributions *c, size_t i, conic_projection *projection) {
  conic_footprint footprint;
  conic_box box;
  conic_projected_surface surface;
  conic_ray ray;
  conic_projected place = {.footprints = &footprint, .boxes = &box, .surfaces = &surface, .rays = &ray};
  conic_chunk chunk = {.n_drawn = 0};
  memset(projection, 0, sizeof *projection);
  if (i >= c->splats->count)
    return conic_fail(c->context, CONIC_ERROR_ARGUMENT, "there is no splat %zu: the last is %zu", i,
                      c->splats->count - 1);
  projection->splat = (uint32_t)i;
  conic_project_one(&c->view, c->splats, i, &place, &chunk);
  projection->fate = chunk.n_culled    ? CONIC_FATE_CULLED
                     : chunk.n_skipped ? CONIC_FATE_SKIPPED
                     : chunk.n_rays    ? CONIC_FATE_RAY
                                       : CONIC_FATE_VARIANCE;
  if (!chunk.n_drawn)
    return CONIC_OK;
  projection->x_begin = box.x_begin;
  projection->x_end = box.x_end;
  projection->y_begin = box.y_begin;
  projection->y_end = box.y_end;
  projection->amplitude = (double)footprint.amplitude;
  projection->nearest_z = 1.0 / (double)footprint.iz_near;
  projection->farthest_z = 1.0 / (double)footprint.iz_far;
  projection->nearness = nearness_of(c, i, &footprint);
  memcpy(projection->color, surface.color, sizeof projection->color);
  memcpy(projection->normal, surface.normal, sizeof projection->normal);
  if (projection->fate == CONIC_FATE_VARIANCE)
    describe_ellipse(&footprint, projection);
  return CONIC_OK;
}

conic_contribution conic_contribution_of(const conic_contributions *c, uint32_t i_footprint, int x, int y,
                                         const conic_fragment *fragment) {
  const conic_footprint *footprint = &c->projected.footprints[i_footprint];
  return (conic_contribution){.splat = c->projected.surfaces[i_footprint].index,
                              .q = fragment->q,
                              .weight = conic_final_weight(&c->view, footprint, fragment->q, fragment->scale),
                              .depth = conic_plane_z(footprint, x, y),
                              .inverse_depth = fragment->iz,
                              .plane_inverse_depth = fragment->plane_iz,
                              .hides = conic_contribution_hides(&c->view, footprint, fragment, x, y)};
}

/* Whether what does not cover the pixel fails by its clip lines, or as a ray by its range of depths. */
static int is_out_of_range(const conic_contributions *c, const conic_footprint *footprint, int x, int y) {
  float dx = conic_row_dx(footprint, x), dy = conic_row_dy(footprint, y);
  if (conic_is_clipped(footprint) &&
      !conic_clip_keeps(&c->projected.clips[footprint - c->projected.footprints], dx, dy))
    return 1;
  if (footprint->s3 != 0.0f || conic_is_laplace(footprint))
    return 0;
  const conic_ray *ray = &c->projected.rays[footprint->i_ray];
  float iz = (footprint->iz0 + footprint->iz_dy * dy) + footprint->iz_dx * dx;
  return !(iz > 0.0f && iz >= ray->iz_low && iz <= ray->iz_high);
}

/* Splat i of the band at the pixel, before it is known what hides it; 0 where the pixel is not in its reach. */
static int begin_contribution(const conic_contributions *c, uint32_t i_footprint, int x, int y,
                              conic_contribution *contribution) {
  const conic_footprint *footprint = &c->projected.footprints[i_footprint];
  conic_reach reach = conic_reach_of(c, i_footprint);
  conic_fragment fragment;
  if (x < reach.x_begin || x >= reach.x_end || y < reach.y_begin || y >= reach.y_end)
    return 0;
  if (conic_fragment_at(&c->view, &c->projected, footprint, x, y, &fragment)) {
    *contribution = conic_contribution_of(c, i_footprint, x, y, &fragment);
    return 1;
  }
  *contribution = (conic_contribution){.splat = c->projected.surfaces[i_footprint].index};
  contribution->verdict = is_out_of_range(c, footprint, x, y) ? CONIC_CONTRIBUTION_CLIPPED : CONIC_CONTRIBUTION_OUTSIDE;
  return 1;
}

static void judge_footprint(conic_contribution *list, size_t n, int passes,
                            const conic_triangle_contribution *triangle) {
  float threshold = triangle ? triangle->hides : 0.0f, nearest_iz = 0.0f;
  size_t nearest = n;
  for (size_t i = 0; i < n; i++) {
    if (list[i].verdict > CONIC_CONTRIBUTION_HIDDEN)
      continue;
    threshold = threshold < list[i].hides ? list[i].hides : threshold;
    if (nearest_iz < list[i].inverse_depth) {
      nearest_iz = list[i].inverse_depth;
      nearest = i;
    }
  }
  if (triangle && triangle->inverse_depth > nearest_iz)
    nearest = n;
  for (size_t i = 0; i < n; i++) {
    conic_fragment f = {.iz = list[i].inverse_depth, .plane_iz = list[i].plane_inverse_depth};
    if (list[i].verdict <= CONIC_CONTRIBUTION_HIDDEN && !(passes == 1 ? i == nearest : conic_seen_iz(&f) >= threshold))
      list[i].verdict = CONIC_CONTRIBUTION_HIDDEN;
  }
}

conic_status conic_contributions_at(conic_contributions *c, int x, int y, const conic_contribution **list, size_t *n) {
  if (x < 0 || x >= c->view.width || y < 0 || y >= c->view.height)
    return conic_fail(c->context, CONIC_ERROR_ARGUMENT, "the pixel %d,%d is not in a picture of %d x %d", x, y,
                      c->view.width, c->view.height);
  size_t band = (size_t)y / CONIC_CONTRIBUTION_BAND, first = c->band_begin[band], end = c->band_begin[band + 1];
  c->list = conic_keep_room(c->context, &c->list_memory, end - first, sizeof *c->list);
  if (!c->list)
    return CONIC_ERROR_MEMORY;
  *n = 0;
  for (size_t i = first; i < end; i++)
    *n += (size_t)begin_contribution(c, c->references[i], x, y, &c->list[*n]);
  const conic_triangle_contribution *triangle;
  size_t n_triangles;
  conic_status status = conic_contribution_triangles(c, x, y, &triangle, &n_triangles);
  judge_footprint(c->list, *n, c->options.passes, triangle);
  *list = c->list;
  return status;
}
