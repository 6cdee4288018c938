#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "core/message.h"
#include "core/threads.h"
#include "lod/octree_view.h"

/* What becomes part of the selection, in the order of the hierarchy. */
typedef struct piece {
  uint32_t begin, end; /* nodes of a block that is yet to be looked at; or, of `kind`, leaves or one node */
  enum { PIECE_BLOCK, PIECE_LEAVES, PIECE_NODE } kind;
  size_t place, count, n_inner, n_culled; /* in the selection */
} piece;

/* What is kept from call to call. */
typedef struct scratch {
  float *pixels; /* of each node */
  size_t pixels_room;
  piece *pieces;
  size_t n_pieces, pieces_room;
  uint32_t *sources; /* of each splat of the selection: a leaf, or NODE_BIT and a node */
} scratch;

static const uint32_t node_bit = UINT32_C(1) << 31;

enum { PIECES_A_TASK = 8 };

typedef struct selecting {
  const conic_octree *octree;
  conic_octree_view view;
  float error_px;
  conic_selection *selection;
  scratch *scratch;
} selecting;

void conic_selection_options_init(conic_selection_options *options) {
  memset(options, 0, sizeof *options);
  options->size = sizeof *options;
  options->error_px = 1.0;
}

void conic_selection_release(conic_context *context, conic_selection *selection) {
  scratch *kept = selection->scratch;
  conic_splats_release(context, &selection->splats);
  conic_memory_release(context, selection->ids);
  if (kept) {
    conic_memory_release(context, kept->pixels);
    conic_memory_release(context, kept->pieces);
    conic_memory_release(context, kept->sources);
  }
  conic_memory_release(context, kept);
  memset(selection, 0, sizeof *selection);
}

static conic_status add_piece(selecting *s, piece added) {
  scratch *kept = s->scratch;
  if (kept->n_pieces == kept->pieces_room) {
    size_t room = 2 * kept->pieces_room + 256;
    conic_status status =
        conic_memory_grow(s->octree->context, (void **)&kept->pieces, kept->n_pieces, room, sizeof *kept->pieces);
    if (status != CONIC_OK)
      return status;
    kept->pieces_room = room;
  }
  kept->pieces[kept->n_pieces++] = added;
  return CONIC_OK;
}

/* Walks the nodes whose subtrees are larger than a block one by one; the blocks are left for later. */
static conic_status list_pieces(selecting *s) {
  const conic_octree *octree = s->octree;
  conic_status status = CONIC_OK;
  s->scratch->n_pieces = 0;
  s->selection->n_culled = 0;
  if (octree->n_nodes == 0)
    return add_piece(s, (piece){.begin = 0, .end = 1, .kind = PIECE_LEAVES, .count = 1});
  for (uint32_t i = 0; i < octree->n_nodes && status == CONIC_OK;) {
    uint32_t end = octree->end[i];
    if (end - i <= CONIC_OCTREE_BLOCK) {
      status = add_piece(s, (piece){.begin = i, .end = end, .kind = PIECE_BLOCK});
      i = end;
      continue;
    }
    conic_octree_measure(octree, &s->view, i, i + 1, s->scratch->pixels);
    float pixels = s->scratch->pixels[i];
    uint32_t first = octree->first_leaf[i], last = octree->first_leaf[i + 1];
    if (pixels < 0.0f)
      s->selection->n_culled++;
    else if (pixels <= s->error_px)
      status = add_piece(s, (piece){.begin = i, .end = i + 1, .kind = PIECE_NODE, .count = 1, .n_inner = 1});
    else if (last > first)
      status = add_piece(s, (piece){.begin = first, .end = last, .kind = PIECE_LEAVES, .count = last - first});
    i = pixels < 0.0f || pixels <= s->error_px ? end : i + 1;
  }
  return status;
}

