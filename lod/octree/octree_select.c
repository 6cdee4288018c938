#include "core/base/kept_memory.h"
#include "core/image/view_arguments.h"
#include "lod/octree/octree_loops.h"

/* What becomes part of the selection, in the order of the hierarchy. */
typedef struct selection_piece {
  uint32_t begin, end; /* nodes of a block that is yet to be looked at; or, of `kind`, leaves or one node */
  enum { PIECE_BLOCK, PIECE_LEAVES, PIECE_NODE } kind;
  size_t place, count, n_inner, n_culled; /* in the selection */
} selection_piece;

/* What is kept from call to call. */
typedef struct octree_scratch {
  selection_piece *pieces;
  size_t n_pieces, pieces_room;
  uint32_t *sources; /* what each block gives, from its first leaf on: leaves, or CONIC_NODE_BIT and a node */
  conic_kept_memory sources_memory, clips;
  float *arrays; /* the selection's */
} octree_scratch;

enum { PIECES_A_TASK = 2 };

typedef struct octree_selecting {
  const conic_octree *octree;
  conic_octree_view view;
  float error_px;
  conic_selection *selection;
  octree_scratch *scratch;
  conic_put_function *put;
} octree_selecting;

CONIC_DEFINE_OPTIONS(conic_selection_options, .error_px = 1.0)

void conic_selection_release(conic_context *context, conic_selection *selection) {
  octree_scratch *kept = selection->scratch;
  if (kept) {
    conic_memory_release_these(context, kept->arrays, kept->clips.pointer, kept->pieces, kept->sources_memory.pointer);
  }
  conic_memory_release(context, kept);
  memset(selection, 0, sizeof *selection);
}

static conic_status add_selection_piece(octree_selecting *s, selection_piece added) {
  octree_scratch *kept = s->scratch;
  return conic_memory_append(s->octree->context, &kept->pieces, &kept->n_pieces, &kept->pieces_room, &added,
                             sizeof added);
}

/* Walks the nodes whose subtrees are larger than a block one by one; the blocks are left for later. */
static conic_status list_pieces(octree_selecting *s) {
  const conic_octree *octree = s->octree;
  conic_status status = CONIC_OK;
  conic_measured measured = {0};
  s->scratch->n_pieces = 0;
  s->selection->n_culled = 0;
  if (octree->n_nodes == 0)
    return add_selection_piece(s, (selection_piece){.begin = 0, .end = 1, .kind = PIECE_LEAVES, .count = 1});
  for (uint32_t i = 0; i < octree->n_nodes && status == CONIC_OK;) {
    uint32_t end = octree->end[i];
    if (end - i <= CONIC_OCTREE_BLOCK) {
      status = add_selection_piece(s, (selection_piece){.begin = i, .end = end, .kind = PIECE_BLOCK});
      i = end;
      continue;
    }
    float pixels = conic_octree_look_up(octree, &s->view, i, &measured);
    uint32_t first = octree->first_leaf[i], last = octree->first_leaf[i + 1];
    if (pixels < 0.0f)
      s->selection->n_culled++;
    else if (pixels <= s->error_px)
      status = add_selection_piece(
          s, (selection_piece){.begin = i, .end = i + 1, .kind = PIECE_NODE, .count = 1, .n_inner = 1});
    else if (last > first)
      status = add_selection_piece(
          s, (selection_piece){.begin = first, .end = last, .kind = PIECE_LEAVES, .count = last - first});
    i = pixels < 0.0f || pixels <= s->error_px ? end : i + 1;
  }
  return status;
}

/* Lists what a block gives, where its first leaf has its place: it gives no more than it has leaves. */
static void walk_block(const octree_selecting *s, selection_piece *block) {
  const conic_octree *octree = s->octree;
  uint32_t *const sources = s->scratch->sources + octree->first_leaf[block->begin], *next = sources;
  conic_measured measured = {0};
  for (uint32_t i = block->begin; i < block->end;) {
    uint32_t end = octree->end[i];
    float pixels = conic_octree_look_up(octree, &s->view, i, &measured);
    if (pixels <= s->error_px) {
      int is_culled = pixels < 0.0f;
      *next = CONIC_NODE_BIT | i;
      next += !is_culled;
      block->n_inner += (size_t)!is_culled;
      block->n_culled += (size_t)is_culled;
      i = end;
      continue;
    }
    uint32_t first = octree->first_leaf[i], last = octree->first_leaf[++i];
    while (first < last)
      *next++ = first++;
  }
  block->count = (size_t)(next - sources);
}

