/* What the chosen levels of a hybrid model are drawn of, copied into one set of splats and one of triangles. */

#include "lod/hybrid/draw/hybrid_selecting.h"

enum { SPLAT_ARRAYS = 12, VERTEX_ARRAYS = 11, TRIANGLE_ARRAYS = 5, CHOICES_A_TASK = 16 };

/* Where each choice's parts go, and how many there are of all. */
static void place_parts(hybrid_selecting *s) {
  hybrid_scratch *kept = s->scratch;
  size_t n_splats = 0, n_triangles = 0, n_vertices = 0;
  for (size_t i = 0; i < kept->n_choices; i++) {
    hybrid_choice *c = &kept->choices[i];
    c->splat = n_splats;
    c->triangle = n_triangles;
    c->vertex = n_vertices;
    if (c->level == CONIC_HYBRID_POINT) {
      n_splats++;
      continue;
    }
    const conic_hybrid_level *level = &s->hybrid->levels[c->level];
    c->n_put = conic_hybrid_count_stitches(s->hybrid, c->cluster, level, kept->stages);
    n_vertices += level->n_vertices + c->n_put;
    *(level->kind == CONIC_HYBRID_SURFELS ? &n_splats : &n_triangles) += level->count + c->n_put;
  }
  s->selection->splats.count = n_splats;
  s->selection->triangles.count = n_triangles;
  s->selection->triangles.n_vertices = n_vertices;
}

conic_status conic_hybrid_parts_place(hybrid_selecting *s) {
  conic_context *context = s->hybrid->context;
  hybrid_scratch *kept = s->scratch;
  const conic_hybrid_selection *selection = s->selection;
  place_parts(s);
  if (selection->triangles.n_vertices > UINT32_MAX)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the picture's triangles have too many vertices");
  uint64_t n_bytes = sizeof(float) * ((uint64_t)selection->splats.count * (SPLAT_ARRAYS + 1) +
                                      (uint64_t)selection->triangles.n_vertices * VERTEX_ARRAYS +
                                      (uint64_t)selection->triangles.count * TRIANGLE_ARRAYS);
  if (s->hybrid->drawing_bytes && n_bytes > s->hybrid->drawing_bytes)
    return conic_fail(context, CONIC_ERROR_MEMORY,
                      "hybrid: the picture's %zu triangles and %zu surfels take %llu MiB of memory, and may take %llu; "
                      "an error or a budget draws fewer",
                      selection->triangles.count, selection->splats.count, (unsigned long long)(n_bytes >> 20) + 1,
                      (unsigned long long)(s->hybrid->drawing_bytes >> 20));
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

void conic_hybrid_parts_attach(hybrid_selecting *s) {
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
    triangles->normal[axis] = h->flags & CONIC_CHY_NORMALS ? kept->vertices + (3 + axis) * kept->vertices_room : NULL;
    triangles->color[axis] = h->flags & CONIC_CHY_COLORS ? kept->vertices + (6 + axis) * kept->vertices_room : NULL;
  }
  for (size_t k = 0; k < 2; k++)
    triangles->texture_coordinate[k] =
        h->flags & CONIC_CHY_TEXTURE_COORDINATES ? kept->vertices + (9 + k) * kept->vertices_room : NULL;
  s->selection->splat_cluster = (uint32_t *)(kept->splats + SPLAT_ARRAYS * kept->splats_room);
  triangles->corners = (uint32_t(*)[3])kept->triangles;
  triangles->cluster = kept->triangles + 3 * kept->triangles_room;
  triangles->material = h->flags & CONIC_CHY_MATERIALS ? kept->triangles + 4 * kept->triangles_room : NULL;
  triangles->n_materials = h->n_materials;
  triangles->materials = h->materials;
}

static void copy_surfels(const hybrid_selecting *s, const hybrid_choice *c, const conic_hybrid_level *level) {
  const hybrid_scratch *kept = s->scratch;
  conic_hybrid_piece piece = conic_hybrid_piece_of(s->hybrid, c->level);
  for (size_t k = 0; k < SPLAT_ARRAYS; k++)
    memcpy(kept->splats + k * kept->splats_room + c->splat, piece.surfels[k], level->count * sizeof(float));
  for (size_t i = 0; i < level->count; i++)
    s->selection->splat_cluster[c->splat + i] = c->cluster;
}

