/* How an octree parts its points, as a picture (after Confetti's Fig. 17). */

#include "core/base/vectors.h"
#include "core/coloring/color_ramp.h"
#include "core/image/box_lines.h"
#include "core/image/image_common.h"
#include "lod/octree/octree_nodes.h"

/* Where the level is not said, there are no more nodes than that in it. */
enum { MOST_BOXES = 64 };

typedef struct box_picture {
  const conic_octree *octree;
  const conic_camera *camera;
  const conic_image *image;
  conic_image *map;
  double near_z;
  uint32_t *part_of_node, *part_of_point; /* the node of the level, or the last above it, that they are of */
  uint8_t *depth;                         /* of each node */
  int level;
} box_picture;

/* The depths of all nodes, which stand in preorder, and how many there are of each. */
static void find_depths(box_picture *p, size_t n_of_depth[CONIC_OCTREE_DEPTH]) {
  uint32_t ends[CONIC_OCTREE_DEPTH];
  int n = 0;
  for (size_t i = 0; i < p->octree->n_nodes; i++) {
    while (n > 0 && i >= ends[n - 1])
      n--;
    p->depth[i] = (uint8_t)n;
    n_of_depth[n]++;
    ends[n++] = p->octree->end[i];
  }
}

static int choose_level(const size_t n_of_depth[CONIC_OCTREE_DEPTH], int n_levels) {
  int level = 0;
  for (int i = 0; i < n_levels; i++)
    if (n_of_depth[i] <= MOST_BOXES)
      level = i;
  return level;
}

static void find_parts(box_picture *p) {
  const conic_octree *octree = p->octree;
  uint32_t parts[CONIC_OCTREE_DEPTH];
  memset(p->part_of_point, 0xFF, octree->n_points * sizeof *p->part_of_point); /* CONIC_NO_ID */
  for (size_t i = 0; i < octree->n_nodes; i++) {
    int depth = p->depth[i];
    parts[depth] = depth <= p->level ? (uint32_t)i : parts[depth - 1];
    p->part_of_node[i] = parts[depth];
    for (int k = 0; k < conic_octree_n_direct(octree, i); k++)
      p->part_of_point[octree->index[octree->first_leaf[i] + (size_t)k]] = parts[depth];
  }
}

/* What is drawn, as it is shaded, in the colour of its part. */
static void paint_parts(const box_picture *p) {
  const uint32_t *id = p->image->planes[CONIC_PLANE_ID];
  const float *from = p->image->planes[CONIC_PLANE_RGBA];
  float *to = p->map->planes[CONIC_PLANE_RGBA];
  size_t n_points = p->octree->n_points, n_all = n_points + p->octree->n_nodes;
  for (size_t i = 0; i < conic_image_pixels(p->image); i++, from += 4, to += 4) {
    uint32_t part = id[i] < n_points ? p->part_of_point[id[i]]
                    : id[i] < n_all  ? p->part_of_node[id[i] - n_points]
                                     : id[i];
    float color[3], light = (from[0] + from[1] + from[2]) / 3.0f;
    if (part == CONIC_NO_ID)
      continue;
    conic_number_color(part, color);
    for (int channel = 0; channel < 3; channel++)
      to[channel] = color[channel] * light;
    to[3] = from[3];
  }
}

/* The box around the centres of a node's leaves. */
static void find_box(const conic_octree *octree, size_t i_node, double box[2][3]) {
  for (int axis = 0; axis < 3; axis++) {
    const float *position = octree->leaves.position[axis];
    float low = position[octree->first_leaf[i_node]], high = low;
    for (size_t k = octree->first_leaf[i_node]; k < octree->first_leaf[octree->end[i_node]]; k++)
      CONIC_WIDEN(low, high, position[k], position[k]);
    box[0][axis] = (double)low + octree->leaves.origin[axis];
    box[1][axis] = (double)high + octree->leaves.origin[axis];
  }
}

static conic_status paint_picture(box_picture *p) {
  size_t n_of_depth[CONIC_OCTREE_DEPTH] = {0};
  conic_context *context = p->octree->context;
  conic_status status = CONIC_OK;
  find_depths(p, n_of_depth);
  if (p->level < 0)
    p->level = choose_level(n_of_depth, p->octree->n_levels);
  find_parts(p);
  paint_parts(p);
  for (size_t i = 0, n = 0; i < p->octree->n_nodes && status == CONIC_OK; i++)
    if (p->depth[i] == p->level) {
      if (n++ % 1024 == 0)
        status = conic_progress(context, "boxes", (double)i / (double)p->octree->n_nodes);
      double box[2][3];
      float color[3];
      find_box(p->octree, i, box);
      conic_number_color((uint32_t)i, color);
      conic_box_lines_paint(p->camera, p->near_z, p->image->planes[CONIC_PLANE_Z], p->map, (const double(*)[3])box,
                            color);
    }
  return status;
}

conic_status conic_octree_draw_boxes(const conic_octree *octree, const conic_camera *camera, int level,
                                     const conic_image *image, conic_image *map) {
  conic_context *context = octree->context;
  box_picture p = {octree, camera, image, map, conic_octree_near(octree), NULL, NULL, NULL, level};
  memset(map, 0, sizeof *map);
  if (!image->planes[CONIC_PLANE_RGBA] || !image->planes[CONIC_PLANE_Z] || !image->planes[CONIC_PLANE_ID] ||
      image->width != camera->width || image->height != camera->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "boxes: the image has not rgba, Z and id of that camera");
  conic_status status = conic_image_allocate(context, image->width, image->height, 1u << CONIC_PLANE_RGBA, map);
  if (status != CONIC_OK)
    return status;
  status =
      conic_memory_allocate_these(context, CONIC_ROOM(p.part_of_node, octree->n_nodes),
                                  CONIC_ROOM(p.part_of_point, octree->n_points), CONIC_ROOM(p.depth, octree->n_nodes));
  if (status == CONIC_OK)
    status = paint_picture(&p);
  conic_memory_release_these(context, p.part_of_node, p.part_of_point, p.depth);
  if (status != CONIC_OK)
    conic_image_release(context, map);
  return status;
}