static void count_task(void *data, size_t i_task) {
  octree_selecting *s = data;
  size_t begin = i_task * PIECES_A_TASK, end = begin + PIECES_A_TASK;
  for (size_t i = begin; i < end && i < s->scratch->n_pieces; i++) {
    selection_piece *p = &s->scratch->pieces[i];
    if (p->kind == PIECE_BLOCK)
      walk_block(s, p);
  }
}

/* Puts n splats at `begin` of the selection. */
static void put_splats(const octree_selecting *s, const uint32_t *sources, size_t begin, size_t n) {
  s->put(s->octree, sources, n, s->view.cull_back ? s->view.eye : NULL, &s->selection->splats, s->selection->ids,
         begin);
}

static void fill_task(void *data, size_t i_task) {
  octree_selecting *s = data;
  octree_scratch *kept = s->scratch;
  size_t begin = i_task * PIECES_A_TASK, end = begin + PIECES_A_TASK;
  for (size_t i = begin; i < end && i < kept->n_pieces; i++) {
    const selection_piece *p = &kept->pieces[i];
    if (p->kind == PIECE_BLOCK)
      put_splats(s, kept->sources + s->octree->first_leaf[p->begin], p->place, p->count);
    for (uint32_t k = p->begin; k < p->end && p->kind != PIECE_BLOCK; k++) {
      uint32_t source = p->kind == PIECE_NODE ? CONIC_NODE_BIT | k : k;
      put_splats(s, &source, p->place + k - p->begin, 1);
    }
  }
}

/* One block for all arrays, each a few lines of the cache further on in its page than the one before: at the same place
 * in theirs, they would drive each other out of the cache. */
static conic_status make_room_for_arrays(octree_selecting *s, size_t room) {
  enum { PAGE = 1024, SHIFT = 64, N_ARRAYS = 15 }; /* floats */
  conic_context *context = s->octree->context;
  conic_selection *selection = s->selection;
  conic_splats *splats = &selection->splats;
  size_t stride = (room + PAGE - 1) / PAGE * PAGE + SHIFT;
  int n = 0;
  conic_memory_release(context, s->scratch->arrays);
  memset(splats, 0, sizeof *splats);
  selection->ids = NULL;
  selection->room = 0;
  float *arrays = s->scratch->arrays = conic_memory_allocate(context, stride * N_ARRAYS, sizeof *arrays);
  if (!arrays)
    return CONIC_ERROR_MEMORY;
  conic_memory_prefer_large_pages(context, arrays, stride * N_ARRAYS * sizeof *arrays);
  for (int axis = 0; axis < 3; axis++) {
    splats->position[axis] = arrays + stride * (size_t)n++;
    splats->tangent_u[axis] = arrays + stride * (size_t)n++;
    splats->tangent_v[axis] = arrays + stride * (size_t)n++;
    if (s->octree->leaves.color[0])
      splats->color[axis] = arrays + stride * (size_t)n++;
  }
  splats->opacity = arrays + stride * (size_t)n++;
  selection->ids = (uint32_t *)(arrays + stride * (size_t)n++);
  if (s->octree->leaves.dot)
    splats->dot = arrays + stride * (size_t)n;
  selection->room = room;
  return CONIC_OK;
}

/* Gives every piece its place, and the selection room for all. */
static conic_status place_pieces(octree_selecting *s) {
  conic_selection *selection = s->selection;
  size_t count = 0;
  selection->n_inner = 0;
  for (size_t i = 0; i < s->scratch->n_pieces; i++) {
    selection_piece *p = &s->scratch->pieces[i];
    p->place = count;
    count += p->count;
    selection->n_inner += p->n_inner;
    selection->n_culled += p->n_culled;
  }
  if (count > selection->room || !selection->ids) {
    conic_status status = make_room_for_arrays(s, count + count / 4 + 1024); /* the next picture's may be a few more */
    if (status != CONIC_OK)
      return status;
  }
  selection->splats.count = count;
  memcpy(selection->splats.origin, s->octree->leaves.origin, sizeof selection->splats.origin);
  return CONIC_OK;
}

