/* What is chosen: everything once, in a stable order, with the error that was asked for; budgets against brute force;
 * and error 0 draws the very picture of the splats. */
#include "core/base/vectors.h"
#include "lod/octree/octree_view.h"
#include "tests/support/octree_fixture.h"

/* The leaves that an id stands for. */
static void leaves_of(const conic_octree *octree, uint32_t id, const uint32_t *leaf_of_index, size_t *begin,
                      size_t *end) {
  if (id < octree->n_points) {
    *begin = leaf_of_index[id];
    *end = *begin + 1;
    return;
  }
  *begin = octree->first_leaf[id - octree->n_points];
  *end = octree->first_leaf[octree->end[id - octree->n_points]];
}

static uint32_t *invert(const conic_octree *octree) {
  uint32_t *leaf_of_index = calloc(octree->n_points, sizeof *leaf_of_index);
  if (!leaf_of_index)
    exit(1);
  for (size_t k = 0; k < octree->leaves.count; k++)
    leaf_of_index[octree->index[k]] = (uint32_t)k;
  return leaf_of_index;
}

/* In the camera's pixels; 0 where the point is not before near. */
static int project(const conic_camera *camera, const double p[3], double near_z, double pixel[2]) {
  double q[3];
  for (int row = 0; row < 3; row++) {
    const double *m = camera->cam_from_world[row];
    q[row] = m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + m[3];
  }
  pixel[0] = camera->cx + camera->fx * q[0] / q[2];
  pixel[1] = camera->cy + camera->fy * q[1] / q[2];
  return q[2] > near_z;
}

/* Every leaf that can be seen is stood for, once, in order; what is missing is outside the picture. */
static void check_cover(const conic_octree *octree, const fixture *f, const conic_selection *selection) {
  uint32_t *leaf_of_index = invert(octree);
  size_t next = 0, n_lost = 0, n_inner = 0;
  for (size_t k = 0; k < selection->splats.count; k++) {
    size_t begin, end;
    leaves_of(octree, selection->ids[k], leaf_of_index, &begin, &end);
    CHECK(begin >= next); /* the order of the hierarchy, nothing twice */
    n_inner += selection->ids[k] >= octree->n_points;
    for (; next < begin; next++) {
      double p[3], pixel[2];
      conic_vector_at(octree->leaves.position, next, p);
      if (project(&f->camera, p, 0.0, pixel) && pixel[0] > 0.0 && pixel[1] > 0.0 && pixel[0] < f->camera.width &&
          pixel[1] < f->camera.height)
        n_lost++;
    }
    next = end;
  }
  CHECK(n_lost == 0);
  CHECK(n_inner == selection->n_inner);
  free(leaf_of_index);
}

/* Points of a disc's outline and inside. */
static void disc_point(const float p[3], const float u[3], const float v[3], int i, double point[3]) {
  double angle = i % 8 * 3.14159265358979 / 4.0, r = 1.5 * (1.0 - (i / 8) * 0.5);
  for (int axis = 0; axis < 3; axis++)
    point[axis] = (double)p[axis] + r * (cos(angle) * (double)u[axis] + sin(angle) * (double)v[axis]);
}

static void leaf_values(const conic_octree *octree, size_t k, float p[3], float u[3], float v[3]) {
  for (int axis = 0; axis < 3; axis++) {
    p[axis] = octree->leaves.position[axis][k];
    u[axis] = octree->leaves.tangent_u[axis][k];
    v[axis] = octree->leaves.tangent_v[axis][k];
  }
}

/* The farthest on the screen that a point of a leaf's disc is from the nearest of the node's; of those tried, so it
 * comes out a little too large. The other way round test_octree_build.c looks in space. */
