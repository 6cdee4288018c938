#include "lod/clusters/cluster_seen.h"

#include "core/base/color.h"
#include "core/base/vectors.h"

/* A face is looked at in no more pieces of its sides. */
enum { MOST_PIECES = 8 };

int conic_has_textures(const conic_triangles *t) {
  int is_any = 0;
  for (size_t i = 0; i < t->n_materials && t->texture_coordinate[0]; i++)
    is_any |= t->materials[i].texture != NULL;
  return is_any;
}

int conic_has_seen_colors(const conic_triangles *t) {
  return t->color[0] || conic_has_textures(t) || (t->n_materials > 1 && t->material);
}

static const conic_material *material_of(const conic_triangles *t, uint32_t material) {
  return t->n_materials == 0 ? NULL : &t->materials[material];
}

static const conic_texture *texture_of(const conic_triangles *t, uint32_t material) {
  const conic_material *m = material_of(t, material);
  return m && t->texture_coordinate[0] ? m->texture : NULL;
}

static void texture_coordinates(const conic_triangles *t, const conic_seen_place *place, double uv[2]) {
  for (int k = 0; k < 2; k++) {
    uv[k] = 0.0;
    for (int corner = 0; corner < 3; corner++)
      uv[k] += place->bary[corner] * (double)t->texture_coordinate[k][place->corners[corner]];
  }
}

void conic_seen_color(const conic_triangles *t, const conic_seen_place *place, double steps[3]) {
  const conic_material *material = material_of(t, place->material);
  const conic_texture *texture = texture_of(t, place->material);
  float texel[3] = {1.0f, 1.0f, 1.0f};
  double color[3];
  if (texture) {
    static const float point[2] = {0.0f, 0.0f};
    double at[2];
    texture_coordinates(t, place, at);
    const float uv[2] = {(float)at[0], (float)at[1]};
    conic_texture_sample(texture, uv, point, point, texel);
  }
  for (int channel = 0; channel < 3; channel++) {
    color[channel] = (double)texel[channel] * (material ? (double)material->color[channel] : 1.0);
    double own = t->color[0] ? 0.0 : 1.0;
    for (int corner = 0; corner < 3 && t->color[0]; corner++)
      own += place->bary[corner] * (double)t->color[channel][place->corners[corner]];
    color[channel] *= own;
  }
  conic_oklab_of(color, steps);
  for (int k = 0; k < 3; k++)
    steps[k] *= CONIC_SEEN_STEPS;
}

/* Into how many pieces a face's sides are parted, so that its texels are seen. */
static int pieces_of(const conic_triangles *t, const conic_texture *texture, const uint32_t corners[3]) {
  const double size[2] = {(double)conic_texture_width(texture), (double)conic_texture_height(texture)};
  double most = 1.0;
  for (int corner = 0; corner < 3; corner++)
    for (int k = 0; k < 2; k++) {
      const float *values = t->texture_coordinate[k];
      double way = fabs((double)values[corners[corner]] - (double)values[corners[(corner + 1) % 3]]) * size[k];
      most = way > most ? way : most;
    }
  return most < (double)MOST_PIECES ? (int)ceil(most) : MOST_PIECES;
}

double conic_seen_contrast(const conic_triangles *t, size_t face) {
  conic_seen_place place = {.material = t->material ? t->material[face] : 0};
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, sides[3];
  const conic_texture *texture = texture_of(t, place.material);
  memcpy(place.corners, t->corners[face], sizeof place.corners);
  int n = texture ? pieces_of(t, texture, place.corners) : 1;
  for (int i = 0; i <= n; i++)
    for (int j = 0; j <= n - i; j++) {
      double steps[3];
      place.bary[0] = (double)(n - i - j) / (double)n;
      place.bary[1] = (double)i / (double)n;
      place.bary[2] = (double)j / (double)n;
      conic_seen_color(t, &place, steps);
      conic_widen_box(low, high, steps);
    }
  conic_subtract(high, low, sides);
  return conic_length(sides);
}

/* A triangle of the mesh's vertices: two sides, and its size, the root of twice its area. */
typedef struct textured_frame {
  double sides[2][3], steps[2][2], size;
} textured_frame;

static textured_frame textured_frame_of(const conic_triangles *t, const uint32_t corners[3]) {
  textured_frame f;
  double cross[3];
  for (int i = 0; i < 2; i++) {
    for (int axis = 0; axis < 3; axis++)
      f.sides[i][axis] = (double)t->position[axis][corners[i + 1]] - (double)t->position[axis][corners[0]];
    for (int k = 0; k < 2 && t->texture_coordinate[0]; k++)
      f.steps[i][k] = (double)t->texture_coordinate[k][corners[i + 1]] - (double)t->texture_coordinate[k][corners[0]];
  }
  conic_cross(f.sides[0], f.sides[1], cross);
  f.size = sqrt(conic_length(cross));
  return f;
}

