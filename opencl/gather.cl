/* The splats' passes a pixel a work-item, 16 × 16 of them a group: for GPUs. raster/loops/raster_loops_scalar.c in the same
 * order of arithmetic. */
#include "opencl/gather_resolve.cl"

static int gather_meets(uint blocks, const gather_pixel *p) {
  return p->column >= (blocks & 15) && p->column <= (blocks >> 4 & 15) && p->row >= (blocks >> 8 & 15) &&
         p->row <= blocks >> 12;
}

/* conic_fragment_at of one of a tile's references, with the records in global memory; its footprint, too. */
static int gather_fragment(const conic_view *view, conic_device_reference reference,
                           __global const conic_footprint *footprints, __global const conic_ray *rays,
                           __global const conic_clip_record *clips, const gather_pixel *p, conic_footprint *footprint,
                           conic_fragment *fragment) {
  if (!gather_meets(reference.blocks, p))
    return 0;
  *footprint = footprints[reference.footprint];
  float dx = conic_row_dx(footprint, p->x), dy = conic_row_dy(footprint, p->y);
  if (conic_is_clipped(footprint)) {
    conic_clip_record clip = clips[reference.footprint];
    if (!conic_clip_keeps(&clip, dx, dy))
      return 0;
  }
  if (footprint->s3 == 0.0f) {
    conic_ray ray = rays[footprint->i_ray];
    if (conic_is_laplace(footprint))
      return conic_laplace_fragment(view, footprint, &ray, dx, dy, fragment);
    return conic_ray_fragment(view, footprint, &ray, dx, dy, fragment);
  }
  return conic_variance_fragment(view, footprint, dx, dy, fragment);
}

/* The names that every entry here has for what it reads. */
#define GATHER_RECORDS                                                                                                 \
  __constant conic_view *frame_view, __constant conic_device_frame *frame_constants, __global const ulong *tile_begin, \
      __global const conic_device_reference *references, __global const conic_footprint *footprints,                   \
      __global const conic_projected_surface *surfaces, __global const conic_ray *rays, __global const conic_clip_record *clips,   \
      __global const float *profile_table

/* The view, with the table of its profile where that is here. */
static conic_view view_of(__constant conic_view *frame_view, __global const float *profile_table) {
  conic_view view = *frame_view;
  if (view.profile.table)
    view.profile.table = profile_table;
  return view;
}

/* Pass 1: every pixel's threshold, and how many fragments there are. */
__kernel void gather_visibility(GATHER_RECORDS, __global const float *columns, __global const float *rows,
                                __global float *thresholds, __global uint *n_fragments) {
  conic_view view = view_of(frame_view, profile_table);
  conic_device_frame frame = *frame_constants;
  gather_pixel p = gather_pixel_of(&frame);
  uint at = p.block * 16 + p.lane, n_covered = 0;
  float threshold = frame.is_first && !frame.has_triangles ? 0.0f : thresholds[at];
  if (!p.is_inside)
    return;
  for (ulong i = tile_begin[p.tile]; i < tile_begin[p.tile + 1]; i++) {
    conic_device_reference reference = references[i];
    conic_footprint footprint;
    conic_fragment fragment;
    if (!gather_fragment(&view, reference, footprints, rays, clips, &p, &footprint, &fragment))
      continue;
    float offset_iz = conic_hiding_iz(&footprint, &fragment, columns[p.x], rows[p.y]);
    threshold = offset_iz > threshold ? offset_iz : threshold;
    n_covered++;
  }
  thresholds[at] = threshold;
  if (n_covered)
    atomic_add(&n_fragments[p.tile], n_covered);
}

/* The surface of a record, without what else of it there is in memory. */
static void gather_blend(const conic_view *view, const conic_footprint *footprint,
                         __global const conic_projected_surface *surface, const conic_fragment *fragment, gather_sums *s,
                         int *is_heaviest) {
  float weight = conic_final_weight(view, footprint, fragment->q, fragment->scale);
  s->weight += weight;
  for (int axis = 0; axis < 3; axis++) {
    s->color[axis] += weight * surface->color[axis];
    s->normal[axis] += weight * surface->normal[axis];
  }
  *is_heaviest = s->heaviest_weight < weight;
  if (*is_heaviest)
    s->heaviest_weight = weight;
}

