/* The samples of a picture, in the order of the points. Grids of the last picture are taken over if they are the same:
 * samples do not depend on the camera. */

#include "core/image/view_arguments.h"
#include "core/splats/clip.h"
#include "surface/patches/patch_set.h"

enum { CHUNK = 256 };

typedef struct patches_selecting {
  conic_patches *patches;
  conic_patches_view view;
  conic_patches_frame *frame;
  const conic_patches_frame *last;
  size_t grid_counts[CONIC_N_GRIDS];
  size_t n_chunks;
  size_t *chunk_starts; /* where each chunk of points begins among the samples, and one end */
  size_t *chunk_kept;   /* by chunk: samples taken over */
} patches_selecting;

/* How many samples a point is drawn with. */
static size_t count_of(const patches_selecting *work, size_t point, uint32_t slot) {
  uint8_t plan = slot == CONIC_NO_SLOT ? CONIC_PLAN_SPLAT : work->frame->plans[slot];
  if (plan <= CONIC_PLAN_SPLAT)
    return plan;
  size_t n_fading = plan & CONIC_PLAN_FADING ? 1 : 0;
  const conic_patch *patch = conic_patches_shown(work->patches, point, slot);
  if (!patch)
    return n_fading;
  if (plan == CONIC_PLAN_DEEP)
    return patch == &work->patches->patches[slot]
               ? work->patches->counts[slot]
               : conic_patch_sample_deep(&work->view, patch, work->patches->options.surface.degree,
                                         (double)work->patches->options.cutoff, NULL);
  int i_grid = (plan & ~CONIC_PLAN_FADING) - CONIC_PLAN_GRID;
  conic_grid_part part = conic_grid_whole(conic_grid_sizes[i_grid]);
  return n_fading + (patch->fence ? conic_grid_count(&part, patch->fence) : work->grid_counts[i_grid]);
}

static void count_chunk(void *data, size_t i_item) {
  patches_selecting *work = data;
  const conic_neighbours *tree = &work->patches->surface->tree;
  size_t end = (i_item + 1) * CHUNK < tree->n_points ? (i_item + 1) * CHUNK : tree->n_points, n = 0;
  for (size_t i = i_item * CHUNK; i < end; i++)
    n += count_of(work, i, tree->slot_of_point[i]);
  work->chunk_starts[i_item + 1] = n;
}

static void copy_axes(float *const from[3], size_t first, float *const to[3], size_t at, size_t n) {
  for (int axis = 0; axis < 3; axis++)
    memcpy(to[axis] + at, from[axis] + first, n * sizeof(float));
}

/* Samples of a patch have no clip lines where they are copied: one with a fence is sampled anew. */
static void copy_samples(const conic_splats *from, size_t first, const conic_splats *to, size_t at, size_t n) {
  copy_axes(from->position, first, to->position, at, n);
  copy_axes(from->tangent_u, first, to->tangent_u, at, n);
  copy_axes(from->tangent_v, first, to->tangent_v, at, n);
  if (to->color[0])
    copy_axes(from->color, first, to->color, at, n);
  if (from->opacity)
    memcpy(to->opacity + at, from->opacity + first, n * sizeof(float));
  else
    to->opacity[at] = 1.0f;
}

/* Puts a point's own splat, with its clip lines. */
static void copy_splat(const conic_splats *from, size_t point, const conic_splats *to, size_t at) {
  copy_samples(from, point, to, at, 1);
  size_t i = conic_clip_find(from, point);
  if (i < from->n_clips && to->clips && from->clips[i].splat == point)
    to->clips[at] = from->clips[i];
}

static void make_grid(const patches_selecting *work, size_t point, uint32_t slot, size_t at) {
  const conic_patches *patches = work->patches;
  const conic_splats *splats = &work->frame->splats;
  const conic_patch *patch = conic_patches_shown(patches, point, slot);
  uint8_t plan = work->frame->plans[slot];
  int degree = patches->options.surface.degree;
  double cutoff = (double)patches->options.cutoff;
  conic_grid_samples to = {.weight = splats->opacity + at, .clips = splats->clips ? splats->clips + at : NULL};
  for (int axis = 0; axis < 3; axis++) {
    to.position[axis] = splats->position[axis] + at;
    to.tangent_u[axis] = splats->tangent_u[axis] + at;
    to.tangent_v[axis] = splats->tangent_v[axis] + at;
  }
  if (plan == CONIC_PLAN_DEEP) {
    conic_patch_sample_deep(&work->view, patch, degree, cutoff, &to);
    return;
  }
  conic_grid_part part = conic_grid_whole(conic_grid_sizes[(plan & ~CONIC_PLAN_FADING) - CONIC_PLAN_GRID]);
  conic_grid_sample(patch, degree, cutoff, &part, &to);
}

