/* What the bytes of nodes and leaves give back: near what was put in, and never on the wrong side of a bound. */
#include "core/base/color.h"
#include "lod/octree/octree_code.h"
#include "lod/octree/octree_cover.h"
#include "tests/support/fixture.h"

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void random_unit_vector(uint64_t *state, double v[3]) {
  double length;
  do {
    for (int axis = 0; axis < 3; axis++)
      v[axis] = 2.0 * fixture_random(state) - 1.0;
    length = sqrt(dot(v, v));
  } while (!(length > 0.1 && length <= 1.0));
  for (int axis = 0; axis < 3; axis++)
    v[axis] /= length;
}

static void test_normals(void) {
  uint64_t state = 1;
  uint8_t code[3];
  double normal[3], back[3], worst = 0.0;
  for (int i = 0; i < 20000; i++) {
    random_unit_vector(&state, normal);
    if (i < 6)
      for (int axis = 0; axis < 3; axis++)
        normal[axis] = axis == i / 2 ? (i % 2 ? -1.0 : 1.0) : 0.0;
    conic_code_normal(normal, code);
    conic_code_normal_of(code, back);
    CHECK_NEAR(dot(back, back), 1.0, 1e-14);
    double apart[3] = {normal[0] - back[0], normal[1] - back[1], normal[2] - back[2]};
    worst = fmax(worst, sqrt(dot(apart, apart)));
    if (i < 6)
      CHECK_NEAR(sqrt(dot(apart, apart)), 0.0, 1e-15);
  }
  CHECK(worst < 1.1e-3); /* half a step of 1/2047 in both, where the octahedron is stretched most */
}

static void test_directions(void) {
  for (int i = 0; i < 3600; i++) {
    double angle = 3.14159265358979 * i / 3600.0 * 2.0, back[2];
    conic_code_direction_of(conic_code_direction(cos(angle), sin(angle)), back);
    CHECK_NEAR(back[0] * back[0] + back[1] * back[1], 1.0, 1e-14);
    CHECK(fabs(back[0] * sin(angle) - back[1] * cos(angle)) <
          0.0079); /* half a step of the tangent of half the angle */
  }
}

/* The same codes as core's, from below black to above white. */
static void test_colors(void) {
  conic_code_scale scale;
  uint64_t state = 4;
  conic_code_scale_init(64.0, 1.5, 1.0f, &scale);
  for (int i = 0; i < 100000; i++) {
    float linear = (float)exp(14.0 * fixture_random(&state) - 13.0);
    linear = i < 255 ? scale.steps[i] : i < 510 ? nextafterf(scale.steps[i - 255], 0.0f) : linear;
    CHECK(conic_code_srgb(&scale, linear) == conic_srgb_code(scale.steps, linear));
  }
  const float odd[] = {0.0f, -1.0f, NAN, INFINITY, -INFINITY, 1.0f, 1e-30f};
  for (int i = 0; i < 7; i++)
    CHECK(conic_code_srgb(&scale, odd[i]) == conic_srgb_code(scale.steps, odd[i]));
}

static void test_scales(void) {
  conic_code_scale scale;
  uint64_t state = 2;
  conic_code_scale_init(64.0, 1.5, 1.0f, &scale);
  for (int i = 0; i < 20000; i++) {
    double length = 64.0 * exp(-30.0 * fixture_random(&state));
    double back = conic_code_length_of(&scale, 64.0, conic_code_length(&scale, 64.0, length));
    CHECK(back >= length && back <= length * 1.0007);
    double factor = exp(6.0 * fixture_random(&state) - 4.0);
    CHECK_NEAR((double)conic_code_factor_of(&scale, conic_code_factor(&scale, factor)) / factor, 1.0, 0.023);
  }
  CHECK(conic_code_factor_of(&scale, conic_code_factor(&scale, 0.0)) == 0.0f);
}

