/* A triangle at a pixel: docs/reference/picture.md, Triangles. */
#include "oracle/oracle_triangle.h"

#include <string.h>

/* What a piece is at a sample. */
typedef struct sample {
  double share[3]; /* of the corners, on the screen */
  double iz, iz_error, steepness;
} sample;

static double edge(const oracle_triangle *t, int from, int to, double x, double y) {
  return (t->x[to] - t->x[from]) * (y - t->y[from]) - (x - t->x[from]) * (t->y[to] - t->y[from]);
}

/* A sample on an edge belongs to the triangle whose top or left edge it is. */
static int is_top_or_left(const oracle_triangle *t, int from, int to, double orientation) {
  double dx = (t->x[to] - t->x[from]) * orientation, dy = (t->y[to] - t->y[from]) * orientation;
  return dy < 0.0 || (dy == 0.0 && dx > 0.0);
}

static int cover(const oracle_triangle *t, double x, double y, sample *s) {
  double area = edge(t, 0, 1, t->x[2], t->y[2]), orientation = area > 0.0 ? 1.0 : -1.0, steepness = 0.0;
  for (int k = 0; k < 3; k++) {
    int from = (k + 1) % 3, to = (k + 2) % 3;
    double e = edge(t, from, to, x, y) * orientation;
    if (e < 0.0 || (e == 0.0 && !is_top_or_left(t, from, to, orientation)))
      return 0;
    s->share[k] = e * orientation / area;
    steepness = oracle_max(steepness, 256.0 * (fabs(t->x[to] - t->x[from]) + fabs(t->y[to] - t->y[from])) / fabs(area));
  }
  s->steepness = steepness; /* the most that a share changes from pixel to pixel */
  s->iz = 0.0;
  double least = oracle_min(t->iz[0], oracle_min(t->iz[1], t->iz[2]));
  double greatest = oracle_max(t->iz[0], oracle_max(t->iz[1], t->iz[2]));
  for (int k = 0; k < 3; k++)
    s->iz += s->share[k] * t->iz[k];
  /* Single precision rounds corners, a block's value and its gradient, no more than three pixels from there. */
  s->iz_error = ORACLE_ROUNDINGS * ORACLE_UNIT * (greatest + 3.0 * steepness * (greatest - least));
  return 1;
}

/* The attribute's component, from the weights of the second and third corner. */
static double blend_corners(const float *values, const uint32_t corners[3], const double at[2]) {
  double first = (double)values[corners[0]];
  return first + at[0] * ((double)values[corners[1]] - first) + at[1] * ((double)values[corners[2]] - first);
}

/* Weights of the triangle's second and third corner at a place of the screen: perspective-correct. */
static void find_weights(const oracle_triangle *t, double x, double y, double at[2]) {
  double area = edge(t, 0, 1, t->x[2], t->y[2]), share[3], sum = 0.0;
  at[0] = at[1] = 0.0;
  for (int k = 0; k < 3; k++) {
    share[k] = edge(t, (k + 1) % 3, (k + 2) % 3, x, y) / area * t->iz[k];
    sum += share[k];
  }
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 2; i++)
      at[i] += share[k] / sum * t->at[k][i];
}

/* How the texture lies in the pixel: the derivatives by differences over a thousandth of it. */
static void find_texel(const conic_triangles *set, const oracle_triangle *t, const conic_texture *texture, double x,
                       double y, double texel[3]) {
  const uint32_t *corners = set->texture_corners ? set->texture_corners[t->index] : set->corners[t->index];
  const double step = 0.256;
  double at[2], low[2], high[2];
  float uv[2], sides[2][2], color[3];
  find_weights(t, x, y, at);
  for (int i = 0; i < 2; i++)
    uv[i] = (float)blend_corners(set->texture_coordinate[i], corners, at);
  for (int side = 0; side < 2; side++) {
    find_weights(t, x - (side ? 0.0 : step), y - (side ? step : 0.0), low);
    find_weights(t, x + (side ? 0.0 : step), y + (side ? step : 0.0), high);
    for (int i = 0; i < 2; i++)
      sides[side][i] = (float)((blend_corners(set->texture_coordinate[i], corners, high) -
                                blend_corners(set->texture_coordinate[i], corners, low)) *
                               (256.0 / (2.0 * step)));
  }
  conic_texture_sample(texture, uv, sides[0], sides[1], color);
  for (int c = 0; c < 3; c++)
    texel[c] = (double)color[c];
}

static double usable_color(double color) {
  return fabs(color) <= 1e18 ? color : 0.0;
}

