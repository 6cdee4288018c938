/* What of a hybrid model is drawn in one picture. */

#include "core/image/view_arguments.h"
#include "lod/clusters/cluster_seen.h"
#include "lod/hybrid/draw/hybrid_selecting.h"
#include "lod/hybrid/model/hybrid_store.h"

CONIC_DEFINE_OPTIONS(conic_hybrid_view, .only_kind = -1, .color_error = CONIC_JUST_VISIBLE)

void conic_hybrid_selection_release(conic_context *context, conic_hybrid_selection *selection) {
  hybrid_scratch *kept = selection->scratch;
  if (kept)
    conic_memory_release_these(context, kept->choices, kept->seen_memory.pointer, kept->stages_memory.pointer,
                               kept->splats_memory.pointer, kept->vertices_memory.pointer,
                               kept->triangles_memory.pointer, kept->chunks_memory.pointer);
  conic_memory_release(context, kept);
  memset(selection, 0, sizeof *selection);
}

/* Whether the level of a cluster depends on those of others. */
static int is_together(const conic_hybrid_view *view) {
  return view->budget || view->error_px > 0.0;
}

static conic_status add_cluster(const hybrid_selecting *s, uint32_t i_cluster) {
  const conic_hybrid_cluster *cluster = &s->hybrid->clusters[i_cluster];
  if (conic_hybrid_is_hidden(&s->camera, &cluster->bound, 0.0) &&
      conic_hybrid_is_hidden(&s->camera, &cluster->bound, conic_hybrid_reach(s->hybrid, cluster))) {
    s->selection->n_culled++;
    return CONIC_OK;
  }
  uint32_t level = cluster->built;
  if (s->view->only_kind >= 0)
    level = conic_hybrid_finest(s->hybrid, cluster, s->view->only_kind);
  const hybrid_choice added = {.cluster = i_cluster, .level = cluster->first_level + level};
  return conic_memory_append(s->hybrid->context, &s->scratch->choices, &s->scratch->n_choices,
                             &s->scratch->choices_room, &added, sizeof added);
}