static double displacement(const conic_octree *octree, const fixture *f, size_t i_node, double near_z) {
  enum { N_POINTS = 24 };
  const conic_drawn_node *node = &octree->drawn[i_node];
  size_t begin = octree->first_leaf[i_node], end = octree->first_leaf[octree->end[i_node]];
  double farthest = 0.0, own[2000][2];
  int n = 0;
  for (int r = 0; r < 24; r++)
    for (int k = 0; k < 80; k++) {
      double point[3], angle = k * 3.14159265358979 / 40.0, radius = 1.5 * r / 23.0;
      for (int axis = 0; axis < 3; axis++)
        point[axis] = (double)node->position[axis] + radius * (cos(angle) * (double)node->tangent_u[axis] +
                                                               sin(angle) * (double)node->tangent_v[axis]);
      n += project(&f->camera, point, near_z, own[n]);
    }
  for (size_t k = begin; k < end; k++) {
    float p[3], u[3], v[3];
    leaf_values(octree, k, p, u, v);
    for (int i = 0; i < N_POINTS; i++) {
      double point[3], pixel[2], nearest2 = HUGE_VAL;
      disc_point(p, u, v, i, point);
      if (!project(&f->camera, point, near_z, pixel))
        continue;
      for (int j = 0; j < n; j++) {
        double x = pixel[0] - own[j][0], y = pixel[1] - own[j][1], distance2 = x * x + y * y;
        nearest2 = distance2 < nearest2 ? distance2 : nearest2;
      }
      farthest = fmax(farthest, sqrt(nearest2));
    }
  }
  return farthest;
}

