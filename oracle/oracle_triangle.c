/* A triangle at a pixel: docs/reference/picture.md, Triangles. */
#include "oracle/oracle_triangle.h"

/* What a piece is at a sample. */
typedef struct sample {
  double share[3]; /* of the corners, on the screen */
  double iz, iz_error, steepness;
  int is_inside; /* of the piece as it is */
} sample;

static double edge(const oracle_triangle *t, int from, int to, double x, double y) {
  return (t->x[to] - t->x[from]) * (y - t->y[from]) - (x - t->x[from]) * (t->y[to] - t->y[from]);
}

/* A sample on an edge belongs to the triangle whose top or left edge it is. */
static int is_top_or_left(const oracle_triangle *t, int from, int to, double orientation) {
  double dx = (t->x[to] - t->x[from]) * orientation, dy = (t->y[to] - t->y[from]) * orientation;
  return dy < 0.0 || (dy == 0.0 && dx > 0.0);
}

/* How surely a piece covers a place: a corner that may be snapped to the next place moves edges by no more than that.
 */
typedef enum coverage { MISSES, MAY_COVER, COVERS } coverage;

static coverage cover(const oracle_triangle *t, double x, double y, sample *s) {
  double area = edge(t, 0, 1, t->x[2], t->y[2]), orientation = area > 0.0 ? 1.0 : -1.0, steepness = 0.0;
  double step = t->is_unsure ? 1.0 : 0.0;
  coverage found = COVERS;
  s->is_inside = 1;
  for (int k = 0; k < 3; k++) {
    int from = (k + 1) % 3, to = (k + 2) % 3;
    double e = edge(t, from, to, x, y) * orientation;
    double length = fabs(t->x[to] - t->x[from]) + fabs(t->y[to] - t->y[from]);
    double away = fabs(x - t->x[from]) + fabs(y - t->y[from]), error = step * 2.0 * (length + away + 2.0);
    if (e < -error)
      return MISSES;
    if (e < 0.0 || (e == 0.0 && !is_top_or_left(t, from, to, orientation)))
      s->is_inside = 0;
    if (t->is_unsure && e <= error)
      found = MAY_COVER;
    s->share[k] = e * orientation / area;
    steepness = oracle_max(steepness, 256.0 * length / fabs(area));
  }
  s->steepness = steepness; /* the most that a share changes from pixel to pixel */
  s->iz = 0.0;
  double least = oracle_min(t->iz[0], oracle_min(t->iz[1], t->iz[2]));
  double greatest = oracle_max(t->iz[0], oracle_max(t->iz[1], t->iz[2]));
  for (int k = 0; k < 3; k++)
    s->iz += s->share[k] * t->iz[k];
  s->iz = oracle_min(oracle_max(s->iz, least), greatest);
  /* Single precision rounds corners, a block's value and its gradient, no more than three pixels from there. */
  s->iz_error = ORACLE_ROUNDINGS * ORACLE_UNIT * (greatest + 3.0 * steepness * (greatest - least)) +
                step * 0.02 * steepness * (greatest - least) + t->depth_error * greatest;
  return s->is_inside || found == MAY_COVER ? found : MISSES;
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

/* Where the texture is at the pixel and how it lies in it: the derivatives by differences over a thousandth of it. */
typedef struct texel_place {
  float uv[2], sides[2][2];
} texel_place;

static texel_place find_texel(const conic_triangles *set, const oracle_triangle *t, double x, double y) {
  const uint32_t *corners = set->texture_corners ? set->texture_corners[t->index] : set->corners[t->index];
  const double step = 0.256;
  double at[2], low[2], high[2];
  texel_place found;
  find_weights(t, x, y, at);
  for (int i = 0; i < 2; i++)
    found.uv[i] = (float)blend_corners(set->texture_coordinate[i], corners, at);
  for (int side = 0; side < 2; side++) {
    find_weights(t, x - (side ? 0.0 : step), y - (side ? step : 0.0), low);
    find_weights(t, x + (side ? 0.0 : step), y + (side ? step : 0.0), high);
    for (int i = 0; i < 2; i++)
      found.sides[side][i] = (float)((blend_corners(set->texture_coordinate[i], corners, high) -
                                      blend_corners(set->texture_coordinate[i], corners, low)) *
                                     (256.0 / (2.0 * step)));
  }
  return found;
}

static const conic_texture *texture_of(const conic_triangles *set, const oracle_triangle *t) {
  if (!set->n_materials || !set->texture_coordinate[0])
    return NULL;
  return set->materials[set->material ? set->material[t->index] : 0].texture;
}

/* By how much any texel that a pixel may see differs from the one that is `error` texels off at most; infinite where
 * they are many. A filter reaches no farther than this from its middle: two thirds of its footprint are a texel of the
 * pyramid's level that it looks at. *largest is the greatest component of them all. */
static double find_texture_error(const conic_triangles *set, const oracle_triangle *t, double x, double y, double error,
                                 double *largest) {
  enum { MOST_TEXELS = 65536 };
  static const float no_side[2] = {0.0f, 0.0f};
  const conic_texture *texture = texture_of(set, t);
  const double size[2] = {conic_texture_width(texture), conic_texture_height(texture)};
  const texel_place at = find_texel(set, t, x, y);
  double low[2], high[2], widest = 0.0;
  float middle[3], color[3];
  *largest = 0.0;
  for (int i = 0; i < 2; i++) {
    double footprint = (fabs((double)at.sides[0][i]) + fabs((double)at.sides[1][i])) * size[i];
    double reach = 2.0 * error + 4.0 * footprint + 4.0, place = (double)at.uv[i] * size[i];
    low[i] = reach < 0.5 * size[i] ? floor(place - reach) : 0.0;
    high[i] = reach < 0.5 * size[i] ? place + reach : size[i];
  }
  if (!((high[0] - low[0] + 1.0) * (high[1] - low[1] + 1.0) < MOST_TEXELS))
    return INFINITY;
  conic_texture_sample(texture, at.uv, at.sides[0], at.sides[1], middle);
  for (double v = low[1]; v <= high[1]; v += 1.0)
    for (double u = low[0]; u <= high[0]; u += 1.0) {
      const float uv[2] = {(float)((u + 0.5) / size[0]), (float)((v + 0.5) / size[1])};
      conic_texture_sample(texture, uv, no_side, no_side, color);
      for (int c = 0; c < 3; c++) {
        widest = oracle_max(widest, fabs((double)color[c] - (double)middle[c]));
        *largest = oracle_max(*largest, fabs((double)color[c]));
      }
    }
  return widest;
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
  if (texture_of(set, t)) {
    const texel_place place = find_texel(set, t, x, y);
    float found[3];
    conic_texture_sample(material->texture, place.uv, place.sides[0], place.sides[1], found);
    for (int c = 0; c < 3; c++)
      texel[c] = (double)found[c];
  }
  for (int c = 0; c < 3; c++)
    color[c] *= (double)material->color[c] * texel[c];
}

/* The greatest component of the material's colour, and, with `corners`, of this times a corner's. */
static double greatest_factor(const conic_triangles *set, const oracle_triangle *t, int corners) {
  double greatest = 0.0;
  for (int c = 0; c < 3; c++)
    for (int k = 0; k < 3; k++) {
      double material =
          set->n_materials ? (double)set->materials[set->material ? set->material[t->index] : 0].color[c] : 1.0;
      double corner = corners && set->color[0] ? usable_color((double)set->color[c][set->corners[t->index][k]]) : 1.0;
      greatest = oracle_max(greatest, fabs(material * corner));
    }
  return greatest;
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

/* World, unit: on the side of the face that is seen, and mirrored along the ray where it leans away even so. Two
 * questions of sides are decided on the way, by the signs of `cosines`. The bits of `turned` name the questions that
 * are answered the other way. Returns the length of the corners' mean, 1 for a face's normal. */
static double find_shading_normal(const conic_triangles *set, const oracle_triangle *t, const conic_camera *camera,
                                  double x, double y, unsigned turned, double normal[3], double cosines[2]) {
  double at[2], ray[3] = {(x / 256.0 - camera->cx) / camera->fx, (y / 256.0 - camera->cy) / camera->fy, 1.0};
  double d[3], face[3], along = 1.0, mean_length = 1.0;
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
    if (squared > 1e-30 && squared < 1e30) {
      mean_length = sqrt(squared);
      for (int axis = 0; axis < 3; axis++)
        normal[axis] = (along < 0.0) != (turned & 1u) ? -mean[axis] : mean[axis];
    }
  }
  for (int axis = 0; axis < 3; axis++)
    d[axis] = camera->cam_from_world[0][axis] * ray[0] + camera->cam_from_world[1][axis] * ray[1] +
              camera->cam_from_world[2][axis] * ray[2];
  double behind = cosine_between(face, d);
  double scale = ((behind > 0.0) != (turned >> 1 & 1u) ? -1.0 : 1.0) / oracle_length(normal);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] *= scale;
  double away = oracle_dot(normal, d) / oracle_dot(d, d);
  for (int axis = 0; axis < 3 && away > 0.0; axis++)
    normal[axis] -= 2.0 * away * d[axis];
  cosines[0] = along;
  cosines[1] = behind;
  return mean_length;
}

