/* What of a hybrid model is drawn in one picture. */
#include <string.h>

#include "core/base/kept_memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/threads.h"
#include "core/image/view_arguments.h"
#include "lod/clusters/cluster_seen.h"
#include "lod/hybrid/hybrid_budget.h"
#include "lod/hybrid/hybrid_choose.h"
#include "lod/hybrid/hybrid_point.h"
#include "lod/hybrid/hybrid_stitch.h"

void conic_hybrid_view_init_sized(conic_hybrid_view *view, size_t size) {
  static const conic_hybrid_view own = {.size = sizeof own, .only_kind = -1, .color_error = CONIC_JUST_VISIBLE};
  conic_options_give(view, size, &own);
}

/* A cluster that is drawn, or, after all clusters by its number, a node; and where its parts go. The level is among all
 * of the model's; a node's point is none of them. */
typedef struct choice {
  uint32_t cluster, level;
  size_t splat, triangle, vertex;
  size_t n_put; /* into the triangles, so that they fit their neighbours */
} choice;

/* What is kept from call to call. */
typedef struct hybrid_scratch {
  choice *choices;
  size_t n_choices, choices_room;
  uint32_t *stages;   /* of each cluster of the hybrid: that of its level */
  uint32_t *standing; /* the node that stands for it: behind the stages */
  conic_kept_memory stages_memory, splats_memory, vertices_memory, triangles_memory;
  float *splats; /* arrays of splats_room each; behind them the splats' clusters */
  size_t splats_room;
  float *vertices; /* arrays of vertices_room each */
  size_t vertices_room;
  uint32_t *triangles; /* corners, clusters and materials of triangles_room triangles */
  size_t triangles_room;
} hybrid_scratch;

/* The level of a choice that is a node's point. */
#define CONIC_HYBRID_POINT UINT32_MAX

enum { SPLAT_ARRAYS = 12, VERTEX_ARRAYS = 11, TRIANGLE_ARRAYS = 5, CHOICES_A_TASK = 16 };

typedef struct hybrid_selecting {
  const conic_hybrid *hybrid;
  conic_hybrid_camera camera;
  const conic_hybrid_view *view;
  conic_hybrid_selection *selection;
  hybrid_scratch *scratch;
} hybrid_selecting;

void conic_hybrid_selection_release(conic_context *context, conic_hybrid_selection *selection) {
  hybrid_scratch *kept = selection->scratch;
  if (kept) {
    conic_memory_release(context, kept->choices);
    conic_memory_release(context, kept->stages_memory.pointer);
    conic_memory_release(context, kept->splats_memory.pointer);
    conic_memory_release(context, kept->vertices_memory.pointer);
    conic_memory_release(context, kept->triangles_memory.pointer);
  }
  conic_memory_release(context, kept);
  memset(selection, 0, sizeof *selection);
}

/* Whether the level of a cluster depends on those of others. */
static int is_together(const conic_hybrid_view *view) {
  return view->budget || view->error_px > 0.0;
}