static void test_error(conic_scene_type type, double zoom) {
  fixture f = fixture_open(2);
  conic_selection selection = {0};
  fixture_scene(&f, type, 20000);
  octree_frame(&f, 256, 40, 25, zoom);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  double near_z = conic_octree_near(octree);
  size_t before = 0;
  for (double error_px = 16.0; error_px > 0.3; error_px *= 0.5) {
    octree_select(octree, &f, error_px, 0, &selection);
    check_cover(octree, &f, &selection);
    CHECK(selection.splats.count >= before); /* finer */
    before = selection.splats.count;
    for (size_t k = 0; k < selection.splats.count; k += 7)
      if (selection.ids[k] >= octree->n_points) {
        double measured = displacement(octree, &f, selection.ids[k] - octree->n_points, near_z);
        CHECK(measured <= error_px * 1.05 + 0.1); /* the points tried are a 16th of the disc apart */
      }
  }
  conic_selection_release(f.context, &selection);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* The budget's answer against every error that changes anything. */
static void test_budget(int cull_back, double zoom) {
  enum { N = 3000 };
  fixture f = fixture_open(2);
  conic_selection selection = {0}, other = {0};
  float pixels[N + CONIC_OCTREE_GROUP];
  fixture_scene(&f, CONIC_SCENE_KNOT, N);
  octree_frame(&f, 200, 10, 30, zoom);
  f.options.cull_back = cull_back;
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  conic_octree_view view;
  conic_octree_view_init(octree, &f.camera, &f.options, conic_octree_near(octree), &view);
  view.measure(octree, &view, 0, octree->n_nodes, pixels);
  for (uint64_t budget = 1; budget < 4000; budget += 1 + budget / 3) {
    octree_select(octree, &f, 0.0, budget, &selection);
    CHECK(selection.splats.count <= budget || selection.splats.count <= 1);
    size_t best = 0;
    double best_error = HUGE_VAL;
    for (size_t i = 0; i <= octree->n_nodes; i++) {
      double error_px = i < octree->n_nodes ? (double)pixels[i] : 1e-30;
      if (!(error_px > 0.0) || error_px > best_error || isinf(error_px))
        continue;
      octree_select(octree, &f, error_px, 0, &other);
      if (other.splats.count <= budget) {
        best_error = error_px;
        best = other.splats.count;
      }
    }
    if (isinf(best_error)) /* only a node of any size does */
      CHECK(isinf(selection.error_px));
    else
      CHECK(selection.splats.count == best && (selection.error_px == best_error || best_error == 1e-30));
  }
  conic_selection_release(f.context, &selection);
  conic_selection_release(f.context, &other);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* Threads, repetition and a file in between change nothing. */
static void test_stable(void) {
  fixture f = fixture_open(1), g = fixture_open(4);
  conic_selection a = {0}, b = {0};
  fixture_scene(&f, CONIC_SCENE_TERRAIN, 60000);
  octree_frame(&f, 300, 70, 40, 2.0);
  g.camera = f.camera;
  conic_octree *one = octree_build(f.context, &f.splats, 0), *four = octree_build(g.context, &f.splats, 0);
  for (double error_px = 8.0; error_px > 0.2; error_px *= 0.25) {
    octree_select(one, &f, error_px, 0, &a);
    octree_select(four, &g, error_px, 0, &b);
    octree_select(four, &g, error_px, 0, &b);
    CHECK(a.splats.count == b.splats.count && a.n_culled == b.n_culled && a.n_inner == b.n_inner);
    CHECK(memcmp(a.ids, b.ids, a.splats.count * sizeof *a.ids) == 0);
    for (int axis = 0; axis < 3; axis++)
      CHECK(memcmp(a.splats.tangent_u[axis], b.splats.tangent_u[axis], a.splats.count * sizeof(float)) == 0);
    CHECK(memcmp(a.splats.opacity, b.splats.opacity, a.splats.count * sizeof(float)) == 0);
  }
  CHECK(a.n_culled > 0);
  conic_selection_release(f.context, &a);
  conic_selection_release(g.context, &b);
  conic_octree_destroy(one);
  conic_octree_destroy(four);
  fixture_close(&f);
  fixture_close(&g);
}

/* With an error below every node's, exactly the leaves are drawn: the same picture, but for the order of sums. Culled
 * subtrees take nothing away, in front, at the sides, behind or facing away. */
static void test_cull(double zoom, int cull_back) {
  fixture f = fixture_open(2);
  conic_selection selection = {0};
  conic_image whole;
  fixture_scene(&f, CONIC_SCENE_KNOT, 30000);
  octree_frame(&f, 200, 15, -20, zoom);
  if (zoom > 50.0) /* among the splats, some behind */
    f.camera.cam_from_world[2][3] -= 3.3;
  f.options.cull_back = cull_back;
  fixture_render(&f);
  whole = f.image;
  memset(&f.image, 0, sizeof f.image);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  octree_select(octree, &f, 1e-20, 0, &selection);
  CHECK(selection.n_inner == 0);
  octree_draw(&f, octree, &selection);
  size_t n_different = 0, n_other_ids = 0;
  for (size_t i = 0; i < (size_t)(200 * 200); i++) {
    for (size_t channel = 4 * i; channel < 4 * i + 4; channel++) {
      float apart =
          ((float *)whole.planes[CONIC_PLANE_RGBA])[channel] - ((float *)f.image.planes[CONIC_PLANE_RGBA])[channel];
      n_different += fabsf(apart) < 1e-5f ? 0 : 1;
    }
    n_other_ids += ((uint32_t *)whole.planes[CONIC_PLANE_ID])[i] != ((uint32_t *)f.image.planes[CONIC_PLANE_ID])[i];
  }
  CHECK(n_different == 0);
  CHECK(n_other_ids <= 4); /* of splats at one depth the first in the hierarchy, not in the input */
  if (zoom > 2.0 || cull_back)
    CHECK(selection.n_culled > 0 && selection.splats.count < 28000);
  conic_image_release(f.context, &whole);
  conic_selection_release(f.context, &selection);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

/* Error 0 is the input itself, bit for bit in every plane, through a file too. */
static void test_zero(void) {
  fixture f = fixture_open(2);
  char path[] = "/tmp/conic-test-octree-XXXXXX";
  int descriptor = mkstemp(path);
  uint64_t hashes[CONIC_N_DRAWN_PLANES];
  conic_octree *octree;
  conic_splats leaves;
  CHECK(descriptor >= 0);
  fixture_scene(&f, CONIC_SCENE_GYROID, 40000);
  f.splats.origin[0] = 500000.0;
  f.splats.position[0][77] = NAN;
  octree_frame(&f, 256, 33, 21, 1.3);
  fixture_render(&f);
  conic_render_statistics statistics = f.statistics;
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    hashes[plane] = conic_image_hash(&f.image, (conic_plane)plane);
  octree = octree_build(f.context, &f.splats, 0);
  CHECK_OK(conic_octree_write(octree, path));
  conic_octree_destroy(octree);
  CHECK_OK(conic_octree_read(f.context, path, &octree));
  CHECK_OK(conic_octree_leaves(octree, &leaves));
  conic_octree_destroy(octree);
  conic_splats_release(f.context, &f.splats);
  f.splats = leaves;
  fixture_render(&f);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    CHECK(conic_image_hash(&f.image, (conic_plane)plane) == hashes[plane]);
  CHECK(statistics.splats_skipped == f.statistics.splats_skipped && statistics.near_z == f.statistics.near_z);
  remove(path);
  fixture_close(&f);
}

/* Where a line crosses the first splat's outline it is as far along in the rounded one's terms: the points at which
 * the line is 0 stay so to the rounding of places (3e-4 of a box), normals and axes. */
static void check_rounded_clips(const conic_splats *splats, const conic_splats *rounded) {
  CHECK(rounded->count == splats->count && rounded->n_clips == splats->n_clips);
  for (size_t k = 0; k < rounded->n_clips; k++) {
    uint32_t i = rounded->clips[k].splat;
    const float *line = splats->clips[k].lines[0], *moved = rounded->clips[k].lines[0];
    CHECK(i == splats->clips[k].splat && rounded->clips[k].n_lines == 1);
    double square = (double)(line[0] * line[0] + line[1] * line[1]);
    for (int side = -1; side <= 1; side++) { /* points on the line: its nearest to the centre, and others */
      double u = -(double)(line[2] * line[0]) / square - side * (double)line[1];
      double v = -(double)(line[2] * line[1]) / square + side * (double)line[0], uu = 0.0, vv = 0.0, along[2] = {0, 0};
      for (int axis = 0; axis < 3; axis++) {
        double place = (double)splats->position[axis][i] + u * (double)splats->tangent_u[axis][i] +
                       v * (double)splats->tangent_v[axis][i] - (double)rounded->position[axis][i];
        double u_axis = (double)rounded->tangent_u[axis][i], v_axis = (double)rounded->tangent_v[axis][i];
        along[0] += place * u_axis;
        along[1] += place * v_axis;
        uu += u_axis * u_axis;
        vv += v_axis * v_axis;
      }
      double value = (double)moved[0] * along[0] / uu + (double)moved[1] * along[1] / vv + (double)moved[2];
      CHECK_NEAR(value / hypot((double)moved[0], (double)moved[1]), 0.0, 2e-3);
    }
  }
}

/* Clip lines go with their splats: through a file, in error 0 and in what is chosen. */
static void test_clips(void) {
  enum { N = 400 };
  fixture f = fixture_open(2);
  conic_selection selection = {0};
  char path[] = "/tmp/conic-test-octree-XXXXXX";
  conic_splats splats, leaves;
  conic_octree *octree;
  conic_octree_options options;
  CHECK(mkstemp(path) >= 0);
  fixture_scene(&f, CONIC_SCENE_TORUS, N);
  CHECK_OK(
      conic_splats_allocate(f.context, N, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_CLIPS, &splats));
  for (int axis = 0; axis < 3; axis++) {
    memcpy(splats.position[axis], f.splats.position[axis], N * sizeof(float));
    memcpy(splats.tangent_u[axis], f.splats.tangent_u[axis], N * sizeof(float));
    memcpy(splats.tangent_v[axis], f.splats.tangent_v[axis], N * sizeof(float));
    memcpy(splats.color[axis], f.splats.color[axis], N * sizeof(float));
  }
  for (uint32_t i = 0; i < N; i += 3)
    splats.clips[splats.n_clips++] =
        (conic_clip){.splat = i, .n_lines = 1, .operation = 0, .lines = {{1.0f, 0.5f, 0.1f * (float)(i % 7)}}};
  conic_splats_release(f.context, &f.splats);
  f.splats = splats;
  octree_frame(&f, 200, 20, 30, 1.0);
  fixture_render(&f);
  uint64_t hash = conic_image_hash(&f.image, CONIC_PLANE_RGBA);
  octree = octree_build(f.context, &f.splats, 0);
  CHECK_OK(conic_octree_write(octree, path));
  conic_octree_destroy(octree);
  CHECK_OK(conic_octree_read(f.context, path, &octree));
  octree_select(octree, &f, 1e-20, 0, &selection);
  CHECK(selection.splats.count == N && selection.splats.n_clips == f.splats.n_clips);
  for (size_t i = 0; i < selection.splats.n_clips; i++) {
    const conic_clip *clip = &selection.splats.clips[i];
    uint32_t id = selection.ids[clip->splat];
    CHECK(id % 3 == 0 && clip->lines[0][2] == 0.1f * (float)(id % 7));
    CHECK(i == 0 || clip->splat > clip[-1].splat);
  }
  octree_select(octree, &f, 30.0, 0, &selection);
  CHECK(selection.splats.n_clips < f.splats.n_clips);
  CHECK_OK(conic_octree_leaves(octree, &leaves));
  conic_splats copy = octree_copy(f.context, &leaves);
  conic_splats_release(f.context, &f.splats);
  f.splats = leaves;
  fixture_render(&f);
  CHECK(conic_image_hash(&f.image, CONIC_PLANE_RGBA) == hash);
  conic_octree_destroy(octree);
  conic_octree_options_init(&options);
  options.quantize = 1;
  CHECK_OK(conic_octree_build(f.context, &copy, &options, &octree));
  CHECK_OK(conic_octree_write(octree, path));
  conic_octree_destroy(octree);
  CHECK_OK(conic_octree_read(f.context, path, &octree));
  CHECK_OK(conic_octree_leaves(octree, &leaves));
  check_rounded_clips(&f.splats, &leaves);
  conic_splats_release(f.context, &leaves);
  conic_octree_destroy(octree);
  conic_selection_release(f.context, &selection);
  remove(path);
  fixture_close(&f);
}

static void test_refusals(void) {
  fixture f = fixture_open(1);
  conic_selection selection = {0};
  conic_selection_options options;
  fixture_scene(&f, CONIC_SCENE_SPHERE, 100);
  octree_frame(&f, 64, 0, 0, 1);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  conic_selection_options_init(&options);
  options.error_px = 0.0;
  CHECK(conic_octree_select(octree, &f.camera, &f.options, &options, &selection) == CONIC_ERROR_ARGUMENT);
  options.error_px = NAN;
  CHECK(conic_octree_select(octree, &f.camera, &f.options, &options, &selection) == CONIC_ERROR_ARGUMENT);
  options.error_px = 1.0;
  f.options.kernel.cutoff = 3.0f;
  CHECK(conic_octree_select(octree, &f.camera, &f.options, &options, &selection) == CONIC_ERROR_ARGUMENT);
  conic_selection_release(f.context, &selection);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

int main(void) {
  test_error(CONIC_SCENE_SPHERE, 1.0);
  test_error(CONIC_SCENE_TERRAIN, 1.5);
  test_error(CONIC_SCENE_GYROID, 3.0);
  test_budget(0, 1.0);
  test_budget(0, 4.0);
  test_budget(1, 2.0);
  test_stable();
  for (int cull_back = 0; cull_back < 2; cull_back++) {
    test_cull(1.0, cull_back);
    test_cull(4.0, cull_back);
    test_cull(60.0, cull_back);
  }
  test_zero();
  test_clips();
  test_refusals();
  return check_result();
}