static void put_point(const hybrid_selecting *s, const hybrid_choice *c) {
  const hybrid_scratch *kept = s->scratch;
  float values[SPLAT_ARRAYS];
  conic_hybrid_point_splat(&s->camera, conic_hybrid_node_chosen(s, c), (double)s->hybrid->cutoff, values);
  for (size_t k = 0; k < SPLAT_ARRAYS; k++)
    kept->splats[k * kept->splats_room + c->splat] = values[k];
  s->selection->splat_cluster[c->splat] = c->cluster;
}

static void copy_floats(float *to, size_t at, const float *from, size_t n) {
  if (to)
    memcpy(to + at, from, n * sizeof *to);
}

static void copy_vertices(const conic_triangles *to, size_t at, const conic_hybrid_vertices *from, size_t n) {
  for (int axis = 0; axis < 3; axis++) {
    copy_floats(to->position[axis], at, from->position[axis], n);
    copy_floats(to->normal[axis], at, from->normal[axis], n);
    copy_floats(to->color[axis], at, from->color[axis], n);
  }
  for (int k = 0; k < 2; k++)
    copy_floats(to->texture_coordinate[k], at, from->texture_coordinate[k], n);
}

static void copy_triangles(const hybrid_selecting *s, const hybrid_choice *c, const conic_hybrid_level *level) {
  const conic_triangles *to = &s->selection->triangles;
  conic_hybrid_piece piece = conic_hybrid_piece_of(s->hybrid, c->level);
  copy_vertices(to, c->vertex, &piece.vertices, level->n_vertices);
  for (size_t i = 0; i < level->count; i++) {
    for (int corner = 0; corner < 3; corner++)
      to->corners[c->triangle + i][corner] = (uint32_t)c->vertex + conic_hybrid_corner(&piece, i, corner);
    to->cluster[c->triangle + i] = c->cluster;
  }
  if (to->material)
    memcpy(to->material + c->triangle, piece.material, level->count * sizeof *to->material);
  if (c->n_put == 0)
    return;
  conic_hybrid_stitching stitching = {.hybrid = s->hybrid,
                                      .cluster = c->cluster,
                                      .level = level,
                                      .stages = s->scratch->stages,
                                      .to = &s->selection->triangles,
                                      .first_triangle = c->triangle,
                                      .triangle = c->triangle + level->count,
                                      .vertex = c->vertex + level->n_vertices};
  conic_hybrid_stitch(&stitching);
}

static void copy_task(void *data, size_t i_task) {
  const hybrid_selecting *s = data;
  size_t begin = s->first + i_task * CHOICES_A_TASK, end = begin + CHOICES_A_TASK;
  for (size_t i = begin; i < end && i < s->end; i++) {
    const hybrid_choice *c = &s->scratch->choices[i];
    if (c->level == CONIC_HYBRID_POINT)
      put_point(s, c);
    else if (s->hybrid->levels[c->level].kind == CONIC_HYBRID_SURFELS)
      copy_surfels(s, c, &s->hybrid->levels[c->level]);
    else
      copy_triangles(s, c, &s->hybrid->levels[c->level]);
  }
}

static int are_dots_of(const hybrid_selecting *s, const hybrid_choice *c) {
  const conic_hybrid_level *level = c->level == CONIC_HYBRID_POINT ? NULL : &s->hybrid->levels[c->level];
  return level && level->kind == CONIC_HYBRID_SURFELS && level->stage > 0;
}

void conic_hybrid_parts_copy(hybrid_selecting *s) {
  conic_parallel_for(s->hybrid->context, (s->end - s->first + CHOICES_A_TASK - 1) / CHOICES_A_TASK, copy_task, s);
}

conic_status conic_hybrid_parts_turn(const hybrid_selecting *s, const conic_camera *camera) {
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