/* Counts what a block gives, or, with `sources`, lists it. */
static void walk_block(const selecting *s, piece *block, uint32_t *sources) {
  const conic_octree *octree = s->octree;
  const float *pixels = s->scratch->pixels;
  size_t count = 0, n_inner = 0, n_culled = 0;
  for (uint32_t i = block->begin; i < block->end;) {
    if (pixels[i] <= s->error_px) {
      int is_culled = pixels[i] < 0.0f;
      if (sources && !is_culled)
        sources[count] = node_bit | i;
      count += (size_t)!is_culled;
      n_inner += (size_t)!is_culled;
      n_culled += (size_t)is_culled;
      i = octree->end[i];
      continue;
    }
    uint32_t first = octree->first_leaf[i], last = octree->first_leaf[++i];
    for (; first < last; first++, count++)
      if (sources)
        sources[count] = first;
  }
  block->count = count;
  block->n_inner = n_inner;
  block->n_culled = n_culled;
}

static void count_task(void *data, size_t i_task, int i_thread) {
  selecting *s = data;
  size_t begin = i_task * PIECES_A_TASK, end = begin + PIECES_A_TASK;
  (void)i_thread;
  for (size_t i = begin; i < end && i < s->scratch->n_pieces; i++) {
    piece *p = &s->scratch->pieces[i];
    if (p->kind != PIECE_BLOCK)
      continue;
    conic_octree_measure(s->octree, &s->view, p->begin, p->end, s->scratch->pixels);
    walk_block(s, p, NULL);
  }
}

/* to[k] = the leaves' or the nodes' value of each source. */
static void gather(const uint32_t *sources, size_t n, const float *leaves, const float *nodes, float *to) {
  const float *const from[2] = {leaves, nodes};
  for (size_t k = 0; k < n; k++)
    to[k] = from[sources[k] >> 31][sources[k] & ~node_bit];
}

static void gather_arrays(const selecting *s, size_t begin, size_t n) {
  const conic_splats *leaves = &s->octree->leaves, *nodes = &s->octree->nodes;
  conic_splats *to = &s->selection->splats;
  const uint32_t *sources = s->scratch->sources + begin;
  for (int axis = 0; axis < 3; axis++) {
    gather(sources, n, leaves->position[axis], nodes->position[axis], to->position[axis] + begin);
    gather(sources, n, leaves->tangent_u[axis], nodes->tangent_u[axis], to->tangent_u[axis] + begin);
    gather(sources, n, leaves->tangent_v[axis], nodes->tangent_v[axis], to->tangent_v[axis] + begin);
    if (to->color[axis])
      gather(sources, n, leaves->color[axis], nodes->color[axis], to->color[axis] + begin);
  }
  for (size_t k = 0; k < n; k++) {
    uint32_t source = sources[k] & ~node_bit;
    int is_node = sources[k] >> 31 != 0;
    to->opacity[begin + k] = is_node ? nodes->opacity[source] : leaves->opacity ? leaves->opacity[source] : 1.0f;
    s->selection->ids[begin + k] = is_node ? (uint32_t)s->octree->n_points + source : s->octree->index[source];
  }
}

static void fill_task(void *data, size_t i_task, int i_thread) {
  selecting *s = data;
  scratch *kept = s->scratch;
  size_t begin = i_task * PIECES_A_TASK, end = begin + PIECES_A_TASK;
  (void)i_thread;
  end = end < kept->n_pieces ? end : kept->n_pieces;
  for (size_t i = begin; i < end; i++) {
    piece *p = &kept->pieces[i];
    uint32_t *sources = kept->sources + p->place;
    if (p->kind == PIECE_BLOCK)
      walk_block(s, p, sources);
    else
      for (uint32_t k = p->begin; k < p->end; k++)
        *sources++ = p->kind == PIECE_NODE ? node_bit | k : k;
  }
  size_t first = kept->pieces[begin].place, last = kept->pieces[end - 1].place + kept->pieces[end - 1].count;
  gather_arrays(s, first, last - first);
}