/* The clip lines of the leaves that were chosen, in their new order. */
static conic_status take_clips(octree_selecting *s) {
  const conic_octree *octree = s->octree;
  conic_selection *selection = s->selection;
  conic_splats *splats = &selection->splats;
  splats->n_clips = 0;
  splats->clips = NULL;
  if (octree->n_clips == 0)
    return CONIC_OK;
  splats->clips = conic_keep_room(octree->context, &s->scratch->clips, octree->n_clips, sizeof *splats->clips);
  if (!splats->clips)
    return CONIC_ERROR_MEMORY;
  for (size_t k = 0; k < splats->count; k++) {
    uint32_t id = selection->ids[k];
    if (id >= octree->n_points || octree->clip_of_point[id] == CONIC_NO_CLIP)
      continue;
    splats->clips[splats->n_clips] = octree->clips[octree->clip_of_point[id]];
    splats->clips[splats->n_clips++].splat = (uint32_t)k;
  }
  return CONIC_OK;
}

static conic_status select_splats(octree_selecting *s) {
  conic_context *context = s->octree->context;
  conic_status status = list_pieces(s);
  if (status != CONIC_OK)
    return status;
  size_t n_tasks = (s->scratch->n_pieces + PIECES_A_TASK - 1) / PIECES_A_TASK;
  conic_parallel_for(context, n_tasks, count_task, s);
  status = place_pieces(s);
  if (status == CONIC_OK)
    conic_parallel_for(context, n_tasks, fill_task, s);
  return status == CONIC_OK ? take_clips(s) : status;
}

static conic_status keep_scratch(const conic_octree *octree, conic_selection *selection) {
  if (!selection->scratch)
    selection->scratch = conic_memory_allocate_zeroed(octree->context, 1, sizeof(octree_scratch));
  octree_scratch *kept = selection->scratch;
  if (!kept)
    return CONIC_ERROR_MEMORY;
  kept->sources = conic_keep_room(octree->context, &kept->sources_memory, octree->n_leaves, sizeof *kept->sources);
  return kept->sources ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static const char *what_of_view_is_wrong(const conic_octree *octree, const conic_render_options *render,
                                         const conic_selection_options *given, conic_selection_options *options) {
  conic_selection_options_init(options);
  if (!conic_options_take(options, given))
    return "the options were not initialised";
  if ((double)render->kernel.cutoff != octree->scale.cutoff)
    return "the octree was built for another cutoff of the kernel";
  if (!options->budget && !(options->error_px > 0.0))
    return "the error must be above 0";
  return NULL;
}

conic_status conic_octree_select(conic_octree *octree, const conic_camera *camera, const conic_render_options *given,
                                 const conic_selection_options *wanted, conic_selection *selection) {
  conic_render_options render;
  conic_selection_options options;
  conic_status status = conic_view_arguments_take(octree->context, "octree", camera, given, &render);
  if (status != CONIC_OK)
    return status;
  const char *wrong = what_of_view_is_wrong(octree, &render, wanted, &options);
  if (wrong)
    return conic_fail(octree->context, CONIC_ERROR_ARGUMENT, "octree: %s", wrong);
  octree_selecting s = {.octree = octree, .selection = selection, .error_px = (float)options.error_px};
  conic_octree_loops loops;
  status = conic_isa_choose(octree->context, render.isa, &render.isa);
  conic_octree_loops_init(&loops, render.isa);
  s.put = loops.put;
  if (status == CONIC_OK)
    status = conic_octree_decode_all(octree);
  if (status == CONIC_OK)
    status = keep_scratch(octree, selection);
  if (status != CONIC_OK)
    return status;
  s.scratch = selection->scratch;
  conic_octree_view_init(octree, camera, &render, render.near_z > 0.0 ? render.near_z : conic_octree_near(octree),
                         &s.view);
  if (options.budget && octree->n_nodes)
    status = conic_octree_fit_budget(octree, &s.view, options.budget, &s.error_px);
  selection->error_px = options.budget ? (double)s.error_px : options.error_px;
  if (status == CONIC_OK)
    status = select_splats(&s);
  const conic_splats *chosen = &selection->splats;
  return status == CONIC_OK && chosen->dot && chosen->count
             ? conic_splats_face(octree->context, chosen, camera, chosen->tangent_u, chosen->tangent_v)
             : status;
}

void conic_selection_name(const conic_selection *selection, conic_image *image) {
  uint32_t *ids = image->planes[CONIC_PLANE_ID];
  size_t n = (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; ids && i < n; i++)
    if (ids[i] < selection->splats.count)
      ids[i] = selection->ids[ids[i]];
}