/* Puts the samples of a point's patch, with the point's colour and opacity. */
static void put_grid(const patches_selecting *work, size_t point, uint32_t slot, size_t at, size_t n) {
  const conic_splats *from = &work->patches->splats;
  const conic_splats *to = &work->frame->splats;
  make_grid(work, point, slot, at);
  for (int axis = 0; axis < 3 && from->color[0]; axis++)
    for (size_t i = at; i < at + n; i++)
      to->color[axis][i] = from->color[axis][point];
  for (size_t i = at; i < at + n && from->opacity; i++)
    to->opacity[i] *= from->opacity[point];
}

/* Puts a fading patch, if the point shows one, and its splat, which is the last of the n. */
static void put_fading(const patches_selecting *work, size_t point, uint32_t slot, size_t at, size_t n) {
  const conic_splats *to = &work->frame->splats;
  double share = conic_patches_share(work->patches, &work->view, slot);
  if (n > 1)
    put_grid(work, point, slot, at, n - 1);
  for (size_t i = at; i < at + n - 1; i++)
    to->opacity[i] *= (float)share;
  copy_splat(&work->patches->splats, point, to, at + n - 1);
  to->opacity[at + n - 1] *= (float)(1.0 - share);
}

/* Whether the last picture had the same grid. Points that coincide with another have no start, and are sampled anew. */
static int is_kept(const patches_selecting *work, size_t point, uint32_t slot) {
  uint8_t plan = work->frame->plans[slot];
  return plan >= CONIC_PLAN_GRID && plan < CONIC_PLAN_FADING && work->last->plans[slot] == plan &&
         !conic_patches_shown(work->patches, point, slot)->fence &&
         work->patches->surface->tree.point_of_slot[slot] == point;
}

/* Puts the samples of a point. Those that are not finite are included, so that the renderer counts them. */
static size_t put_point(const patches_selecting *work, size_t point, size_t at, size_t *n_kept) {
  uint32_t slot = work->patches->surface->tree.slot_of_point[point];
  size_t n = count_of(work, point, slot);
  if (n == 0)
    return 0;
  for (size_t i = at; i < at + n && work->frame->splats.clips; i++)
    work->frame->splats.clips[i].n_lines = 0;
  if (slot == CONIC_NO_SLOT || work->frame->plans[slot] == CONIC_PLAN_SPLAT)
    copy_splat(&work->patches->splats, point, &work->frame->splats, at);
  else if (work->frame->plans[slot] & CONIC_PLAN_FADING)
    put_fading(work, point, slot, at, n);
  else if (is_kept(work, point, slot)) {
    copy_samples(&work->last->splats, work->last->starts[slot], &work->frame->splats, at, n);
    *n_kept += n;
  } else
    put_grid(work, point, slot, at, n);
  if (slot != CONIC_NO_SLOT && work->patches->surface->tree.point_of_slot[slot] == point)
    work->frame->starts[slot] = (uint32_t)at;
  for (size_t i = at; i < at + n; i++)
    work->frame->points[i] = (uint32_t)point;
  return n;
}

static void fill_chunk(void *data, size_t i_item) {
  patches_selecting *work = data;
  size_t n_points = work->patches->surface->tree.n_points, at = work->chunk_starts[i_item], n_kept = 0;
  size_t end = (i_item + 1) * CHUNK < n_points ? (i_item + 1) * CHUNK : n_points;
  for (size_t i = i_item * CHUNK; i < end; i++)
    at += put_point(work, i, at, &n_kept);
  work->chunk_kept[i_item] = n_kept;
}

/* Brings the records with clip lines together. */
static void gather_clips(conic_splats *splats) {
  splats->n_clips = 0;
  for (size_t i = 0; i < splats->count && splats->clips; i++)
    if (splats->clips[i].n_lines) {
      conic_clip *clip = &splats->clips[splats->n_clips++];
      *clip = splats->clips[i];
      clip->splat = (uint32_t)i;
    }
}

static void release_samples(conic_context *context, conic_patches_frame *frame) {
  conic_splats_release(context, &frame->splats);
  conic_memory_release(context, frame->points);
  frame->points = NULL;
  frame->room = 0;
}

void conic_patches_release_frames(conic_patches *patches) {
  for (int i = 0; i < 2; i++) {
    release_samples(patches->context, &patches->frames[i]);
    conic_memory_release_these(patches->context, patches->frames[i].plans, patches->frames[i].starts);
  }
}

static conic_status reserve_samples(const patches_selecting *work, size_t n) {
  conic_context *context = work->patches->context;
  conic_patches_frame *frame = work->frame;
  unsigned fields = conic_splats_fields(&work->patches->splats) & (CONIC_SPLATS_COLORS | CONIC_SPLATS_CLIPS);
  fields |= work->patches->sides ? CONIC_SPLATS_CLIPS : 0;
  if (n <= frame->room && frame->points) /* the arrays exist even with nothing in sight */
    return CONIC_OK;
  release_samples(context, frame);
  size_t room = n + n / 4 + 1;
  conic_status status =
      conic_splats_allocate(context, room, fields | CONIC_SPLATS_TANGENTS | CONIC_SPLATS_OPACITIES, &frame->splats);
  frame->points = status == CONIC_OK ? conic_memory_allocate(context, room, sizeof *frame->points) : NULL;
  if (!frame->points) {
    release_samples(context, frame);
    return CONIC_ERROR_MEMORY;
  }
  frame->room = room;
  return CONIC_OK;
}