/* Gives every piece its place, and the selection room for all. */
static conic_status place_pieces(selecting *s) {
  conic_context *context = s->octree->context;
  conic_selection *selection = s->selection;
  size_t count = 0;
  selection->n_inner = 0;
  for (size_t i = 0; i < s->scratch->n_pieces; i++) {
    piece *p = &s->scratch->pieces[i];
    p->place = count;
    count += p->count;
    selection->n_inner += p->n_inner;
    selection->n_culled += p->n_culled;
  }
  if (count > selection->room || !selection->ids) {
    size_t room = count + count / 4 + 1024; /* the next picture's may be a few more */
    unsigned fields = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_OPACITIES |
                      (s->octree->leaves.color[0] ? (unsigned)CONIC_SPLATS_COLORS : 0u);
    conic_splats_release(context, &selection->splats);
    conic_memory_release(context, selection->ids);
    conic_memory_release(context, s->scratch->sources);
    selection->room = 0;
    selection->ids = conic_memory_allocate(context, room, sizeof *selection->ids);
    s->scratch->sources = conic_memory_allocate(context, room, sizeof *s->scratch->sources);
    conic_status status = conic_splats_allocate(context, room, fields, &selection->splats);
    if (status != CONIC_OK || !selection->ids || !s->scratch->sources)
      return CONIC_ERROR_MEMORY;
    selection->room = room;
  }
  selection->splats.count = count;
  memcpy(selection->splats.origin, s->octree->leaves.origin, sizeof selection->splats.origin);
  return CONIC_OK;
}

static conic_status select_splats(selecting *s) {
  conic_context *context = s->octree->context;
  conic_status status = list_pieces(s);
  if (status != CONIC_OK)
    return status;
  size_t n_tasks = (s->scratch->n_pieces + PIECES_A_TASK - 1) / PIECES_A_TASK;
  conic_parallel_for(context, n_tasks, count_task, s);
  status = place_pieces(s);
  if (status == CONIC_OK)
    conic_parallel_for(context, n_tasks, fill_task, s);
  return status;
}

static conic_status keep_scratch(const conic_octree *octree, conic_selection *selection) {
  if (!selection->scratch)
    selection->scratch = conic_memory_allocate_zeroed(octree->context, 1, sizeof(scratch));
  scratch *kept = selection->scratch;
  if (!kept)
    return CONIC_ERROR_MEMORY;
  if (kept->pixels && kept->pixels_room >= octree->n_nodes)
    return CONIC_OK;
  conic_memory_release(octree->context, kept->pixels);
  kept->pixels = conic_memory_allocate(octree->context, octree->n_nodes, sizeof *kept->pixels);
  kept->pixels_room = kept->pixels ? octree->n_nodes : 0;
  return kept->pixels ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static const char *what_is_wrong(const conic_octree *octree, const conic_camera *camera,
                                 const conic_render_options *render, const conic_selection_options *options) {
  if (!camera || !render || !options || options->size != sizeof *options || render->size != sizeof *render)
    return "an argument is null, or the options were not initialised";
  if ((double)render->kernel.cutoff != octree->scale.cutoff)
    return "the octree was built for another cutoff of the kernel";
  if (!options->budget && !(options->error_px > 0.0))
    return "the error must be above 0";
  return NULL;
}

conic_status conic_octree_select(const conic_octree *octree, const conic_camera *camera,
                                 const conic_render_options *render, const conic_selection_options *options,
                                 conic_selection *selection) {
  const char *wrong = what_is_wrong(octree, camera, render, options);
  if (wrong)
    return conic_fail(octree->context, CONIC_ERROR_ARGUMENT, "octree: %s", wrong);
  selecting s = {.octree = octree, .selection = selection, .error_px = (float)options->error_px};
  conic_status status = keep_scratch(octree, selection);
  if (status != CONIC_OK)
    return status;
  s.scratch = selection->scratch;
  conic_octree_view_init(octree, camera, render, render->near_z > 0.0 ? render->near_z : conic_octree_near(octree),
                         &s.view);
  if (options->budget && octree->n_nodes)
    status = conic_octree_fit_budget(octree, &s.view, options->budget, s.scratch->pixels, &s.error_px);
  selection->error_px = options->budget ? (double)s.error_px : options->error_px;
  return status == CONIC_OK ? select_splats(&s) : status;
}

void conic_selection_name(const conic_selection *selection, conic_image *image) {
  uint32_t *ids = image->planes[CONIC_PLANE_ID];
  size_t n = (size_t)image->width * (size_t)image->height;
  for (size_t i = 0; ids && i < n; i++)
    if (ids[i] < selection->splats.count)
      ids[i] = selection->ids[ids[i]];
}