/* The normal, and what its components may be where a side is in doubt, and by as much as its weights are off. */
static void find_normal_range(const conic_triangles *set, const oracle_triangle *t, const conic_camera *camera,
                              double x, double y, double error, oracle_splat *splat) {
  double cosines[2], mean = find_shading_normal(set, t, camera, x, y, 0, splat->normal, cosines);
  unsigned unsure = 0;
  for (int i = 0; i < 2; i++)
    if (!(fabs(cosines[i]) >= 4.0 * ORACLE_ROUNDINGS * ORACLE_UNIT))
      unsure |= 1u << i;
  splat->is_facing_unsure = unsure != 0;
  memcpy(splat->normals[0], splat->normal, sizeof splat->normal);
  memcpy(splat->normals[1], splat->normal, sizeof splat->normal);
  for (unsigned turned = 1; turned < 4; turned++) {
    double other[3], ignored[2];
    if (turned & ~unsure)
      continue;
    find_shading_normal(set, t, camera, x, y, turned, other, ignored);
    for (int axis = 0; axis < 3; axis++) {
      splat->normals[0][axis] = oracle_min(splat->normals[0][axis], other[axis]);
      splat->normals[1][axis] = oracle_max(splat->normals[1][axis], other[axis]);
    }
  }
  for (int axis = 0; axis < 3; axis++) { /* being mirrored trebles an error at most */
    splat->normals[0][axis] = oracle_max(splat->normals[0][axis] - 3.0 * error / mean, -1.0);
    splat->normals[1][axis] = oracle_min(splat->normals[1][axis] + 3.0 * error / mean, 1.0);
  }
}

