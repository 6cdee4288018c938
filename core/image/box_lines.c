#include "core/image/box_lines.h"

/* How much of a line shows that lies behind what is drawn, and by how much of its depth it may do so unseen. */
static const float hidden_share = 0.25f;
static const double hidden_by = 2e-3;

typedef struct box_lines {
  const conic_camera *camera;
  double near_z;
  const float *z;
  conic_image *map;
} box_lines;

/* A line's end on the screen, and 1/z there. */
typedef struct line_end {
  double x, y, iz;
} line_end;

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

static void paint_dot(const box_lines *p, double x, double y, double z, const float color[3]) {
  const conic_image *map = p->map;
  if (!(x >= 0.0 && x < map->width && y >= 0.0 && y < map->height))
    return;
  size_t i = (size_t)(int)y * (size_t)map->width + (size_t)(int)x;
  double drawn = (double)p->z[i];
  float share = drawn > 0.0 && drawn < z * (1.0 - hidden_by) ? hidden_share : 1.0f;
  float *pixel = (float *)map->planes[CONIC_PLANE_RGBA] + 4 * i;
  for (int c = 0; c < 4; c++)
    pixel[c] += ((c < 3 ? color[c] : 1.0f) - pixel[c]) * share;
}

/* A dot in each column or row that the line goes through, by which of both it goes faster. */
static void paint_line(const box_lines *p, const double begin[3], const double end[3], const float color[3]) {
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

void conic_box_lines_paint(const conic_camera *camera, double near_z, const float *z, conic_image *map,
                           const double box[2][3], const float color[3]) {
  const box_lines lines = {camera, near_z, z, map};
  double corners[8][3];
  for (int i = 0; i < 8; i++)
    for (int row = 0; row < 3; row++) {
      const double *m = camera->cam_from_world[row];
      corners[i][row] = ((m[0] * box[i & 1][0] + m[1] * box[i >> 1 & 1][1]) + m[2] * box[i >> 2][2]) + m[3];
    }
  for (int i = 0; i < 8; i++)
    for (int bit = 1; bit < 8; bit *= 2)
      if (!(i & bit))
        paint_line(&lines, corners[i], corners[i | bit], color);
}