/* What of the heaviest splat the picture shows beside the sums. */
static void gather_keep_heaviest(uint i_heaviest, __global const conic_footprint *footprints,
                                 __global const conic_projected_surface *surfaces, const gather_pixel *p, gather_sums *s) {
  conic_footprint footprint = footprints[i_heaviest];
  s->z = conic_plane_z(&footprint, p->x, p->y);
  for (int axis = 0; axis < 3; axis++)
    s->heaviest_normal[axis] = surfaces[i_heaviest].normal[axis];
}

/* Of a part of the splats: on with the sums, or the picture where it is the last and no triangles follow. */
static void gather_finish(const conic_device_frame *frame, const gather_pixel *p, const gather_sums *s,
                          __global float *sums, PIXEL_PLANES) {
  if (!frame->is_last || frame->keeps_sums)
    gather_store(s, sums, p);
  if (frame->is_last && !frame->has_triangles)
    gather_resolve_pixel(frame, p, s, PIXEL_PLANES_PASSED);
}

/* Pass 2 and, with the last part of the splats, pass 3. */
__kernel void gather_accumulate(GATHER_RECORDS, __global const float *thresholds, __global float *sums, PIXEL_PLANES) {
  conic_view view = view_of(frame_view, profile_table);
  conic_device_frame frame = *frame_constants;
  gather_pixel p = gather_pixel_of(&frame);
  gather_sums s = {0};
  if (!p.is_inside)
    return;
  if (!frame.is_first)
    s = gather_load(sums, &p);
  float threshold = thresholds[p.block * 16 + p.lane];
  uint i_heaviest = CONIC_NO_ID;
  for (ulong i = tile_begin[p.tile]; i < tile_begin[p.tile + 1]; i++) {
    conic_device_reference reference = references[i];
    conic_footprint footprint;
    conic_fragment fragment;
    int is_heaviest;
    if (!gather_fragment(&view, reference, footprints, rays, clips, &p, &footprint, &fragment) ||
        !(conic_seen_iz(&fragment) >= threshold))
      continue;
    gather_blend(&view, &footprint, &surfaces[reference.footprint], &fragment, &s, &is_heaviest);
    i_heaviest = is_heaviest ? reference.footprint : i_heaviest;
    s.count++;
    if (s.nearest_iz < fragment.iz) {
      s.nearest_iz = fragment.iz;
      s.id = surfaces[reference.footprint].index;
    }
  }
  if (i_heaviest != CONIC_NO_ID)
    gather_keep_heaviest(i_heaviest, footprints, surfaces, &p, &s);
  gather_finish(&frame, &p, &s, sums, PIXEL_PLANES_PASSED);
}

/* In place of both where the nearest splat wins alone. */
__kernel void gather_nearest(GATHER_RECORDS, __global uint *n_fragments, __global float *sums, PIXEL_PLANES) {
  conic_view view = view_of(frame_view, profile_table);
  conic_device_frame frame = *frame_constants;
  gather_pixel p = gather_pixel_of(&frame);
  gather_sums s = {0};
  if (!p.is_inside)
    return;
  if (!frame.is_first)
    s = gather_load(sums, &p);
  uint i_nearest = CONIC_NO_ID, found = 0;
  conic_fragment nearest = {0, 0, 0, 0};
  for (ulong i = tile_begin[p.tile]; i < tile_begin[p.tile + 1]; i++) {
    conic_device_reference reference = references[i];
    conic_footprint footprint;
    conic_fragment fragment;
    if (!gather_fragment(&view, reference, footprints, rays, clips, &p, &footprint, &fragment))
      continue;
    found++;
    if (!(s.nearest_iz < fragment.iz))
      continue;
    s.nearest_iz = fragment.iz;
    nearest = fragment;
    i_nearest = reference.footprint;
  }
  if (found)
    atomic_add(&n_fragments[p.tile], found);
  if (i_nearest != CONIC_NO_ID) {
    gather_sums one = {0};
    int is_heaviest;
    conic_footprint footprint = footprints[i_nearest];
    one.nearest_iz = s.nearest_iz;
    gather_blend(&view, &footprint, &surfaces[i_nearest], &nearest, &one, &is_heaviest);
    gather_keep_heaviest(i_nearest, footprints, surfaces, &p, &one);
    one.id = surfaces[i_nearest].index;
    one.count = 1;
    s = one;
  }
  gather_finish(&frame, &p, &s, sums, PIXEL_PLANES_PASSED);
}