/* How long a way in texture coordinates is on the triangle; infinite where it has no such coordinates. */
static double length_of(const textured_frame *f, const double way[2]) {
  double determinant = f->steps[0][0] * f->steps[1][1] - f->steps[0][1] * f->steps[1][0], along[3];
  double a = (way[0] * f->steps[1][1] - way[1] * f->steps[1][0]) / determinant;
  double b = (way[1] * f->steps[0][0] - way[0] * f->steps[0][1]) / determinant;
  for (int axis = 0; axis < 3; axis++)
    along[axis] = a * f->sides[0][axis] + b * f->sides[1][axis];
  double length = conic_length(along);
  return length < HUGE_VAL ? length : HUGE_VAL;
}

static double texel_length(const textured_frame *f, const conic_texture *texture) {
  const double ways[2][2] = {{1.0 / (double)conic_texture_width(texture), 0.0},
                             {0.0, 1.0 / (double)conic_texture_height(texture)}};
  double a = length_of(f, ways[0]), b = length_of(f, ways[1]);
  return a < b ? a : b;
}

static double steps_between(const conic_triangles *t, const conic_seen_place *before, const conic_seen_place *now) {
  double colors[2][3], way[3];
  conic_seen_color(t, before, colors[0]);
  conic_seen_color(t, now, colors[1]);
  conic_subtract(colors[1], colors[0], way);
  return conic_length(way);
}

/* Where a texture alone has slid within a triangle, nobody needs to look at its texels. */
conic_seen_change conic_seen_change_of(const conic_triangles *t, const conic_seen_place *before, double contrast,
                                       const conic_seen_place *now) {
  const conic_texture *texture = texture_of(t, now->material);
  textured_frame f = textured_frame_of(t, now->corners);
  int is_slid = texture && before->material == now->material;
  double slide[2] = {0.0, 0.0}, length = HUGE_VAL;
  if (is_slid) {
    double at[2][2];
    texture_coordinates(t, before, at[0]);
    texture_coordinates(t, now, at[1]);
    for (int k = 0; k < 2; k++)
      slide[k] = at[1][k] - at[0][k];
    length = length_of(&f, slide);
  }
  int is_looked_at = t->color[0] || !(length <= f.size);
  double steps = is_looked_at ? steps_between(t, before, now) : 0.0, over = is_looked_at ? f.size : length;
  if (!is_slid)
    return (conic_seen_change){steps, steps * f.size};
  double texel = texel_length(&f, texture), along_edges = length < texel ? contrast * length / texel : contrast;
  steps = along_edges > steps ? along_edges : steps;
  return (conic_seen_change){steps, (steps > contrast ? steps : contrast) * over};
}

/* The place of a side that is nearest, as a share of it. */
static double nearest_on_side(const double at[3], const double a[3], const double b[3], double *share) {
  double side[3], way[3], off = 0.0;
  conic_subtract(b, a, side);
  conic_subtract(at, a, way);
  double length2 = conic_dot(side, side), t = length2 > 0.0 ? conic_dot(way, side) / length2 : 0.0;
  *share = t > 0.0 ? t < 1.0 ? t : 1.0 : 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double d = way[axis] - *share * side[axis];
    off += d * d;
  }
  return off;
}

double conic_seen_nearest(const double at[3], const double *const corners[3], double bary[3]) {
  double ab[3], ac[3], way[3], normal[3], cross[3], least2 = HUGE_VAL;
  conic_subtract(corners[1], corners[0], ab);
  conic_subtract(corners[2], corners[0], ac);
  conic_subtract(at, corners[0], way);
  conic_cross(ab, ac, normal);
  double square = conic_dot(normal, normal);
  conic_cross(way, ac, cross);
  bary[1] = conic_dot(cross, normal) / square;
  conic_cross(ab, way, cross);
  bary[2] = conic_dot(cross, normal) / square;
  bary[0] = 1.0 - bary[1] - bary[2];
  if (bary[0] >= 0.0 && bary[1] >= 0.0 && bary[2] >= 0.0) {
    double height = conic_dot(way, normal);
    return height * height / square;
  }
  for (int k = 0; k < 3; k++) {
    double share, distance2 = nearest_on_side(at, corners[k], corners[(k + 1) % 3], &share);
    if (!(distance2 < least2))
      continue;
    least2 = distance2;
    bary[k] = 1.0 - share;
    bary[(k + 1) % 3] = share;
    bary[(k + 2) % 3] = 0.0;
  }
  return least2;
}
