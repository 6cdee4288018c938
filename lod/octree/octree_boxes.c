/* How an octree parts its points, as a picture (after Confetti's Fig. 17). */
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/coloring/color_ramp.h"
#include "core/image/image_common.h"
#include "lod/octree/octree_nodes.h"

/* Where the level is not said, there are no more nodes than that in it. */
enum { MOST_BOXES = 64 };

/* How much of a line shows that lies behind what is drawn, and by how much of its depth it may do so unseen. */
static const float hidden_share = 0.25f;
static const double hidden_by = 2e-3;

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

/* A line's end on the screen, and 1/z there. */
typedef struct line_end {
  double x, y, iz;
} line_end;

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

static line_end project(const conic_camera *camera, const double place[3]) {
  return (line_end){camera->fx * place[0] / place[2] + camera->cx, camera->fy * place[1] / place[2] + camera->cy,
                    1.0 / place[2]};
}

/* Of the line's share [t[0], t[1]], what is not below 0 where it goes from `begin` to `end`. */
static void clip_to_picture(double begin, double end, double t[2]) {
  double at = begin / (begin - end);
  if (begin < 0.0 && end < 0.0)
    t[1] = -1.0;
  else if (begin < 0.0)
    t[0] = at > t[0] ? at : t[0];
  else if (end < 0.0)
    t[1] = at < t[1] ? at : t[1];
}

static void paint_dot(const box_picture *p, double x, double y, double z, const float color[3]) {
  const conic_image *map = p->map;
  if (!(x >= 0.0 && x < map->width && y >= 0.0 && y < map->height))
    return;
  size_t i = (size_t)(int)y * (size_t)map->width + (size_t)(int)x;
  double drawn = (double)((const float *)p->image->planes[CONIC_PLANE_Z])[i];
  float share = drawn > 0.0 && drawn < z * (1.0 - hidden_by) ? hidden_share : 1.0f;
  float *pixel = (float *)map->planes[CONIC_PLANE_RGBA] + 4 * i;
  for (int c = 0; c < 4; c++)
    pixel[c] += ((c < 3 ? color[c] : 1.0f) - pixel[c]) * share;
}

/* A dot in each column or row that the line goes through, by which of both it goes faster. */
static void paint_line(const box_picture *p, const double begin[3], const double end[3], const float color[3]) {
  double t[2] = {0.0, 1.0}, ends[2][3];
  clip_to_picture(begin[2] - p->near_z, end[2] - p->near_z, t);
  if (!(t[0] < t[1]))
    return;
  for (int i = 0; i < 2; i++)
    for (int axis = 0; axis < 3; axis++)
      ends[i][axis] = begin[axis] + (end[axis] - begin[axis]) * t[i];
  line_end a = project(p->camera, ends[0]), b = project(p->camera, ends[1]);
  t[0] = 0.0;
  t[1] = 1.0;
  clip_to_picture(a.x, b.x, t);
  clip_to_picture(p->map->width - a.x, p->map->width - b.x, t);
  clip_to_picture(a.y, b.y, t);
  clip_to_picture(p->map->height - a.y, p->map->height - b.y, t);
  if (!(t[0] <= t[1]))
    return;
  double x = (b.x - a.x) * (t[1] - t[0]), y = (b.y - a.y) * (t[1] - t[0]);
  double longer = x * x > y * y ? x : y;
  int n = (int)(longer < 0.0 ? -longer : longer) + 1; /* within the picture, so that it fits */
  for (int i = 0; i < n; i++) {
    double at = t[0] + (t[1] - t[0]) * ((i + 0.5) / n);
    paint_dot(p, a.x + (b.x - a.x) * at, a.y + (b.y - a.y) * at, 1.0 / (a.iz + (b.iz - a.iz) * at), color);
  }
}

/* The box around the centres of a node's leaves. */
static void find_box(const conic_octree *octree, size_t i_node, double box[2][3]) {
  for (int axis = 0; axis < 3; axis++) {
    const float *position = octree->leaves.position[axis];
    float low = position[octree->first_leaf[i_node]], high = low;
    for (size_t k = octree->first_leaf[i_node]; k < octree->first_leaf[octree->end[i_node]]; k++) {
      low = position[k] < low ? position[k] : low;
      high = position[k] > high ? position[k] : high;
    }
    box[0][axis] = (double)low + octree->leaves.origin[axis];
    box[1][axis] = (double)high + octree->leaves.origin[axis];
  }
}

static void paint_box(const box_picture *p, size_t i_node) {
  double box[2][3], corners[8][3];
  float color[3];
  find_box(p->octree, i_node, box);
  conic_number_color((uint32_t)i_node, color);
  for (int i = 0; i < 8; i++)
    for (int row = 0; row < 3; row++) {
      const double *m = p->camera->cam_from_world[row];
      corners[i][row] = ((m[0] * box[i & 1][0] + m[1] * box[i >> 1 & 1][1]) + m[2] * box[i >> 2][2]) + m[3];
    }
  for (int i = 0; i < 8; i++)
    for (int bit = 1; bit < 8; bit *= 2)
      if (!(i & bit))
        paint_line(p, corners[i], corners[i | bit], color);
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
      paint_box(p, i);
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
  p.part_of_node = conic_memory_allocate(context, octree->n_nodes, sizeof *p.part_of_node);
  p.part_of_point = conic_memory_allocate(context, octree->n_points, sizeof *p.part_of_point);
  p.depth = conic_memory_allocate(context, octree->n_nodes, 1);
  status = p.part_of_node && p.part_of_point && p.depth ? paint_picture(&p) : CONIC_ERROR_MEMORY;
  conic_memory_release_these(context, p.part_of_node, p.part_of_point, p.depth);
  if (status != CONIC_OK)
    conic_image_release(context, map);
  return status;
}