static void find_color(const conic_triangles *set, const oracle_triangle *t, double x, double y, double color[3]) {
  const uint32_t *corners = set->corners[t->index];
  double at[2], texel[3] = {1.0, 1.0, 1.0};
  find_weights(t, x, y, at);
  for (int c = 0; c < 3; c++) {
    double weights[3] = {1.0 - at[0] - at[1], at[0], at[1]};
    color[c] = set->color[0] ? 0.0 : 1.0;
    for (int k = 0; k < 3 && set->color[0]; k++)
      color[c] += weights[k] * usable_color((double)set->color[c][corners[k]]);
  }
  if (!set->n_materials)
    return;
  const conic_material *material = &set->materials[set->material ? set->material[t->index] : 0];
  if (material->texture && set->texture_coordinate[0])
    find_texel(set, t, material->texture, x, y, texel);
  for (int c = 0; c < 3; c++)
    color[c] *= (double)material->color[c] * texel[c];
}

static void normal_of_triangle(const conic_triangles *set, const uint32_t corners[3], double normal[3]) {
  double a[3], b[3];
  for (int axis = 0; axis < 3; axis++) {
    a[axis] = (double)set->position[axis][corners[1]] - (double)set->position[axis][corners[0]];
    b[axis] = (double)set->position[axis][corners[2]] - (double)set->position[axis][corners[0]];
  }
  oracle_cross(a, b, normal);
}

static double cosine_between(const double a[3], const double b[3]) {
  return oracle_dot(a, b) / (oracle_length(a) * oracle_length(b));
}

/* World, unit: on the side of the face that is seen, and mirrored along the ray where it leans away even so. *doubt is
 * the cosine by which the less certain of the two questions of sides was decided. */