/* The greatest difference of a component between corners. */
static double spread_of(float *const *values, int n_components, const uint32_t corners[3]) {
  double spread = 0.0;
  for (int c = 0; c < n_components; c++)
    for (int k = 0; k < 3; k++)
      spread = oracle_max(spread, fabs((double)values[c][corners[k]] - (double)values[c][corners[(k + 1) % 3]]));
  return spread;
}

/* What single precision makes of attributes: the weights of a sliver's corners change much from pixel to pixel. */
typedef struct attribute_errors {
  double color, normal, texture; /* of a component, the texel's left out; in texels */
} attribute_errors;

static attribute_errors find_attribute_errors(const conic_triangles *set, const oracle_triangle *t, const sample *s) {
  attribute_errors errors = {0.0, 0.0, 0.0};
  double greatest = oracle_max(t->iz[0], oracle_max(t->iz[1], t->iz[2]));
  double unit =
      ORACLE_ROUNDINGS * ORACLE_UNIT * (1.0 + 3.0 * s->steepness) + (t->is_unsure ? 0.02 * s->steepness : 0.0);
  double error = unit * greatest / s->iz;
  const uint32_t *corners = set->corners[t->index];
  if (set->color[0])
    errors.color = error * spread_of(set->color, 3, corners) * greatest_factor(set, t, 0);
  if (set->normal[0])
    errors.normal = error * spread_of(set->normal, 3, set->normal_corners ? set->normal_corners[t->index] : corners);
  if (!texture_of(set, t))
    return errors;
  const uint32_t *of_texture = set->texture_corners ? set->texture_corners[t->index] : corners;
  double texels = oracle_max(conic_texture_width(texture_of(set, t)), conic_texture_height(texture_of(set, t)));
  errors.texture = error * texels * spread_of(set->texture_coordinate, 2, of_texture);
  return errors;
}

/* Whether colour and normal are held to their bounds. */
static int is_precise(const attribute_errors *errors) {
  return errors->color < ORACLE_COLOR_BOUND && errors->normal < ORACLE_NORMAL_BOUND &&
         errors->texture < 10.0 * ORACLE_COLOR_BOUND;
}

/* A corner that is unsure may be a step farther out. */
static int is_in_piece_box(const oracle_triangle *t, double x, double y) {
  double step = t->is_unsure ? 1.0 : 0.0;
  return x >= t->box[0][0] - step && x <= t->box[1][0] + step && y >= t->box[0][1] - step && y <= t->box[1][1] + step;
}

/* The nearest sample of all pieces, the first of equals; *rival is the depth of the next. */
static const oracle_triangle *find_nearest(const oracle_mesh *mesh, const uint32_t *which, size_t n, double x, double y,
                                           sample *nearest, double *rival, unsigned *doubt) {
  const oracle_triangle *found = NULL;
  *rival = -INFINITY;
  for (size_t i = 0; i < n; i++) {
    const oracle_triangle *t = &mesh->pieces[which[i]];
    sample s;
    if (!is_in_piece_box(t, x, y))
      continue;
    *doubt |= t->is_unsure ? 1u << CONIC_UNSTABLE_CLIP : 0u;
    if (cover(t, x, y, &s) == MISSES || !s.is_inside)
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
                   1.0};
  attribute_errors errors = find_attribute_errors(mesh->triangles, t, s);
  memset(seen, 0, sizeof *seen);
  splat->index = mesh->first_id + t->index;
  splat->opacity = 1.0;
  splat->behind = 1.0 / (1.0 + mesh->epsilon * s->iz / oracle_length(ray));
  find_color(mesh->triangles, t, x, y, splat->color);
  find_normal_range(mesh->triangles, t, &view->camera, x, y, errors.normal, splat);
  splat->color_error = errors.color;
  if (!(errors.texture < 10.0 * ORACLE_COLOR_BOUND)) {
    double largest, error = find_texture_error(mesh->triangles, t, x, y, errors.texture, &largest);
    splat->color_error = errors.color * largest + greatest_factor(mesh->triangles, t, 1) * error;
  }
  seen->is_precise = is_precise(&errors);
  seen->candidate.splat = splat;
  seen->candidate.is_drawn = 1;
  seen->candidate.shape.range[0] = -INFINITY;
  seen->candidate.shape.range[1] = INFINITY;
  splat->placed.p[2] = NAN; /* no copy of any splat */
}

