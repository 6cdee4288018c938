/* The picture of an octree's boxes: what is drawn has the colour of its node, and lines go where the boxes' edges are.
 */
#include "core/coloring/color_ramp.h"
#include "tests/support/octree_fixture.h"

/* Small splats at the corners of cubes of side 2 about (-4, -4, 20) and (4, 4, 24); and, where that is asked for, a
 * large one that lies before the right one's middle. */
static void place_cubes(fixture *f, int has_cover) {
  const double u[3] = {0.01, 0, 0}, v[3] = {0, 0.01, 0}, large_u[3] = {1, 0, 0}, large_v[3] = {0, 1, 0};
  const double before[3] = {4.0, 4.0, 23.0};
  fixture_splats(f, has_cover ? 17 : 16);
  for (size_t i = 0; i < 16; i++) {
    double middle = i < 8 ? -4.0 : 4.0, depth = i < 8 ? 20.0 : 24.0;
    const double p[3] = {middle + (i & 1 ? 1.0 : -1.0), middle + (i & 2 ? 1.0 : -1.0), depth + (i & 4 ? 1.0 : -1.0)};
    fixture_set(f, i, p, u, v, 1.0f, 1.0f, 1.0f);
  }
  if (has_cover)
    fixture_set(f, 16, before, large_u, large_v, 0.5f, 0.5f, 0.5f);
  fixture_camera(f, 128, 96, 100.0);
  fixture_render(f);
}

static const float *pixel_at(const fixture *f, const conic_image *map, double x, double y, double z) {
  int column = (int)(f->camera.fx * x / z + f->camera.cx), row = (int)(f->camera.fy * y / z + f->camera.cy);
  return (const float *)map->planes[CONIC_PLANE_RGBA] + 4 * ((size_t)row * (size_t)map->width + (size_t)column);
}

/* The node below the root that has input point i. */
static uint32_t node_of(const conic_octree *octree, uint32_t i) {
  for (size_t node = 1; node < octree->n_nodes; node = octree->end[node])
    for (size_t k = octree->first_leaf[node]; k < octree->first_leaf[octree->end[node]]; k++)
      if (octree->index[k] == i)
        return (uint32_t)node;
  return 0;
}

static int has_color(const float *pixel, uint32_t number, float share) {
  float color[3];
  conic_number_color(number, color);
  for (int c = 0; c < 3; c++)
    if (fabsf(pixel[c] - share * color[c]) > 1e-5f)
      return 0;
  return fabsf(pixel[3] - share) < 1e-5f;
}

/* The lines of level 1 lie where the cubes' edges are, in their nodes' colours; those of the root around both. */
static void test_lines(void) {
  fixture f = fixture_open(1);
  conic_image map;
  place_cubes(&f, 0);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  uint32_t left = node_of(octree, 0), right = node_of(octree, 8);
  CHECK(left != right && left && right);
  CHECK_OK(conic_octree_draw_boxes(octree, &f.camera, 1, &f.image, &map));
  for (int side = -1; side <= 1; side += 2) {
    uint32_t node = side < 0 ? left : right;
    double middle = 4.0 * side, depth = 22.0 + 2.0 * side;
    CHECK(has_color(pixel_at(&f, &map, middle + 0.3, middle + 1.0, depth - 1.0), node, 1.0f));
    CHECK(has_color(pixel_at(&f, &map, middle + 1.0, middle + 0.3, depth + 1.0), node, 1.0f));
    CHECK(has_color(pixel_at(&f, &map, middle - 1.0, middle - 1.0, depth + 0.1), node, 1.0f));
    CHECK(pixel_at(&f, &map, middle, middle, depth - 1.0)[3] == 0.0f);
  }
  CHECK(pixel_at(&f, &map, 0.0, 5.0, 19.0)[3] == 0.0f);
  conic_image_release(f.context, &map);
  CHECK_OK(conic_octree_draw_boxes(octree, &f.camera, 0, &f.image, &map));
  CHECK(has_color(pixel_at(&f, &map, 0.0, 5.0, 19.0), 0, 1.0f));
  conic_image_release(f.context, &map);
  f.camera.width = 64;
  CHECK(conic_octree_draw_boxes(octree, &f.camera, 0, &f.image, &map) == CONIC_ERROR_ARGUMENT);
  CHECK(!map.planes[CONIC_PLANE_RGBA]);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* A line behind what is drawn shows by a quarter; what is drawn has its part's colour; a box around the eye is drawn as
 * far as it is before it. */
static void test_cover(void) {
  fixture f = fixture_open(1);
  conic_image map;
  place_cubes(&f, 1);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  CHECK_OK(conic_octree_draw_boxes(octree, &f.camera, 0, &f.image, &map));
  const float *front = pixel_at(&f, &map, 4.0, 4.2, 23.0), *behind = pixel_at(&f, &map, 5.0, 4.7, 25.0);
  float root[3];
  conic_number_color(0, root);
  for (int c = 0; c < 3; c++) {
    CHECK_NEAR((double)front[c], 0.5 * (double)root[c], 0.01);
    CHECK_NEAR((double)behind[c], (0.75 * 0.5 + 0.25) * (double)root[c], 0.01);
  }
  conic_image_release(f.context, &map);
  for (int axis = 0; axis < 3; axis++)
    f.camera.cam_from_world[axis][3] = axis == 2 ? -10.0 : 0.0;
  CHECK_OK(conic_octree_draw_boxes(octree, &f.camera, -1, &f.image, &map));
  conic_image_release(f.context, &map);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* Inner nodes that are drawn in place of their leaves have their part's colour too. */
static void test_nodes(void) {
  fixture f = fixture_open(1);
  conic_selection_options options;
  conic_selection selection = {0};
  conic_image map, leaves;
  fixture_scene(&f, CONIC_SCENE_SPHERE, 20000);
  octree_frame(&f, 64, 20.0, 10.0, 1.0);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  fixture_render(&f);
  CHECK_OK(conic_octree_draw_boxes(octree, &f.camera, 2, &f.image, &leaves));
  conic_selection_options_init(&options);
  options.error_px = 2.0;
  CHECK_OK(conic_octree_select(octree, &f.camera, &f.options, &options, &selection));
  conic_splats_release(f.context, &f.splats);
  CHECK_OK(conic_octree_leaves(octree, &f.splats));
  CHECK_OK(conic_render(f.renderer, &selection.splats, &f.camera, &f.options, &f.image, NULL));
  conic_selection_name(&selection, &f.image);
  CHECK_OK(conic_octree_draw_boxes(octree, &f.camera, 2, &f.image, &map));
  size_t n_same = 0, n_drawn = 0;
  for (size_t i = 0; i < 64 * 64; i++) {
    const float *a = (const float *)map.planes[CONIC_PLANE_RGBA] + 4 * i;
    const float *b = (const float *)leaves.planes[CONIC_PLANE_RGBA] + 4 * i;
    n_drawn += b[3] > 0.5f;
    n_same += b[3] > 0.5f && fabsf(a[0] * b[1] - a[1] * b[0]) < 0.02f && fabsf(a[0] * b[2] - a[2] * b[0]) < 0.02f;
  }
  CHECK(selection.n_inner > 0 && n_same > n_drawn * 3 / 4);
  conic_image_release(f.context, &map);
  conic_image_release(f.context, &leaves);
  conic_selection_release(f.context, &selection);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

int main(void) {
  test_lines();
  test_cover();
  test_nodes();
  return check_result();
}
