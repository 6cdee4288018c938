/* What triangles do to a pixel. */

#include "raster/explain/pixel_contributions.h"
#include "raster/triangles/triangle_tile.h"

/* What the viewer sees of a triangle at a pixel. */
static void see(const conic_contributions *c, const conic_triangle_record *record, int x, int y,
                conic_triangle_sight *sight) {
  const conic_view *view = &c->view;
  float ray[2], world_from_cam[3][3];
  conic_contribution_ray(view, x, y, ray);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      world_from_cam[i][j] = view->rotation_float[j][i];
  conic_triangle_see(&c->triangles, record, (const float(*)[3])world_from_cam, x, y, ray, sight);
  conic_triangle_lay_texture(sight);
}

void conic_contribution_triangle_color(const conic_contributions *c, const conic_near_triangle *triangle, int x, int y,
                                       float color[3]) {
  conic_triangle_sight sight;
  see(c, triangle->record, x, y, &sight);
  memcpy(color, sight.color, sizeof sight.color);
}

static void describe_triangle(const conic_contributions *c, const conic_triangle_record *record, int x, int y, float iz,
                              conic_triangle_contribution *to) {
  conic_triangle_sight sight;
  float ray[2];
  conic_contribution_ray(&c->view, x, y, ray);
  to->triangle = record->index;
  to->verdict = CONIC_CONTRIBUTION_HIDDEN;
  to->inverse_depth = iz;
  to->depth = 1.0f / iz;
  to->hides = conic_triangle_hides(c->triangles.epsilon, iz, ray[0], ray[1]);
  see(c, record, x, y, &sight);
  memcpy(to->color, sight.color, sizeof to->color);
  memcpy(to->normal, sight.normal, sizeof to->normal);
}

/* The records of one chunk that cover the pixel; those of a triangle stand together, so that its number is that of the
 * first. */
static size_t list_chunk(conic_contributions *c, size_t i_chunk, size_t i_tile, int x, int y, size_t n) {
  const conic_triangle_frame *frame = &c->triangles;
  const conic_triangle_chunk *chunk = &frame->chunks[i_chunk];
  const uint32_t *begin = frame->tile_begin + i_chunk * (frame->n_tiles + 1) + i_tile;
  for (uint32_t k = begin[0]; k < begin[1]; k++) {
    const conic_triangle_record *record = &frame->records[chunk->first_record + frame->entries[chunk->first_entry + k]];
    conic_triangle_edges edges;
    float iz;
    conic_triangle_edges_of(record, &edges);
    if (x >= record->box.x_begin && x < record->box.x_end && y >= record->box.y_begin && y < record->box.y_end &&
        conic_triangle_sample(record, &edges, x, y, &iz))
      describe_triangle(c, record, x, y, iz, &c->triangle_list[n++]);
  }
  return n;
}

conic_status conic_contribution_triangles(conic_contributions *c, int x, int y,
                                          const conic_triangle_contribution **nearest, size_t *n) {
  const conic_triangle_frame *frame = &c->triangles;
  size_t most = 0,
         i_tile = (size_t)(y >> frame->tile_bits) * (size_t)frame->n_tiles_x + (size_t)(x >> frame->tile_bits);
  *nearest = NULL;
  *n = 0;
  if (!c->drawing.triangles)
    return CONIC_OK;
  for (size_t i = 0; i < frame->n_chunks; i++) {
    const uint32_t *begin = frame->tile_begin + i * (frame->n_tiles + 1) + i_tile;
    most += begin[1] - begin[0];
  }
  c->triangle_list = conic_keep_room(c->context, &c->triangle_list_memory, most, sizeof *c->triangle_list);
  if (!c->triangle_list)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < frame->n_chunks; i++)
    *n = list_chunk(c, i, i_tile, x, y, *n);
  conic_triangle_contribution *found = NULL;
  for (size_t i = 0; i < *n; i++)
    if (!found || found->inverse_depth < c->triangle_list[i].inverse_depth)
      found = &c->triangle_list[i];
  if (found)
    found->verdict = CONIC_CONTRIBUTION_VISIBLE;
  *nearest = found;
  return CONIC_OK;
}

/* The nearest of a tile's triangles along a line of it. */
static void near_in_tile(const conic_triangle_frame *frame, size_t i_tile, int x_begin, int x_end, int y,
                         conic_near_triangle *line) {
  for (size_t i = 0; i < frame->n_chunks; i++) {
    const conic_triangle_chunk *chunk = &frame->chunks[i];
    const uint32_t *begin = frame->tile_begin + i * (frame->n_tiles + 1) + i_tile;
    for (uint32_t k = begin[0]; k < begin[1]; k++) {
      const conic_triangle_record *record =
          &frame->records[chunk->first_record + frame->entries[chunk->first_entry + k]];
      const conic_box *box = &record->box;
      conic_triangle_edges edges;
      if (y < box->y_begin || y >= box->y_end)
        continue;
      int first = box->x_begin > x_begin ? box->x_begin : x_begin, last = box->x_end < x_end ? box->x_end : x_end;
      conic_triangle_edges_of(record, &edges);
      for (int x = first; x < last; x++) {
        float iz;
        if (conic_triangle_sample(record, &edges, x, y, &iz) && line[x].iz < iz)
          line[x] = (conic_near_triangle){.record = record, .triangle = record->index, .iz = iz};
      }
    }
  }
}

void conic_contribution_triangle_line(const conic_contributions *c, int y, conic_near_triangle *line) {
  const conic_triangle_frame *frame = &c->triangles;
  int width = c->view.width;
  memset(line, 0, (size_t)width * sizeof *line);
  if (!c->drawing.triangles)
    return;
  for (int x = 0; x < width; x += frame->tile) {
    size_t i_tile = (size_t)(y >> frame->tile_bits) * (size_t)frame->n_tiles_x + (size_t)(x >> frame->tile_bits);
    near_in_tile(frame, i_tile, x, x + frame->tile < width ? x + frame->tile : width, y, line);
  }
  for (int x = 0; x < width; x++) {
    float ray[2];
    conic_contribution_ray(&c->view, x, y, ray);
    line[x].hides = line[x].iz > 0.0f ? conic_triangle_hides(frame->epsilon, line[x].iz, ray[0], ray[1]) : 0.0f;
  }
}

/* Whether splats hide a triangle. */
static int is_hidden(const conic_contribution *list, size_t n, int passes,
                     const conic_triangle_contribution *triangle) {
  for (size_t i = 0; i < n; i++) {
    if (list[i].verdict > CONIC_CONTRIBUTION_HIDDEN)
      continue;
    if (passes == 1 ? list[i].inverse_depth >= triangle->inverse_depth : list[i].hides > triangle->inverse_depth)
      return 1;
  }
  return 0;
}

conic_status conic_contributions_triangles_at(conic_contributions *c, int x, int y,
                                              const conic_triangle_contribution **list, size_t *n) {
  const conic_contribution *splats;
  const conic_triangle_contribution *nearest;
  size_t n_splats;
  conic_status status = conic_contributions_at(c, x, y, &splats, &n_splats);
  if (status == CONIC_OK)
    status = conic_contribution_triangles(c, x, y, &nearest, n);
  if (status != CONIC_OK)
    return status;
  if (nearest && is_hidden(splats, n_splats, c->options.passes, nearest))
    c->triangle_list[nearest - c->triangle_list].verdict = CONIC_CONTRIBUTION_HIDDEN;
  *list = c->triangle_list;
  return CONIC_OK;
}