static conic_status add_choice(hybrid_selecting *s, uint32_t i_cluster) {
  hybrid_scratch *kept = s->scratch;
  const conic_hybrid_cluster *cluster = &s->hybrid->clusters[i_cluster];
  if (conic_memory_reserve(s->hybrid->context, &kept->choices, kept->n_choices, kept->n_choices + 1,
                           &kept->choices_room, sizeof *kept->choices) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  uint32_t level = cluster->built;
  if (s->view->only_kind >= 0)
    level = conic_hybrid_finest(s->hybrid, cluster, s->view->only_kind);
  kept->choices[kept->n_choices++] = (choice){.cluster = i_cluster, .level = cluster->first_level + level};
  return CONIC_OK;
}

static conic_status choose_all(hybrid_selecting *s) {
  const conic_hybrid *h = s->hybrid;
  conic_status status = CONIC_OK;
  s->scratch->n_choices = 0;
  for (size_t i = 0; i < h->n_nodes && status == CONIC_OK;) {
    const conic_hybrid_node *node = &h->nodes[i];
    if (conic_hybrid_is_hidden(&s->camera, &node->bound, 0.0)) {
      s->selection->n_culled += node->end - node->begin;
      i = node->next;
      continue;
    }
    for (uint32_t k = node->begin; k < node->end && node->next == i + 1 && status == CONIC_OK; k++) {
      if (conic_hybrid_is_hidden(&s->camera, &h->clusters[k].bound, conic_hybrid_reach(h, &h->clusters[k])))
        s->selection->n_culled++;
      else
        status = add_choice(s, k);
    }
    i++;
  }
  return status;
}

/* A node's choice takes the place of the first of its clusters; those that are left close up. */
static void let_nodes_stand(hybrid_selecting *s, const uint32_t *nodes) {
  const conic_hybrid *h = s->hybrid;
  hybrid_scratch *kept = s->scratch;
  uint32_t last = CONIC_HYBRID_NO_NODE;
  size_t n = 0;
  for (size_t i = 0; i < kept->n_choices; i++) {
    uint32_t node = kept->standing[kept->choices[i].cluster];
    if (node == CONIC_HYBRID_NO_NODE)
      kept->choices[n++] = kept->choices[i];
    else if (node != last)
      kept->choices[n++] =
          (choice){.cluster = (uint32_t)h->n_clusters + node,
                   .level = nodes[node] < h->nodes[node].n_levels ? h->nodes[node].first_level + nodes[node]
                                                                  : CONIC_HYBRID_POINT};
    s->selection->n_joined += node != CONIC_HYBRID_NO_NODE;
    last = node;
  }
  kept->n_choices = n;
}

/* The stages of what was chosen; all else is hidden. Nodes have all of their clusters' borders. */
static void note_stages(hybrid_selecting *s) {
  hybrid_scratch *kept = s->scratch;
  for (size_t i = 0; i < s->hybrid->n_clusters; i++)
    kept->stages[i] = CONIC_HYBRID_HIDDEN;
  for (size_t i = 0; i < kept->n_choices; i++)
    kept->stages[kept->choices[i].cluster] = s->hybrid->levels[kept->choices[i].level].stage;
}

/* Chooses for all clusters in sight, for a budget or for the least time. */
static conic_status choose_together(hybrid_selecting *s) {
  const conic_hybrid *h = s->hybrid;
  const conic_hybrid_view *view = s->view;
  hybrid_scratch *kept = s->scratch;
  size_t n = kept->n_choices;
  uint32_t *clusters = conic_memory_allocate(h->context, 2 * n + h->n_nodes, sizeof *clusters);
  if (!clusters)
    return CONIC_ERROR_MEMORY;
  uint32_t *levels = clusters + n, *nodes = levels + n;
  for (size_t i = 0; i < n; i++)
    clusters[i] = kept->choices[i].cluster;
  conic_status status =
      view->budget
          ? conic_hybrid_fit_budget(h, &s->camera, view->only_kind, view->budget, clusters, n, levels, nodes)
          : conic_hybrid_choose_levels(h, &s->camera, view->error_px, view->only_kind, clusters, n, levels, nodes);
  if (status == CONIC_OK) {
    for (size_t i = 0; i < n; i++)
      kept->choices[i].level = h->clusters[clusters[i]].first_level + levels[i];
    note_stages(s);
    conic_hybrid_find_standing(h, nodes, kept->standing);
    for (size_t i = 0; i < n; i++)
      if (kept->standing[clusters[i]] != CONIC_HYBRID_NO_NODE)
        kept->stages[clusters[i]] = 0;
    let_nodes_stand(s, nodes);
  }
  conic_memory_release(h->context, clusters);
  return status;
}

static const conic_hybrid_node *node_of(const hybrid_selecting *s, const choice *c) {
  return c->cluster < s->hybrid->n_clusters ? NULL : &s->hybrid->nodes[c->cluster - s->hybrid->n_clusters];
}

static void judge_cluster(const hybrid_selecting *s, const choice *c) {
  const conic_hybrid_cluster *cluster = &s->hybrid->clusters[c->cluster];
  s->selection->n_clusters[s->hybrid->levels[c->level].kind]++;
  s->selection->n_simpler += c->level != cluster->first_level + cluster->built;
}

/* What the choices come to. */
static void judge_choices(const hybrid_selecting *s) {
  conic_hybrid_selection *selection = s->selection;
  selection->n_simpler = selection->n_joined;
  for (size_t i = 0; i < s->scratch->n_choices; i++) {
    const choice *c = &s->scratch->choices[i];
    const conic_hybrid_node *node = node_of(s, c);
    const conic_hybrid_bound *bound = node ? &node->bound : &s->hybrid->clusters[c->cluster].bound;
    double error_px = c->level == CONIC_HYBRID_POINT ? conic_hybrid_point_error_px(&s->camera, node)
                      : node ? conic_hybrid_node_error_px(s->hybrid, &s->camera, node, &s->hybrid->levels[c->level])
                             : conic_hybrid_error_px(&s->camera, bound, &s->hybrid->levels[c->level]);
    double change = c->level == CONIC_HYBRID_POINT
                        ? conic_hybrid_point_change(&s->camera, node)
                        : conic_hybrid_change(&s->camera, bound, &s->hybrid->levels[c->level]);
    selection->error_px = error_px > selection->error_px ? error_px : selection->error_px;
    selection->color_error = change > selection->color_error ? change : selection->color_error;
    selection->n_nodes += node && c->level != CONIC_HYBRID_POINT;
    selection->n_points += c->level == CONIC_HYBRID_POINT;
    if (!node)
      judge_cluster(s, c);
  }
}

static conic_status make_stages(hybrid_selecting *s) {
  hybrid_scratch *kept = s->scratch;
  size_t n = s->hybrid->n_clusters;
  kept->stages = conic_keep_room(s->hybrid->context, &kept->stages_memory, 2 * n, sizeof *kept->stages);
  if (!kept->stages)
    return CONIC_ERROR_MEMORY;
  kept->standing = kept->stages + n;
  return CONIC_OK;
}

/* Where each choice's parts go, and how many there are of all. */
static void place_parts(hybrid_selecting *s) {
  hybrid_scratch *kept = s->scratch;
  size_t n_splats = 0, n_triangles = 0, n_vertices = 0;
  for (size_t i = 0; i < kept->n_choices; i++) {
    choice *c = &kept->choices[i];
    c->splat = n_splats;
    c->triangle = n_triangles;
    c->vertex = n_vertices;
    if (c->level == CONIC_HYBRID_POINT) {
      n_splats++;
      continue;
    }
    const conic_hybrid_level *level = &s->hybrid->levels[c->level];
    c->n_put = conic_hybrid_count_stitches(s->hybrid, level, kept->stages);
    n_vertices += level->n_vertices + c->n_put;
    *(level->kind == CONIC_HYBRID_SURFELS ? &n_splats : &n_triangles) += level->count + c->n_put;
  }
  s->selection->splats.count = n_splats;
  s->selection->triangles.count = n_triangles;
  s->selection->triangles.n_vertices = n_vertices;
}

/* Room for all parts of the choices. */
static conic_status make_room_for_parts(hybrid_selecting *s) {
  conic_context *context = s->hybrid->context;
  hybrid_scratch *kept = s->scratch;
  const conic_hybrid_selection *selection = s->selection;
  place_parts(s);
  if (selection->triangles.n_vertices > UINT32_MAX)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the picture's triangles have too many vertices");
  kept->splats_room = selection->splats.count;
  kept->vertices_room = selection->triangles.n_vertices;
  kept->triangles_room = selection->triangles.count;
  kept->splats =
      conic_keep_room(context, &kept->splats_memory, kept->splats_room, (SPLAT_ARRAYS + 1) * sizeof *kept->splats);
  kept->vertices =
      conic_keep_room(context, &kept->vertices_memory, kept->vertices_room, VERTEX_ARRAYS * sizeof *kept->vertices);
  kept->triangles = conic_keep_room(context, &kept->triangles_memory, kept->triangles_room,
                                    TRIANGLE_ARRAYS * sizeof *kept->triangles);
  return kept->splats && kept->vertices && kept->triangles ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* Points the selection's arrays into what is kept. */
static void attach(hybrid_selecting *s) {
  const conic_hybrid *h = s->hybrid;
  const hybrid_scratch *kept = s->scratch;
  conic_splats *splats = &s->selection->splats;
  conic_triangles *triangles = &s->selection->triangles;
  memcpy(splats->origin, h->origin, sizeof splats->origin);
  memcpy(triangles->origin, h->origin, sizeof triangles->origin);
  for (size_t axis = 0; axis < 3; axis++) {
    splats->position[axis] = kept->splats + axis * kept->splats_room;
    splats->tangent_u[axis] = kept->splats + (3 + axis) * kept->splats_room;
    splats->tangent_v[axis] = kept->splats + (6 + axis) * kept->splats_room;
    splats->color[axis] = kept->splats + (9 + axis) * kept->splats_room;
    triangles->position[axis] = kept->vertices + axis * kept->vertices_room;
    triangles->normal[axis] = h->normal[0] ? kept->vertices + (3 + axis) * kept->vertices_room : NULL;
    triangles->color[axis] = h->color[0] ? kept->vertices + (6 + axis) * kept->vertices_room : NULL;
  }
  for (size_t k = 0; k < 2; k++)
    triangles->texture_coordinate[k] = h->texture_coordinate[0] ? kept->vertices + (9 + k) * kept->vertices_room : NULL;
  s->selection->splat_cluster = (uint32_t *)(kept->splats + SPLAT_ARRAYS * kept->splats_room);
  triangles->corners = (uint32_t(*)[3])kept->triangles;
  triangles->cluster = kept->triangles + 3 * kept->triangles_room;
  triangles->material = h->material ? kept->triangles + 4 * kept->triangles_room : NULL;
  triangles->n_materials = h->n_materials;
  triangles->materials = h->materials;
}

static void copy_surfels(const hybrid_selecting *s, const choice *c, const conic_hybrid_level *level) {
  const hybrid_scratch *kept = s->scratch;
  for (size_t k = 0; k < SPLAT_ARRAYS; k++)
    memcpy(kept->splats + k * kept->splats_room + c->splat, s->hybrid->surfels[k] + level->first,
           level->count * sizeof(float));
  for (size_t i = 0; i < level->count; i++)
    s->selection->splat_cluster[c->splat + i] = c->cluster;
}

static void put_point(const hybrid_selecting *s, const choice *c) {
  const hybrid_scratch *kept = s->scratch;
  float values[SPLAT_ARRAYS];
  conic_hybrid_point_splat(&s->camera, node_of(s, c), (double)s->hybrid->cutoff, values);
  for (size_t k = 0; k < SPLAT_ARRAYS; k++)
    kept->splats[k * kept->splats_room + c->splat] = values[k];
  s->selection->splat_cluster[c->splat] = c->cluster;
}

static void gather_listed(float *to, const float *from, const uint32_t *listed, size_t n) {
  for (size_t i = 0; i < n && to; i++)
    to[i] = from[listed[i]];
}

static void copy_triangles(const hybrid_selecting *s, const choice *c, const conic_hybrid_level *level) {
  const conic_hybrid *h = s->hybrid;
  const conic_triangles *to = &s->selection->triangles;
  const uint32_t *listed = h->listed + level->first_vertex;
  for (int axis = 0; axis < 3; axis++) {
    gather_listed(to->position[axis] + c->vertex, h->position[axis], listed, level->n_vertices);
    if (to->normal[0])
      gather_listed(to->normal[axis] + c->vertex, h->normal[axis], listed, level->n_vertices);
    if (to->color[0])
      gather_listed(to->color[axis] + c->vertex, h->color[axis], listed, level->n_vertices);
  }
  for (int k = 0; k < 2 && to->texture_coordinate[0]; k++)
    gather_listed(to->texture_coordinate[k] + c->vertex, h->texture_coordinate[k], listed, level->n_vertices);
  for (size_t i = 0; i < level->count; i++) {
    for (int corner = 0; corner < 3; corner++)
      to->corners[c->triangle + i][corner] = (uint32_t)c->vertex + h->corners[level->first + i][corner];
    to->cluster[c->triangle + i] = c->cluster;
  }
  if (to->material)
    memcpy(to->material + c->triangle, h->material + level->first, level->count * sizeof *to->material);
  if (c->n_put == 0)
    return;
  conic_hybrid_stitching stitching = {.hybrid = h,
                                      .level = level,
                                      .stages = s->scratch->stages,
                                      .to = &s->selection->triangles,
                                      .first_triangle = c->triangle,
                                      .triangle = c->triangle + level->count,
                                      .vertex = c->vertex + level->n_vertices};
  conic_hybrid_stitch(&stitching);
}

static void copy_task(void *data, size_t i_task, int i_thread) {
  const hybrid_selecting *s = data;
  size_t begin = i_task * CHOICES_A_TASK, end = begin + CHOICES_A_TASK;
  (void)i_thread;
  for (size_t i = begin; i < end && i < s->scratch->n_choices; i++) {
    const choice *c = &s->scratch->choices[i];
    if (c->level == CONIC_HYBRID_POINT)
      put_point(s, c);
    else if (s->hybrid->levels[c->level].kind == CONIC_HYBRID_SURFELS)
      copy_surfels(s, c, &s->hybrid->levels[c->level]);
    else
      copy_triangles(s, c, &s->hybrid->levels[c->level]);
  }
}

static int are_dots_of(const hybrid_selecting *s, const choice *c) {
  const conic_hybrid_level *level = c->level == CONIC_HYBRID_POINT ? NULL : &s->hybrid->levels[c->level];
  return level && level->kind == CONIC_HYBRID_SURFELS && level->stage > 0;
}

/* Marks the dots among what was copied, and turns them to the camera. */
static conic_status turn_dots(const hybrid_selecting *s, const conic_camera *camera) {
  conic_splats *splats = &s->selection->splats;
  const hybrid_scratch *kept = s->scratch;
  size_t n_dots = 0;
  for (size_t i = 0; i < kept->n_choices; i++)
    n_dots += (size_t)are_dots_of(s, &kept->choices[i]);
  if (n_dots == 0)
    return CONIC_OK;
  splats->dot = conic_memory_allocate_zeroed(s->hybrid->context, splats->count, sizeof *splats->dot);
  if (!splats->dot)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < kept->n_choices; i++)
    for (size_t k = 0; are_dots_of(s, &kept->choices[i]) && k < s->hybrid->levels[kept->choices[i].level].count; k++)
      splats->dot[kept->choices[i].splat + k] = 1.0f;
  conic_status status = conic_splats_face(s->hybrid->context, splats, camera, splats->tangent_u, splats->tangent_v);
  conic_memory_release(s->hybrid->context, splats->dot);
  splats->dot = NULL;
  return status;
}

static conic_status take_view(conic_context *context, const conic_hybrid_view *given, conic_hybrid_view *view) {
  conic_hybrid_view_init(view);
  if (!conic_options_take(view, given))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "a view of a hybrid that was not set by its init function");
  if (!(view->error_px >= 0.0) || !(view->color_error > 0.0) || view->only_kind > CONIC_HYBRID_SURFELS)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "an error on the screen is 0 or more, one of colours above 0, and a kind one that there is");
  if (view->error_px > 0.0 && view->budget)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "an error and a budget are two ways to choose");
  return CONIC_OK;
}