/* Counts all samples. */
static conic_status count_samples(patches_selecting *work) {
  conic_context *context = work->patches->context;
  for (int i = 0; i < CONIC_N_GRIDS; i++) {
    conic_grid_part part = conic_grid_whole(conic_grid_sizes[i]);
    work->grid_counts[i] = conic_grid_count(&part, NULL);
  }
  conic_parallel_for(context, work->n_chunks, count_chunk, work);
  work->chunk_starts[0] = 0;
  for (size_t i = 0; i < work->n_chunks; i++)
    work->chunk_starts[i + 1] += work->chunk_starts[i];
  if (work->chunk_starts[work->n_chunks] > UINT32_MAX - 1)
    return conic_fail(context, CONIC_ERROR_MEMORY, "patches: the picture needs more than 4294967294 samples");
  return reserve_samples(work, work->chunk_starts[work->n_chunks]);
}

/* Counts by point, as points at one place are drawn separately. */
static void describe_samples(const patches_selecting *work, conic_patch_selection *selection) {
  const conic_neighbours *tree = &work->patches->surface->tree;
  memset(selection, 0, sizeof *selection);
  selection->splats = work->frame->splats;
  selection->points = work->frame->points;
  for (size_t i = 0; i < tree->n_points; i++) {
    uint32_t slot = tree->slot_of_point[i];
    int what = slot == CONIC_NO_SLOT ? CONIC_PLAN_SPLAT : work->frame->plans[slot];
    selection->n_culled += what == CONIC_PLAN_CULLED;
    selection->n_splats += what == CONIC_PLAN_SPLAT;
    selection->n_patches += what >= CONIC_PLAN_DEEP && conic_patches_shown(work->patches, i, slot);
  }
  selection->n_samples = selection->splats.count - selection->n_splats;
  for (size_t i = 0; i < work->n_chunks; i++)
    selection->n_kept += work->chunk_kept[i];
}

static conic_status select_samples(patches_selecting *work, conic_patch_selection *selection) {
  conic_patches *patches = work->patches;
  conic_patches_plan(patches, &work->view, work->frame->plans);
  conic_status status = count_samples(work);
  if (status != CONIC_OK) {
    memset(work->frame->plans, CONIC_PLAN_CULLED, patches->surface->tree.n_slots); /* nothing can be taken over */
    return status;
  }
  conic_parallel_for(patches->context, work->n_chunks, fill_chunk, work);
  work->frame->splats.count = work->chunk_starts[work->n_chunks];
  memcpy(work->frame->splats.origin, patches->splats.origin, sizeof work->frame->splats.origin);
  gather_clips(&work->frame->splats);
  describe_samples(work, selection);
  return CONIC_OK;
}

conic_status conic_patches_select(conic_patches *patches, const conic_camera *camera, const conic_render_options *given,
                                  conic_patch_selection *selection) {
  conic_context *context = patches->context;
  const conic_neighbours *tree = &patches->surface->tree;
  double diagonal2 = 0.0;
  patches_selecting work = {.patches = patches, .n_chunks = (tree->n_points + CHUNK - 1) / CHUNK};
  conic_render_options render;
  memset(selection, 0, sizeof *selection);
  conic_status status = conic_view_arguments_take(context, "patches", camera, given, &render);
  if (status != CONIC_OK)
    return status;
  if (render.kernel.cutoff != patches->options.cutoff || !(render.prefilter >= 0.0f))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "patches: the kernel's cutoff is not that of the patches");
  for (int axis = 0; axis < 3; axis++) {
    double side = (double)tree->boxes[0][3 + axis] - (double)tree->boxes[0][axis];
    diagonal2 += side * side;
  }
  conic_patches_view_init(&work.view, camera, &render, patches->splats.origin,
                          diagonal2 > 0.0 ? 1e-4 * sqrt(diagonal2) : 1e-4, patches->options.step_px);
  work.last = &patches->frames[patches->i_frame];
  work.frame = &patches->frames[patches->i_frame ^= 1];
  work.chunk_starts = conic_memory_allocate(context, work.n_chunks + 1, sizeof *work.chunk_starts);
  work.chunk_kept = conic_memory_allocate(context, work.n_chunks, sizeof *work.chunk_kept);
  status = CONIC_ERROR_MEMORY;
  if (work.chunk_starts && work.chunk_kept)
    status = select_samples(&work, selection);
  else
    memset(work.frame->plans, CONIC_PLAN_CULLED, tree->n_slots);
  conic_memory_release_these(context, work.chunk_starts, work.chunk_kept);
  return status;
}

void conic_patch_selection_name(const conic_patch_selection *selection, conic_image *image) {
  uint32_t *ids = image->planes[CONIC_PLANE_ID];
  size_t n = (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; ids && i < n; i++)
    if (ids[i] < selection->splats.count)
      ids[i] = selection->points[ids[i]];
}