/* All of a node. */
static void test_nodes(void) {
  conic_code_scale scale;
  uint64_t state = 3;
  conic_code_scale_init(64.0, 1.5, 1.0f, &scale);
  for (int i = 0; i < 20000; i++) {
    uint8_t code[CONIC_NODE_BYTES] = {0};
    conic_node_frame frame;
    conic_node node;
    double mean[3], first[3], normal[3], reach = exp(-8.0 * fixture_random(&state)),
                                         radius = reach * exp(9.0 * fixture_random(&state) - 1.0);
    double size = exp(-8.0 * fixture_random(&state)), error = radius * exp(-12.0 * fixture_random(&state));
    double cosine = 1.0 - 2.0 * fixture_random(&state), ratio = 0.05 + 0.95 * fixture_random(&state);
    double color[3] = {0.25, 0.5, 1.0};
    for (int axis = 0; axis < 3; axis++) {
      first[axis] = (double)(float)(20.0 * fixture_random(&state) - 10.0);
      mean[axis] = first[axis] + size * (2.0 * fixture_random(&state) - 1.0);
    }
    random_unit_vector(&state, normal);
    conic_code_children(i % 4, 2 + i % 5, code);
    conic_code_place(&scale, mean, first, code);
    conic_code_facing(normal, code);
    conic_code_axes(1.0, 0.5, ratio, code);
    conic_code_frame(&scale, first, code, &frame);
    double wanted_reach = reach, wanted_radius = radius;
    conic_code_extent(&scale, &reach, &radius, code);
    double coded_error = conic_code_error(&scale, error, radius, code);
    conic_code_cone(cosine, code);
    conic_code_color(&scale, color, 0.7, code);
    conic_code_decode(&scale, first, code, &node);
    CHECK(conic_code_n_direct(code) == i % 4 && conic_code_n_inner(code) == 2 + i % 5);
    CHECK(reach >= wanted_reach && radius >= wanted_radius);
    CHECK(radius <= fmax(wanted_radius, wanted_reach) * 1.03);
    CHECK(coded_error >= error && (coded_error <= error * 1.05 || coded_error <= radius * 4e-5));
    CHECK((double)node.cone <= cosine + 1e-7 && frame.ratio >= ratio);
    for (int axis = 0; axis < 3; axis++) {
      CHECK_NEAR((double)node.position[axis], mean[axis], size / 128.0 + 2e-6);
      CHECK((double)node.position[axis] == frame.position[axis]);
      CHECK_NEAR((double)node.color[axis], color[axis], 0.004);
      CHECK_NEAR((double)node.tangent_u[axis] * 1.5, reach * frame.u[axis], 1e-6 * reach);
      CHECK_NEAR((double)node.tangent_v[axis] * 1.5, reach * frame.ratio * frame.v[axis], 1e-6 * reach);
    }
    CHECK_NEAR(dot(frame.u, frame.v), 0.0, 1e-14);
    CHECK_NEAR(dot(frame.u, frame.n), 0.0, 1e-14);
  }
}

/* No point of the unit disc is farther from the samples than the gap. */
static void test_samples(void) {
  conic_disc_samples samples;
  double worst = 0.0;
  conic_disc_samples_init(&samples);
  for (int ix = -300; ix <= 300; ix++)
    for (int iy = -300; iy <= 300; iy++) {
      double x = ix / 300.0, y = iy / 300.0, nearest = 9.0, length = hypot(x, y);
      if (length > 1.0) { /* its rim, then */
        x /= length;
        y /= length;
      }
      for (int i = 0; i < CONIC_DISC_SAMPLES; i++)
        nearest = fmin(nearest, hypot(x - (double)samples.x[i], y - (double)samples.y[i]));
      worst = fmax(worst, nearest);
    }
  CHECK(worst <= CONIC_DISC_GAP - 0.0024); /* the grid's own gap */
}

static void test_leaves(void) {
  fixture f = fixture_open(2);
  conic_code_scale scale;
  double all_moved = 0.0, all_away = 0.0;
  fixture_scene(&f, CONIC_SCENE_TERRAIN, 5000);
  conic_splats back;
  unsigned char *codes = malloc(conic_leaf_codes_bytes(5000, 1, 0));
  conic_code_scale_init(64.0, 1.5, 1.0f, &scale);
  CHECK_OK(conic_splats_allocate(f.context, 5000, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, &back));
  if (!codes)
    exit(1);
  conic_leaf_encode(f.context, &scale, &f.splats, codes);
  conic_leaf_decode(f.context, &scale, codes, &back);
  for (size_t i = 0; i < 5000; i++) {
    double n[3], n_back[3], moved2 = 0.0, uu = 0.0, uu_back = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      int next = (axis + 1) % 3, last = (axis + 2) % 3;
      n[axis] = (double)(f.splats.tangent_u[next][i] * f.splats.tangent_v[last][i] -
                         f.splats.tangent_u[last][i] * f.splats.tangent_v[next][i]);
      n_back[axis] = (double)(back.tangent_u[next][i] * back.tangent_v[last][i] -
                              back.tangent_u[last][i] * back.tangent_v[next][i]);
      double moved = (double)(f.splats.position[axis][i] - back.position[axis][i]);
      moved2 += moved * moved;
      all_moved += moved;
      all_away += fabs(moved);
      uu += (double)(f.splats.tangent_u[axis][i] * f.splats.tangent_u[axis][i]);
      uu_back += (double)(back.tangent_u[axis][i] * back.tangent_u[axis][i]);
      CHECK_NEAR((double)back.color[axis][i], (double)f.splats.color[axis][i], 0.005);
    }
    CHECK(sqrt(moved2) < 2.0 / 8191.0); /* half a step of the widest block that can be */
    CHECK_NEAR(sqrt(uu_back / uu), 1.0, 1e-3);
    CHECK(dot(n, n_back) > 0.999999 * sqrt(dot(n, n) * dot(n_back, n_back)));
  }
  CHECK(fabs(all_moved) < 0.1 * all_away); /* to the nearest step, not to one side */
  free(codes);
  conic_splats_release(f.context, &back);
  fixture_close(&f);
}

int main(void) {
  test_normals();
  test_directions();
  test_colors();
  test_scales();
  test_nodes();
  test_samples();
  test_leaves();
  return check_result();
}