/* All in sight. */
static conic_status list_all(const hybrid_selecting *s) {
  const conic_hybrid *h = s->hybrid;
  hybrid_scratch *kept = s->scratch;
  conic_status status = CONIC_OK;
  kept->seen = conic_keep_room(h->context, &kept->seen_memory, h->n_nodes, sizeof *kept->seen);
  if (!kept->seen)
    return CONIC_ERROR_MEMORY;
  kept->n_choices = kept->n_seen = s->selection->n_culled = s->selection->n_joined = 0;
  for (uint32_t i = 0; i < h->n_nodes && status == CONIC_OK;) {
    const conic_hybrid_node *node = &h->nodes[i];
    if (conic_hybrid_is_hidden(&s->camera, &node->bound, 0.0)) {
      s->selection->n_culled += node->end - node->begin;
      i = node->next;
      continue;
    }
    kept->seen[kept->n_seen++] = i++;
    for (uint32_t k = node->begin; k < node->end && node->next == i && status == CONIC_OK; k++)
      status = add_cluster(s, k);
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
          (hybrid_choice){.cluster = (uint32_t)h->n_clusters + node,
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

/* Gives choices what was chosen, and clusters their stages, which are 0 where nodes stand. */
static void take_chosen(hybrid_selecting *s, const uint32_t *levels, const uint32_t *nodes) {
  const conic_hybrid *h = s->hybrid;
  hybrid_scratch *kept = s->scratch;
  for (size_t i = 0; i < kept->n_choices; i++)
    kept->choices[i].level = h->clusters[kept->choices[i].cluster].first_level + levels[i];
  note_stages(s);
  conic_hybrid_find_standing(h, nodes, kept->standing);
  for (size_t i = 0; i < kept->n_choices; i++)
    if (kept->standing[kept->choices[i].cluster] != CONIC_HYBRID_NO_NODE)
      kept->stages[kept->choices[i].cluster] = 0;
  let_nodes_stand(s, nodes);
}

/* Chooses for all clusters in sight, for a budget or for an error. */
static conic_status choose_together(hybrid_selecting *s) {
  const conic_hybrid *h = s->hybrid;
  const conic_hybrid_view *view = s->view;
  const hybrid_scratch *kept = s->scratch;
  uint32_t *clusters = conic_memory_allocate(h->context, 2 * kept->n_choices + h->n_nodes, sizeof *clusters);
  if (!clusters)
    return CONIC_ERROR_MEMORY;
  uint32_t *levels = clusters + kept->n_choices, *nodes = levels + kept->n_choices;
  for (size_t i = 0; i < kept->n_choices; i++)
    clusters[i] = kept->choices[i].cluster;
  const conic_hybrid_choosing choosing = {h,        &s->camera,      view->only_kind, view->error_px, view->budget,
                                          clusters, kept->n_choices, kept->seen,      kept->n_seen};
  conic_status status = conic_hybrid_choose_levels(&choosing, levels, nodes);
  if (status == CONIC_OK)
    take_chosen(s, levels, nodes);
  conic_memory_release(h->context, clusters);
  return status;
}

/* --- what has to be read --- */

/* Holds the frames of clusters in sight that may meet others by simpler levels. */
static conic_status hold_frames(hybrid_selecting *s) {
  const conic_hybrid *h = s->hybrid;
  hybrid_scratch *kept = s->scratch;
  kept->n_frames = kept->n_chunks = 0;
  kept->frames_bytes = 0;
  if (!h->store)
    return CONIC_OK;
  kept->frames = conic_keep_room(h->context, &kept->chunks_memory, 3 * kept->n_choices, sizeof *kept->frames);
  if (!kept->frames)
    return CONIC_ERROR_MEMORY;
  kept->chunks = kept->frames + kept->n_choices;
  for (size_t i = 0; i < kept->n_choices; i++) {
    const hybrid_choice *c = &kept->choices[i];
    if (is_together(s->view) ? h->clusters[c->cluster].n_borders == 0 : h->levels[c->level].n_borders == 0)
      continue;
    kept->frames[kept->n_frames++] = conic_hybrid_frame_chunk(h, c->cluster);
    kept->frames_bytes += conic_hybrid_frame_bytes(&h->clusters[c->cluster]);
  }
  conic_status status = CONIC_OK;
  if (kept->frames_bytes > conic_hybrid_store_room(h))
    status = conic_fail(h->context, CONIC_ERROR_MEMORY,
                        "hybrid: what fits the %zu patches in sight to each other takes %llu MiB, more than there is "
                        "memory for",
                        kept->n_choices, (unsigned long long)(kept->frames_bytes >> 20) + 1);
  if (status == CONIC_OK)
    status = conic_hybrid_store_hold(h, kept->frames, kept->n_frames);
  kept->n_frames = status == CONIC_OK ? kept->n_frames : 0;
  return status;
}

/* Lists what a choice is drawn of, its level and what is put in, and returns its bytes. */
static uint64_t list_chunks_of(hybrid_selecting *s, const hybrid_choice *c) {
  const conic_hybrid *h = s->hybrid;
  hybrid_scratch *kept = s->scratch;
  uint64_t n_bytes = 0;
  if (c->level == CONIC_HYBRID_POINT)
    return 0;
  kept->chunks[kept->n_chunks++] = c->level;
  n_bytes += conic_hybrid_chunk_place(h, c->level).n_bytes;
  if (c->n_put == 0)
    return n_bytes;
  kept->chunks[kept->n_chunks++] = conic_hybrid_ends_chunk(h, c->cluster);
  return n_bytes + conic_hybrid_chunk_place(h, conic_hybrid_ends_chunk(h, c->cluster)).n_bytes;
}

/* Holds what the next choices are drawn of, as many as there is room for, and one at least. */
static conic_status hold_chunks(hybrid_selecting *s) {
  hybrid_scratch *kept = s->scratch;
  uint64_t n_bytes = kept->frames_bytes, room = conic_hybrid_store_room(s->hybrid);
  kept->n_chunks = 0;
  for (s->end = s->first; s->end < kept->n_choices; s->end++) {
    size_t n_before = kept->n_chunks;
    n_bytes += s->hybrid->store ? list_chunks_of(s, &kept->choices[s->end]) : 0;
    if (n_bytes > room && s->end > s->first) {
      kept->n_chunks = n_before;
      break;
    }
  }
  return conic_hybrid_store_hold(s->hybrid, kept->chunks, kept->n_chunks);
}

/* What the choices come to. */
static void judge_choices(const hybrid_selecting *s) {
  conic_hybrid_selection *selection = s->selection;
  selection->n_simpler = selection->n_joined;
  for (size_t i = 0; i < s->scratch->n_choices; i++) {
    const hybrid_choice *c = &s->scratch->choices[i];
    const conic_hybrid_node *node = conic_hybrid_node_chosen(s, c);
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
    if (!node) {
      const conic_hybrid_cluster *cluster = &s->hybrid->clusters[c->cluster];
      s->selection->n_clusters[s->hybrid->levels[c->level].kind]++;
      s->selection->n_simpler += c->level != cluster->first_level + cluster->built;
    }
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

/* Some choices after the other, as far as they are to be read. */
static conic_status copy_parts(hybrid_selecting *s) {
  const hybrid_scratch *kept = s->scratch;
  conic_status status = CONIC_OK;
  for (s->first = 0; s->first < kept->n_choices && status == CONIC_OK; s->first = s->end) {
    status = hold_chunks(s);
    if (status != CONIC_OK)
      return status;
    conic_hybrid_parts_copy(s);
    conic_hybrid_store_let_go(s->hybrid, kept->chunks, kept->n_chunks);
    s->selection->n_chunks += kept->n_chunks;
  }
  return status;
}

/* With the frames of what is in sight. */
static conic_status select_held(hybrid_selecting *s) {
  conic_status status = CONIC_OK;
  if (is_together(s->view))
    status = choose_together(s);
  else
    note_stages(s);
  if (status == CONIC_OK)
    status = conic_hybrid_parts_place(s);
  if (status != CONIC_OK)
    return status;
  judge_choices(s);
  conic_hybrid_parts_attach(s);
  return copy_parts(s);
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
    status = list_all(&s);
  if (status == CONIC_OK)
    status = hold_frames(&s);
  if (status != CONIC_OK)
    return status;
  status = select_held(&s);
  if (status == CONIC_OK)
    status = conic_hybrid_parts_turn(&s, camera);
  conic_hybrid_store_let_go(hybrid, s.scratch->frames, s.scratch->n_frames);
  conic_hybrid_traffic traffic = conic_hybrid_store_traffic(hybrid);
  selection->n_chunks += s.scratch->n_frames;
  selection->n_chunks_read = traffic.n_chunks;
  selection->n_bytes_read = traffic.n_bytes;
  selection->n_bytes_received = traffic.n_received;
  selection->n_bytes_kept = traffic.n_kept_bytes;
  return status;
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