/* On success there is scratch. */
static conic_status begin_selection(hybrid_selecting *s, const conic_camera *camera,
                                    const conic_render_options *render) {
  conic_render_options known;
  conic_status status = conic_view_arguments_take(s->hybrid->context, "hybrid", camera, render, &known);
  if (status != CONIC_OK)
    return status;
  hybrid_scratch *kept = s->selection->scratch;
  conic_hybrid_info info;
  if (!kept) {
    kept = conic_memory_allocate_zeroed(s->hybrid->context, 1, sizeof *kept);
    if (!kept)
      return CONIC_ERROR_MEMORY;
  }
  memset(s->selection, 0, sizeof *s->selection);
  s->selection->scratch = s->scratch = kept;
  if (!(known.near_z > 0.0)) {
    conic_hybrid_describe(s->hybrid, &info);
    known.near_z = info.near_z;
  }
  conic_hybrid_camera_init(s->hybrid, camera, &known, &s->camera);
  s->camera.color_error = s->view->color_error;
  return CONIC_OK;
}

conic_status conic_hybrid_select(const conic_hybrid *hybrid, const conic_camera *camera,
                                 const conic_render_options *render, const conic_hybrid_view *given,
                                 conic_hybrid_selection *selection) {
  conic_hybrid_view view;
  hybrid_selecting s = {.hybrid = hybrid, .view = &view, .selection = selection};
  conic_status status = take_view(hybrid->context, given, &view);
  if (status == CONIC_OK)
    status = begin_selection(&s, camera, render);
  if (status == CONIC_OK)
    status = make_stages(&s);
  if (status == CONIC_OK)
    status = choose_all(&s);
  if (status == CONIC_OK) {
    if (is_together(&view))
      status = choose_together(&s);
    else
      note_stages(&s);
  }
  if (status == CONIC_OK)
    status = make_room_for_parts(&s);
  if (status != CONIC_OK)
    return status;
  judge_choices(&s);
  attach(&s);
  conic_parallel_for(hybrid->context, (s.scratch->n_choices + CHOICES_A_TASK - 1) / CHOICES_A_TASK, copy_task, &s);
  return turn_dots(&s, camera);
}

void conic_hybrid_name(const conic_hybrid_selection *selection, conic_image *image) {
  const uint32_t *id = image->planes[CONIC_PLANE_ID];
  uint32_t *cluster = image->planes[CONIC_PLANE_CLUSTER];
  size_t n_splats = selection->splats.count, n_triangles = selection->triangles.count;
  for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++) {
    if (id[i] < n_splats)
      cluster[i] = selection->splat_cluster[id[i]];
    else if (id[i] - n_splats < n_triangles)
      cluster[i] = selection->triangles.cluster[id[i] - n_splats];
    else
      cluster[i] = CONIC_NO_ID;
  }
}
