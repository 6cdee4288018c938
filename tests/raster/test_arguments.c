/* What the public functions refuse, and interleaved arrays. */
#include "tests/support/triangle_fixture.h"

enum { SIDE = 96, COUNT = 3000, FLOATS = 14 };

static conic_status draw(fixture *f, const conic_splats *splats, const conic_triangles *triangles) {
  const conic_drawing drawing = {.splats = splats, .triangles = triangles};
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &f->image));
  return conic_render_drawing(f->context, f->renderer, &drawing, &f->camera, &f->options, 1, &f->image, NULL);
}

static int same_pictures(const conic_image *image, const uint64_t hashes[CONIC_N_DRAWN_PLANES]) {
  for (int plane = 0; plane < (int)CONIC_N_DRAWN_PLANES; plane++)
    if (conic_image_hash(image, (conic_plane)plane) != hashes[plane])
      return 0;
  return 1;
}

static void keep_hashes(const conic_image *image, uint64_t hashes[CONIC_N_DRAWN_PLANES]) {
  for (int plane = 0; plane < (int)CONIC_N_DRAWN_PLANES; plane++)
    hashes[plane] = conic_image_hash(image, (conic_plane)plane);
}

/* Every public function that reads a set of splats. */
static void expect_everywhere(fixture *f, const conic_splats *splats, conic_status expected) {
  conic_reference reference;
  conic_contributions *contributions;
  conic_surface *surface;
  conic_patches *patches;
  conic_splats joined = {0};
  double length;
  CHECK(draw(f, splats, NULL) == expected);
  CHECK(conic_render(f->renderer, splats, &f->camera, &f->options, &f->image, NULL) == expected);
  CHECK(conic_render_samples(f->context, f->renderer, splats, &f->camera, &f->options, 2, &f->image, NULL) == expected);
  CHECK(conic_contributions_create(f->context, splats, &f->camera, &f->options, &contributions) == expected);
  conic_contributions_destroy(contributions);
  conic_camera whole = f->camera;
  f->camera.width = f->camera.height = 2;
  CHECK(conic_oracle_render(f->context, splats, &f->camera, &f->options, CONIC_ORACLE_METHOD, &reference) == expected);
  f->camera = whole;
  conic_reference_release(f->context, &reference);
  CHECK(conic_splats_append(f->context, &joined, splats) == expected);
  conic_splats_release(f->context, &joined);
  CHECK(conic_splats_length(f->context, splats, &length) == expected);
  CHECK(conic_splats_spacing(f->context, splats, &length) == expected);
  CHECK(conic_surface_create(f->context, splats, NULL, &surface) == expected);
  conic_surface_destroy(surface);
  CHECK(conic_patches_create(f->context, splats, NULL, &patches) == expected);
  conic_patches_destroy(patches);
  CHECK(conic_splats_write(f->context, "/dev/null/no.ply", splats, NULL) ==
        (expected == CONIC_OK ? CONIC_ERROR_IO : expected));
}

