/* Triangles a pixel a work-item: raster/triangles/triangle_tile.c in its order of arithmetic. */

/* Adds to a number of 64 bits, low word first. */
static void gather_count(__global uint *sum, uint n) {
  uint before = atomic_add(sum, n);
  if (before + n < before)
    atomic_add(sum + 1, 1u);
}

/* The nearest triangle of every pixel, and where splats are to be blended what it hides: the splats' thresholds begin
 * with that. */
__kernel void gather_triangles(TRIANGLE_LISTS, __global float *thresholds, __global float *nearest_iz,
                               __global uint *nearest, __global uint *n_fragments) {
  conic_device_frame frame = *frame_constants;
  gather_pixel p = gather_pixel_of(&frame);
  uint at = p.block * 16 + p.lane, i_nearest = 0, n_covered = 0;
  float iz_of_nearest = 0.0f;
  if (!p.is_inside)
    return;
  for (uint i_chunk = 0; i_chunk < frame.n_triangle_chunks; i_chunk++) {
    ulong begin, end;
    triangles_of_tile(&frame, i_chunk, p.tile, chunks, tile_begin, &begin, &end);
    for (ulong i = begin; i < end; i++) {
      uint i_record = (uint)chunks[i_chunk].first_record + entries[i];
      conic_box box = records[i_record].box;
      if (p.x < box.x_begin || p.x >= box.x_end || p.y < box.y_begin || p.y >= box.y_end)
        continue;
      conic_triangle_record record = records[i_record];
      conic_triangle_edges edges;
      float iz;
      conic_triangle_edges_of(&record, &edges);
      if (!conic_triangle_sample(&record, &edges, p.x, p.y, &iz))
        continue;
      n_covered++;
      if (!(iz_of_nearest < iz))
        continue;
      iz_of_nearest = iz;
      i_nearest = i_record;
    }
  }
  nearest_iz[at] = iz_of_nearest;
  nearest[at] = i_nearest;
  if (frame.has_splats && !frame.is_single_pass)
    thresholds[at] =
        n_covered ? conic_triangle_hides(frame.triangle_epsilon, iz_of_nearest, columns[p.x], rows[p.y]) : 0.0f;
  if (n_covered)
    gather_count(n_fragments + 2 * p.tile, n_covered);
}

/* Whether the pixel's triangle is seen: conic_triangles_hide and conic_triangles_win. */
static int gather_triangle_is_visible(const conic_device_frame *frame, float iz, float threshold,
                                      const gather_sums *s) {
  return frame->is_single_pass ? iz > s->nearest_iz : iz > 0.0f && iz >= threshold;
}

/* Adds the triangle to the sums: add_pixel. */
static void gather_add_triangle(const conic_device_frame *frame, const conic_triangle_frame *triangles, uint i_record,
                                float iz, const gather_pixel *p, float dx, float dy, gather_sums *s) {
  conic_triangle_record record = triangles->records[i_record];
  conic_triangle_sight sight;
  const float ray[2] = {dx, dy};
  float size = 0.0f;
  conic_triangle_see(triangles, &record, frame->world_from_cam, p->x, p->y, ray, &sight);
  conic_triangle_lay_texture(&sight);
  if (1.0f > s->heaviest_weight)
    s->z = 1.0f / iz;
  if (iz > s->nearest_iz)
    s->id = frame->first_triangle_id + record.index;
  s->weight += 1.0f;
  s->count++;
  for (int axis = 0; axis < 3; axis++) {
    s->color[axis] += sight.color[axis];
    s->normal[axis] += sight.normal[axis];
    size += fabsf(s->normal[axis]);
  }
  for (int axis = 0; axis < 3 && !(size > 0.0f); axis++)
    s->normal[axis] = sight.normal[axis] * CONIC_LEAST_WEIGHT;
}

/* The triangles that are seen to the sums of the splats, and pass 3. */
__kernel void gather_add_triangles(TRIANGLE_SET, __global const float *nearest_iz, __global const uint *nearest,
                                   __global const float *thresholds, __global const float *sums, PIXEL_PLANES) {
  TRIANGLE_SET_TAKEN
  gather_pixel p = gather_pixel_of(&frame);
  gather_sums none = {0}, s = none;
  if (!p.is_inside)
    return;
  if (frame.has_splats)
    s = gather_load(sums, &p);
  uint at = p.block * 16 + p.lane;
  float iz = nearest_iz[at];
  if (gather_triangle_is_visible(&frame, iz, frame.is_single_pass || !frame.has_splats ? 0.0f : thresholds[at], &s)) {
    if (frame.is_single_pass)
      s = none;
    gather_add_triangle(&frame, &triangles, nearest[at], iz, &p, columns[p.x], rows[p.y], &s);
  }
  gather_resolve_pixel(&frame, &p, &s, PIXEL_PLANES_PASSED);
}
