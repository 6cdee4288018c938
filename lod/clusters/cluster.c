#include "lod/clusters/cluster.h"

#include "core/base/vectors.h"

double conic_cluster_edge_length(const conic_clustered_mesh *mesh, uint32_t cluster) {
  size_t begin = mesh->starts[cluster], end = mesh->starts[cluster + 1];
  double sum = 0.0;
  for (size_t i = begin; i < end; i++)
    for (int corner = 0; corner < 3; corner++) {
      double a[3], b[3];
      conic_mesh_corner(&mesh->mesh, mesh->faces[i], corner, a);
      conic_mesh_corner(&mesh->mesh, mesh->faces[i], (corner + 1) % 3, b);
      for (int axis = 0; axis < 3; axis++)
        b[axis] -= a[axis];
      sum += conic_length(b);
    }
  return end > begin ? sum / (3.0 * (double)(end - begin)) : 0.0;
}

/* Two sides of a face, from its first corner. */
static void sides_of(const conic_clustered_mesh *mesh, uint32_t face, double sides[2][3]) {
  double first[3];
  conic_mesh_corner(&mesh->mesh, face, 0, first);
  for (int k = 0; k < 2; k++) {
    conic_mesh_corner(&mesh->mesh, face, k + 1, sides[k]);
    for (int axis = 0; axis < 3; axis++)
      sides[k][axis] -= first[axis];
  }
}

void conic_cluster_face_normal(const conic_clustered_mesh *mesh, uint32_t face, double normal[3]) {
  double sides[2][3];
  sides_of(mesh, face, sides);
  conic_cross(sides[0], sides[1], normal);
  double length = conic_length(normal);
  double factor = length > 0.0 ? (double)mesh->adjacency->side[face] / length : 0.0;
  for (int axis = 0; axis < 3; axis++)
    normal[axis] *= factor;
}

void conic_cluster_place(const conic_clustered_mesh *mesh, uint32_t face, const double bary[3], double place[3]) {
  for (int axis = 0; axis < 3; axis++) {
    const float *values = mesh->mesh.position[axis];
    const uint32_t *corners = mesh->mesh.faces[face];
    place[axis] = (bary[0] * (double)values[corners[0]] + bary[1] * (double)values[corners[1]]) +
                  bary[2] * (double)values[corners[2]];
  }
}

/* As the mesh is shaded: the unit normals' mean, or the face's own where one of them is none. */
void conic_cluster_normal(const conic_clustered_mesh *mesh, uint32_t face, const double bary[3], const double facing[3],
                          double normal[3]) {
  const conic_triangles *t = mesh->triangles;
  double sum[3] = {0.0, 0.0, 0.0};
  int is_good = 1;
  if (!t->normal[0]) {
    memcpy(normal, facing, 3 * sizeof *normal);
    return;
  }
  for (int corner = 0; corner < 3 && is_good; corner++) {
    uint32_t i = t->normal_corners ? t->normal_corners[face][corner] : t->corners[face][corner];
    const double n[3] = {(double)t->normal[0][i], (double)t->normal[1][i], (double)t->normal[2][i]};
    double length = conic_length(n);
    is_good = length > 0.0 && length - length == 0.0;
    for (int axis = 0; axis < 3 && is_good; axis++)
      sum[axis] += bary[corner] * n[axis] / length;
  }
  double length = conic_length(sum), along = conic_dot(sum, facing);
  is_good = is_good && length > 0.0;
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = !is_good ? facing[axis] : (along < 0.0 ? -sum[axis] : sum[axis]) / length;
}

static const conic_material *material_of(const conic_triangles *t, uint32_t face) {
  return t->n_materials == 0 ? NULL : &t->materials[t->material ? t->material[face] : 0];
}

void conic_cluster_color(const conic_clustered_mesh *mesh, uint32_t face, const double bary[3], double color[3]) {
  const conic_triangles *t = mesh->triangles;
  const conic_material *material = material_of(t, face);
  for (int channel = 0; channel < 3; channel++) {
    const float *values = t->color[channel];
    const uint32_t *corners = t->corners[face];
    color[channel] = !values ? 1.0
                             : (bary[0] * (double)values[corners[0]] + bary[1] * (double)values[corners[1]]) +
                                   bary[2] * (double)values[corners[2]];
    if (material)
      color[channel] *= (double)material->color[channel];
  }
}

void conic_cluster_texel(const conic_clustered_mesh *mesh, uint32_t face, const double bary[3], double side,
                         double color[3]) {
  const conic_triangles *t = mesh->triangles;
  const conic_material *material = material_of(t, face);
  color[0] = color[1] = color[2] = 1.0;
  if (!material || !material->texture || !t->texture_coordinate[0])
    return;
  double sides[2][3], at[2] = {0.0, 0.0}, steps[2][2];
  float uv[2], along[2], across[2], found[3];
  for (int k = 0; k < 2; k++) {
    double corner[3];
    for (int i = 0; i < 3; i++) {
      uint32_t index = t->texture_corners ? t->texture_corners[face][i] : t->corners[face][i];
      corner[i] = (double)t->texture_coordinate[k][index];
      at[k] += bary[i] * corner[i];
    }
    steps[0][k] = corner[1] - corner[0];
    steps[1][k] = corner[2] - corner[0];
  }
  /* In the face, x along the first side: the second is (x₁, y₁). A step of one along x or y in texture coordinates. */
  sides_of(mesh, face, sides);
  double x0 = conic_length(sides[0]), x1 = conic_dot(sides[0], sides[1]) / x0;
  double y2 = conic_dot(sides[1], sides[1]) - x1 * x1, y1 = y2 > 0.0 ? sqrt(y2) : 0.0;
  int has_area = x0 > 0.0 && y1 > 0.0;
  for (int k = 0; k < 2; k++) {
    double dx = has_area ? steps[0][k] / x0 : 0.0, dy = has_area ? (steps[1][k] - x1 * dx) / y1 : 0.0;
    uv[k] = (float)at[k];
    along[k] = (float)(side * dx);
    across[k] = (float)(side * dy);
  }
  conic_texture_sample(material->texture, uv, along, across, found);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = (double)found[channel];
}