/* Those that change a set or take it over. */
static void expect_refused(fixture *f, conic_splats *splats) {
  const conic_splats before = *splats;
  conic_octree *octree;
  conic_octree_options options;
  conic_estimate_options estimate;
  conic_model model = {.points = *splats};
  conic_octree_options_init(&options);
  conic_estimate_options_init(&estimate);
  CHECK(conic_octree_build(f->context, splats, &options, &octree) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_splats_thin(f->context, splats, 7, 1) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_splats_append(f->context, splats, &f->splats) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_model_to_splats(f->context, &estimate, &model, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(memcmp(splats, &before, sizeof before) == 0);
}

static void test_broken_splats(fixture *f) {
  double low[3], high[3];
  for (int i = 0; i < 12; i++) {
    conic_splats broken = f->splats;
    float **arrays[] = {broken.position, broken.tangent_u, broken.tangent_v, broken.color};
    arrays[i / 3][i % 3] = NULL;
    expect_everywhere(f, &broken, CONIC_ERROR_ARGUMENT);
    expect_refused(f, &broken);
    CHECK(conic_splats_bounds(&broken, low, high) == 0 && conic_default_near(&broken) == 1e-4);
  }
  conic_splats one_axis = f->splats, lines = f->splats, later = f->splats, odd = f->splats;
  memset(one_axis.tangent_v, 0, sizeof one_axis.tangent_v);
  lines.n_clips = 1;
  later.reserved[1] = 1;
  odd.strides.color = 6;
  conic_splats *all[] = {&one_axis, &lines, &later, &odd};
  for (int i = 0; i < 4; i++) {
    expect_everywhere(f, all[i], CONIC_ERROR_ARGUMENT);
    expect_refused(f, all[i]);
  }
  CHECK(conic_render(f->renderer, NULL, &f->camera, &f->options, &f->image, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_render(f->renderer, &f->splats, NULL, &f->options, &f->image, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_render(f->renderer, &f->splats, &f->camera, NULL, &f->image, NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_render(f->renderer, &f->splats, &f->camera, &f->options, NULL, NULL) == CONIC_ERROR_ARGUMENT);
}

static void test_broken_triangles(fixture *f) {
  conic_triangles whole = triangles_torus(f, 12, 8, 0.4), more = triangles_torus(f, 4, 4, 0.2);
  conic_hybrid_options options;
  conic_hybrid *hybrid;
  double low[3], high[3];
  conic_hybrid_options_init(&options);
  for (int i = 0; i < 6; i++) {
    conic_triangles broken = whole;
    if (i < 3)
      broken.position[i] = NULL;
    else if (i == 3)
      broken.color[1] = whole.position[0];
    else if (i == 4)
      broken.corners = NULL;
    else
      broken.reserved[0] = 1;
    conic_triangles before = broken;
    CHECK(draw(f, NULL, &broken) == CONIC_ERROR_ARGUMENT);
    CHECK(conic_triangles_check(f->context, &broken, "broken") == CONIC_ERROR_ARGUMENT);
    CHECK(conic_triangles_smooth(f->context, &broken) == CONIC_ERROR_ARGUMENT);
    CHECK(conic_triangles_append(f->context, &more, &broken) == CONIC_ERROR_ARGUMENT);
    CHECK(conic_hybrid_build(f->context, &broken, &options, &hybrid, NULL) == CONIC_ERROR_ARGUMENT && !hybrid);
    CHECK(conic_triangles_bounds(&broken, low, high) == 0);
    CHECK(memcmp(&broken, &before, sizeof before) == 0);
  }
  whole.corners[3][1] = (uint32_t)whole.n_vertices;
  CHECK(draw(f, NULL, &whole) == CONIC_ERROR_INPUT);
  conic_triangles_release(f->context, &whole);
  conic_triangles_release(f->context, &more);
}

/* What the reader of camera files refuses, every function does that looks through a camera. */
static void test_unusable_cameras(fixture *f) {
  const conic_camera good = f->camera;
  conic_octree_options options;
  conic_selection_options wanted;
  conic_selection selection = {0};
  conic_octree *octree = NULL;
  conic_splats copy = {0};
  conic_octree_options_init(&options);
  conic_selection_options_init(&wanted);
  CHECK_OK(conic_splats_append(f->context, &copy, &f->splats));
  CHECK_OK(conic_octree_build(f->context, &copy, &options, &octree));
  CHECK_OK(conic_octree_select(octree, &good, &f->options, &wanted, &selection));
  for (int i = 0; i < 11; i++) {
    conic_camera bad = good;
    double *m = bad.cam_from_world[1];
    switch (i) {
    case 0: /* mirrored */
      for (int k = 0; k < 4; k++)
        m[k] = -m[k];
      break;
    case 1: /* stretched */
      for (int k = 0; k < 3; k++)
        m[k] *= 1.01;
      break;
    case 2: /* sheared: rows of length 1 that are not orthogonal */
      for (int k = 0; k < 3; k++)
        m[k] = sqrt(0.5) * (m[k] + bad.cam_from_world[0][k]);
      break;
    case 3:
      m[1] = NAN;
      break;
    case 4:
      m[3] = INFINITY;
      break;
    case 5:
      bad.fx = 0.0;
      break;
    case 6:
      bad.cy = NAN;
      break;
    case 7:
      bad.width = 65536;
      break;
    case 8:
      bad.kind = CONIC_CAMERA_ORTHOGRAPHIC;
      break;
    case 9:
      bad.lens = CONIC_LENS_RADIAL;
      break;
    default:
      bad.reserved_word = 1;
    }
    conic_contributions *contributions;
    conic_reference reference;
    conic_oracle_sample sample;
    const conic_oracle_splat splat = {{0, 0, 5}, {1, 0, 0}, {0, 1, 0}};
    const double place[1][2] = {{1.0, 1.0}};
    f->camera = good;
    CHECK_OK(draw(f, &f->splats, NULL));
    f->image.width = bad.width;
    CHECK(conic_render(f->renderer, &f->splats, &bad, &f->options, &f->image, NULL) == CONIC_ERROR_ARGUMENT);
    f->image.width = good.width;
    CHECK(conic_contributions_create(f->context, &f->splats, &bad, &f->options, &contributions) ==
          CONIC_ERROR_ARGUMENT);
    CHECK(conic_oracle_render(f->context, &f->splats, &bad, &f->options, CONIC_ORACLE_METHOD, &reference) ==
          CONIC_ERROR_ARGUMENT);
    CHECK(conic_oracle_probe(f->context, &splat, &bad, &f->options, place, 1, &sample) == CONIC_ERROR_ARGUMENT);
    CHECK(conic_octree_select(octree, &bad, &f->options, &wanted, &selection) == CONIC_ERROR_ARGUMENT);
  }
  conic_selection_release(f->context, &selection);
  conic_octree_destroy(octree);
}

/* One struct a splat: position, axes, colour, and room that is nothing's. */
static float *interleave(const conic_splats *from, conic_splats *to) {
  float *records = malloc(from->count * FLOATS * sizeof *records);
  float *const *const arrays[] = {from->position, from->tangent_u, from->tangent_v, from->color};
  float **const columns[] = {to->position, to->tangent_u, to->tangent_v, to->color};
  for (int k = 0; k < 12; k++) {
    columns[k / 3][k % 3] = records + k;
    for (size_t i = 0; i < from->count; i++)
      records[i * FLOATS + (size_t)k] = arrays[k / 3][k % 3][i];
  }
  to->count = from->count;
  to->strides = (conic_splats_strides){.position = FLOATS * sizeof(float),
                                       .tangent_u = FLOATS * sizeof(float),
                                       .tangent_v = FLOATS * sizeof(float),
                                       .color = FLOATS * sizeof(float)};
  return records;
}

static void test_interleaved_splats(fixture *f) {
  uint64_t hashes[CONIC_N_DRAWN_PLANES];
  conic_splats strided = {0}, copy = {0};
  float *records = interleave(&f->splats, &strided);
  double low[2][3], high[2][3], length[2];
  CHECK_OK(draw(f, &f->splats, NULL));
  keep_hashes(&f->image, hashes);
  CHECK_OK(draw(f, &strided, NULL));
  CHECK(same_pictures(&f->image, hashes));
  expect_everywhere(f, &strided, CONIC_OK);
  expect_refused(f, &strided);
  CHECK_OK(conic_splats_append(f->context, &copy, &strided));
  CHECK(copy.strides.position == 0);
  for (int axis = 0; axis < 3; axis++)
    CHECK(memcmp(copy.color[axis], f->splats.color[axis], COUNT * sizeof(float)) == 0);
  CHECK(conic_splats_bounds(&strided, low[0], high[0]) == conic_splats_bounds(&f->splats, low[1], high[1]));
  CHECK(memcmp(low[0], low[1], sizeof low[0]) == 0 && memcmp(high[0], high[1], sizeof high[0]) == 0);
  CHECK_OK(conic_splats_length(f->context, &strided, &length[0]));
  CHECK_OK(conic_splats_length(f->context, &f->splats, &length[1]));
  CHECK(length[0] == length[1] && length[0] > 0.0);

  conic_contributions *contributions;
  const conic_contribution *list;
  size_t n;
  CHECK_OK(conic_contributions_create(f->context, &strided, &f->camera, &f->options, &contributions));
  CHECK_OK(conic_contributions_at(contributions, SIDE / 2, SIDE / 2, &list, &n));
  CHECK(n > 0);
  conic_contributions_destroy(contributions);
  conic_splats_release(f->context, &copy);
  free(records);
}

static void test_interleaved_triangles(fixture *f) {
  uint64_t hashes[CONIC_N_DRAWN_PLANES];
  conic_triangles whole = triangles_torus(f, 24, 16, 0.4), strided = whole;
  float *records = malloc(3 * whole.n_vertices * sizeof *records);
  double low[2][3], high[2][3];
  for (int axis = 0; axis < 3; axis++) {
    strided.position[axis] = records + axis;
    for (size_t i = 0; i < whole.n_vertices; i++)
      records[3 * i + (size_t)axis] = whole.position[axis][i];
  }
  strided.strides.position = 3 * sizeof(float);
  CHECK_OK(draw(f, &f->splats, &whole));
  keep_hashes(&f->image, hashes);
  CHECK_OK(draw(f, &f->splats, &strided));
  CHECK(same_pictures(&f->image, hashes));
  CHECK(conic_triangles_bounds(&strided, low[0], high[0]) == conic_triangles_bounds(&whole, low[1], high[1]));
  CHECK(memcmp(low[0], low[1], sizeof low[0]) == 0 && memcmp(high[0], high[1], sizeof high[0]) == 0);
  CHECK(conic_triangles_smooth(f->context, &strided) == CONIC_ERROR_ARGUMENT);
  conic_triangles_release(f->context, &whole);
  free(records);
}

/* Who says nothing of the method draws by auto, also where the options end before it; 0 stays conic. */
static void test_method(fixture *f) {
  uint64_t hashes[CONIC_N_DRAWN_PLANES];
  const conic_render_options whole = f->options;
  CHECK(whole.method == CONIC_METHOD_AUTO && CONIC_METHOD_CONIC == 0);
  conic_render_options_init(&f->options);
  CHECK_OK(draw(f, &f->splats, NULL));
  keep_hashes(&f->image, hashes);
  f->options.method = CONIC_METHOD_CONIC;
  CHECK_OK(draw(f, &f->splats, NULL));
  CHECK(!same_pictures(&f->image, hashes));
  f->options.size = sizeof(size_t);
  CHECK_OK(draw(f, &f->splats, NULL));
  CHECK(same_pictures(&f->image, hashes));
  f->options = whole;
}

int main(void) {
  fixture f = fixture_open(2);
  fixture_scene(&f, CONIC_SCENE_SPHERE, COUNT);
  triangles_camera(&f, 3, SIDE);
  test_broken_splats(&f);
  test_broken_triangles(&f);
  test_unusable_cameras(&f);
  test_method(&f);
  test_interleaved_splats(&f);
  test_interleaved_triangles(&f);
  fixture_close(&f);
  return check_result();
}