static void make_fragment(const sample *s, const oracle_seen_triangle *seen, oracle_fragment *fragment) {
  const double slack = ORACLE_ROUNDINGS * ORACLE_UNIT, behind = seen->splat.behind;
  double far_z = 1.0 / oracle_max(s->iz - s->iz_error, 1e-300), near_z = 1.0 / (s->iz + s->iz_error);
  memset(fragment, 0, sizeof *fragment);
  fragment->candidate = &seen->candidate;
  fragment->covers = 1;
  fragment->seen = (oracle_interval){s->iz - s->iz_error, s->iz, s->iz + s->iz_error};
  fragment->hides = (oracle_interval){(s->iz - s->iz_error) * behind * (1.0 - slack), s->iz * behind,
                                      (s->iz + s->iz_error) * behind * (1.0 + slack)};
  fragment->iz = s->iz;
  fragment->iz_error = s->iz_error;
  fragment->weight = 1.0;
  fragment->z = 1.0 / s->iz;
  fragment->z_error = s->iz_error / (s->iz * s->iz) + slack / s->iz;
  fragment->weights = (oracle_interval){1.0, 1.0, 1.0};
  fragment->nearness = fragment->seen;
  fragment->depths = (oracle_interval){near_z * (1.0 - slack), fragment->z, far_z * (1.0 + slack)};
}

int conic_oracle_mesh_at(const oracle_mesh *mesh, const oracle_view *view, const uint32_t *which, size_t n, int column,
                         int row, oracle_seen_triangle *seen, oracle_fragment *fragment, unsigned *doubt) {
  double x = 256.0 * column + 128.0, y = 256.0 * row + 128.0, rival;
  sample s = {.iz = 0.0};
  const oracle_triangle *t = find_nearest(mesh, which, n, x, y, &s, &rival, doubt);
  if (!t)
    return 0;
  look_at_piece(mesh, view, t, x, y, &s, seen);
  make_fragment(&s, seen, fragment);
  if (rival > s.iz - s.iz_error)
    *doubt |= 1u << CONIC_UNSTABLE_DEPTH_TIE;
  if (!seen->is_precise)
    *doubt |= 1u << CONIC_UNSTABLE_PRECISION;
  fragment->doubt = *doubt;
  return 1;
}

/* The inverse depth that a piece surely covers the place at; none where it may not. */
static double sure_depth(const oracle_mesh *mesh, const uint32_t *which, size_t n, double x, double y) {
  double nearest = -INFINITY;
  for (size_t i = 0; i < n; i++) {
    const oracle_triangle *t = &mesh->pieces[which[i]];
    sample s;
    if (is_in_piece_box(t, x, y) && cover(t, x, y, &s) == COVERS)
      nearest = oracle_max(nearest, s.iz - s.iz_error);
  }
  return nearest;
}

void conic_oracle_mesh_rivals(const oracle_mesh *mesh, const oracle_view *view, const uint32_t *which, size_t n,
                              int column, int row, oracle_rivals *rivals) {
  double x = 256.0 * column + 128.0, y = 256.0 * row + 128.0, nearest = sure_depth(mesh, which, n, x, y);
  rivals->n = rivals->is_crowded = 0;
  rivals->may_be_none = nearest == -INFINITY;
  for (size_t i = 0; i < n; i++) {
    const oracle_triangle *t = &mesh->pieces[which[i]];
    sample s;
    if (!is_in_piece_box(t, x, y) || cover(t, x, y, &s) == MISSES || s.iz + s.iz_error < nearest)
      continue;
    if (rivals->n == ORACLE_MAX_RIVALS) {
      rivals->is_crowded = 1;
      return;
    }
    look_at_piece(mesh, view, t, x, y, &s, &rivals->seen[rivals->n]);
    make_fragment(&s, &rivals->seen[rivals->n], &rivals->fragments[rivals->n]);
    rivals->n++;
  }
}