static void find_shading_normal(const conic_triangles *set, const oracle_triangle *t, const conic_camera *camera,
                                double x, double y, double normal[3], double *doubt) {
  double at[2], ray[3] = {(x / 256.0 - camera->cx) / camera->fx, (y / 256.0 - camera->cy) / camera->fy, 1.0};
  double d[3], face[3], along = 1.0;
  normal_of_triangle(set, set->corners[t->index], face);
  if (!(oracle_length(face) > 0.0))
    for (int axis = 0; axis < 3; axis++)
      face[axis] = -camera->cam_from_world[2][axis];
  memcpy(normal, face, sizeof face);
  if (set->normal[0]) {
    const uint32_t *corners = set->normal_corners ? set->normal_corners[t->index] : set->corners[t->index];
    double mean[3], sum[3];
    find_weights(t, x, y, at);
    for (int axis = 0; axis < 3; axis++) {
      const float *component = set->normal[axis];
      mean[axis] = blend_corners(set->normal[axis], corners, at);
      sum[axis] = (double)component[corners[0]] + (double)component[corners[1]] + (double)component[corners[2]];
    }
    double squared = oracle_dot(mean, mean);
    along = cosine_between(sum, face);
    if (squared > 1e-30 && squared < 1e30)
      for (int axis = 0; axis < 3; axis++)
        normal[axis] = along < 0.0 ? -mean[axis] : mean[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    d[axis] = camera->cam_from_world[0][axis] * ray[0] + camera->cam_from_world[1][axis] * ray[1] +
              camera->cam_from_world[2][axis] * ray[2];
  double behind = cosine_between(face, d);
  double scale = (behind > 0.0 ? -1.0 : 1.0) / oracle_length(normal);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] *= scale;
  double away = oracle_dot(normal, d) / oracle_dot(d, d);
  for (int axis = 0; axis < 3 && away > 0.0; axis++)
    normal[axis] -= 2.0 * away * d[axis];
  *doubt = fabs(behind) < fabs(along) ? behind : along;
}

/* The greatest difference of a component between corners. */
static double spread_of(float *const *values, int n_components, const uint32_t corners[3]) {
  double spread = 0.0;
  for (int c = 0; c < n_components; c++)
    for (int k = 0; k < 3; k++)
      spread = oracle_max(spread, fabs((double)values[c][corners[k]] - (double)values[c][corners[(k + 1) % 3]]));
  return spread;
}

/* Whether single precision holds colour and normal to their bounds: the weights of a sliver's corners change much
 * from pixel to pixel. */
static int is_precise(const conic_triangles *set, const oracle_triangle *t, const sample *s) {
  double greatest = oracle_max(t->iz[0], oracle_max(t->iz[1], t->iz[2]));
  double error = ORACLE_ROUNDINGS * ORACLE_UNIT * (1.0 + 3.0 * s->steepness) * greatest / s->iz;
  const uint32_t *corners = set->corners[t->index];
  if (set->color[0] && !(error * spread_of(set->color, 3, corners) < ORACLE_COLOR_BOUND))
    return 0;
  const uint32_t *of_normals = set->normal_corners ? set->normal_corners[t->index] : corners;
  if (set->normal[0] && !(error * spread_of(set->normal, 3, of_normals) < ORACLE_NORMAL_BOUND))
    return 0;
  const conic_material *material =
      set->n_materials ? &set->materials[set->material ? set->material[t->index] : 0] : NULL;
  if (!material || !material->texture || !set->texture_coordinate[0])
    return 1;
  const uint32_t *of_texture = set->texture_corners ? set->texture_corners[t->index] : corners;
  double texels = oracle_max(conic_texture_width(material->texture), conic_texture_height(material->texture));
  return error * texels * spread_of(set->texture_coordinate, 2, of_texture) < 10.0 * ORACLE_COLOR_BOUND;
}

/* The nearest sample of all pieces, the first of equals; *rival is the depth of the next. */
static const oracle_triangle *find_nearest(const oracle_mesh *mesh, const uint32_t *which, size_t n, double x, double y,
                                           sample *nearest, double *rival, unsigned *doubt) {
  const oracle_triangle *found = NULL;
  *rival = -INFINITY;
  for (size_t i = 0; i < n; i++) {
    const oracle_triangle *t = &mesh->pieces[which[i]];
    sample s;
    if (x < t->box[0][0] || x > t->box[1][0] || y < t->box[0][1] || y > t->box[1][1])
      continue;
    *doubt |= t->is_unsure ? 1u << CONIC_UNSTABLE_CLIP : 0u;
    if (!cover(t, x, y, &s))
      continue;
    if (!found || s.iz > nearest->iz) {
      if (found)
        *rival = oracle_max(*rival, nearest->iz + nearest->iz_error);
      *nearest = s;
      found = t;
    } else
      *rival = oracle_max(*rival, s.iz + s.iz_error);
  }
  return found;
}

static void look_at_piece(const oracle_mesh *mesh, const oracle_view *view, const oracle_triangle *t, double x,
                          double y, const sample *s, oracle_seen_triangle *seen) {
  oracle_splat *splat = &seen->splat;
  double ray[3] = {(x / 256.0 - view->camera.cx) / view->camera.fx, (y / 256.0 - view->camera.cy) / view->camera.fy,
                   1.0},
         doubt;
  memset(seen, 0, sizeof *seen);
  splat->index = mesh->first_id + t->index;
  splat->opacity = 1.0;
  splat->behind = 1.0 / (1.0 + mesh->epsilon * s->iz / oracle_length(ray));
  find_color(mesh->triangles, t, x, y, splat->color);
  find_shading_normal(mesh->triangles, t, &view->camera, x, y, splat->normal, &doubt);
  splat->is_facing_unsure = !(fabs(doubt) >= 4.0 * ORACLE_ROUNDINGS * ORACLE_UNIT);
  seen->candidate.splat = splat;
  seen->candidate.is_drawn = 1;
  seen->candidate.shape.range[0] = -INFINITY;
  seen->candidate.shape.range[1] = INFINITY;
  splat->placed.p[2] = NAN; /* no copy of any splat */
}

int conic_oracle_mesh_at(const oracle_mesh *mesh, const oracle_view *view, const uint32_t *which, size_t n, int column,
                         int row, oracle_seen_triangle *seen, oracle_fragment *fragment) {
  double x = 256.0 * column + 128.0, y = 256.0 * row + 128.0, rival;
  unsigned doubt = 0;
  sample s = {.iz = 0.0};
  const oracle_triangle *t = find_nearest(mesh, which, n, x, y, &s, &rival, &doubt);
  if (!t)
    return 0;
  look_at_piece(mesh, view, t, x, y, &s, seen);
  memset(fragment, 0, sizeof *fragment);
  fragment->candidate = &seen->candidate;
  fragment->covers = 1;
  if (rival > s.iz - s.iz_error)
    doubt |= 1u << CONIC_UNSTABLE_DEPTH_TIE;
  if (!is_precise(mesh->triangles, t, &s))
    doubt |= 1u << CONIC_UNSTABLE_PRECISION;
  double slack = ORACLE_ROUNDINGS * ORACLE_UNIT, behind = seen->splat.behind;
  fragment->doubt = doubt;
  fragment->seen = (oracle_interval){s.iz - s.iz_error, s.iz, s.iz + s.iz_error};
  fragment->hides = (oracle_interval){(s.iz - s.iz_error) * behind * (1.0 - slack), s.iz * behind,
                                      (s.iz + s.iz_error) * behind * (1.0 + slack)};
  fragment->iz = s.iz;
  fragment->iz_error = s.iz_error;
  fragment->weight = 1.0;
  fragment->z = 1.0 / s.iz;
  fragment->z_error = s.iz_error / (s.iz * s.iz) + slack / s.iz;
  return 1;
}
