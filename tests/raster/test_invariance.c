/* One image, one set of bits: hostile and friendly splats over threads and tile sizes, every plane, both pass modes.
 * And every plane is defined on every pixel. */
#include "core/lanes/instruction_sets.h"
#include "raster/view/part.h"
#include "tests/support/fixture.h"

static float hostile_value(uint64_t *state, double scale) {
  static const float specials[] = {NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 1e-42f, 1e30f, -1e30f, 1e-20f, 3e38f};
  double choice = fixture_random(state);
  if (choice < 0.02)
    return specials[(int)(fixture_random(state) * 10.0)];
  return (float)(scale * (fixture_random(state) - 0.5));
}

/* Splats around and behind the camera, of all sizes and shapes; some with special values in them. */
static void fill_hostile(fixture *f, size_t count) {
  uint64_t state = 42;
  fixture_splats(f, count);
  for (size_t i = 0; i < count; i++) {
    double size = pow(10.0, -3.5 * fixture_random(&state)), thin = i % 5 ? 1.0 : 1e-6;
    for (int axis = 0; axis < 3; axis++) {
      f->splats.position[axis][i] = hostile_value(&state, 6.0) + (axis == 2 ? 2.0f : 0.0f);
      f->splats.tangent_u[axis][i] = hostile_value(&state, size);
      f->splats.tangent_v[axis][i] = hostile_value(&state, size * thin);
      f->splats.color[axis][i] = hostile_value(&state, 1.0);
    }
    if (i % 11 == 0) /* exactly edge-on, the eye in its plane */
      for (int axis = 0; axis < 3; axis++)
        f->splats.tangent_v[axis][i] = 0.03f * f->splats.position[axis][i];
  }
}

static void hash_all(fixture *f, uint64_t hashes[CONIC_N_DRAWN_PLANES]) {
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    hashes[plane] = conic_image_hash(&f->image, (conic_plane)plane);
}

static void fill(fixture *f, int scene) {
  fixture_camera(f, 166, 106, 110.0);
  f->options.near_z = 1e-3;
  if (scene == 0)
    fill_hostile(f, 4000);
  else {
    f->camera.cam_from_world[2][3] = scene == 1 ? 2.2 : 1.2; /* from outside, and from inside the tube */
    fixture_scene(f, scene == 1 ? CONIC_SCENE_KNOT : CONIC_SCENE_TORUS, scene == 1 ? 20000 : 6000);
  }
}

static void check_same(fixture *f, const uint64_t expected[CONIC_N_DRAWN_PLANES],
                       const conic_render_statistics *counted) {
  uint64_t hashes[CONIC_N_DRAWN_PLANES];
  fixture_render(f);
  hash_all(f, hashes);
  CHECK(memcmp(expected, hashes, sizeof hashes) == 0);
  CHECK(strcmp(f->statistics.isa, conic_isa_name(f->options.isa)) == 0);
  CHECK(counted->splats_culled == f->statistics.splats_culled && counted->splats_drawn == f->statistics.splats_drawn);
  CHECK(counted->splats_fallback == f->statistics.splats_fallback && counted->fragments == f->statistics.fragments);
  CHECK(counted->pixels_covered == f->statistics.pixels_covered);
}

/* Every instruction set that this machine has draws the same picture, and counts the same; in bands, too. */
static void check_instruction_sets(fixture *f, const uint64_t expected[CONIC_N_DRAWN_PLANES]) {
  static const size_t most_records[] = {2500, 10};
  conic_render_statistics counted = f->statistics;
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    if (!conic_isa_is_here((conic_isa)isa))
      continue;
    f->options.isa = (conic_isa)isa;
    check_same(f, expected, &counted);
    conic_renderer_give_back(f->renderer);
    conic_renderer_bound_records(f->renderer, most_records[isa % 2]);
    check_same(f, expected, &counted);
    conic_renderer_bound_records(f->renderer, 0);
  }
  f->options.isa = CONIC_ISA_AUTO;
}

/* A plane is the same whatever other planes are asked for beside it. */
static void check_planes_alone(fixture *f, const uint64_t expected[CONIC_N_DRAWN_PLANES]) {
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++) {
    conic_image image;
    CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, 1u << plane, &image));
    CHECK_OK(conic_render(f->renderer, &f->splats, &f->camera, &f->options, &image, NULL));
    CHECK(conic_image_hash(&image, (conic_plane)plane) == expected[plane]);
    conic_image_release(f->context, &image);
  }
}

static void check_defined(const fixture *f) {
  for (int y = 0; y < f->image.height; y++)
    for (int x = 0; x < f->image.width; x++) {
      int is_covered = fixture_index(f, CONIC_PLANE_ID, x, y) != CONIC_NO_ID;
      const float *rgba = fixture_pixel(f, CONIC_PLANE_RGBA, x, y), *n = fixture_pixel(f, CONIC_PLANE_NORMAL, x, y);
      float z = *fixture_pixel(f, CONIC_PLANE_Z, x, y), weight = *fixture_pixel(f, CONIC_PLANE_WEIGHT, x, y);
      CHECK(rgba[0] * 0.0f == 0.0f && rgba[1] * 0.0f == 0.0f && rgba[2] * 0.0f == 0.0f);
      CHECK(rgba[3] == (is_covered ? 1.0f : 0.0f));
      CHECK(is_covered ? z > 0.0f && z * 0.0f == 0.0f && weight > 0.0f : z == 0.0f && weight == 0.0f);
      double norm = sqrt((double)n[0] * (double)n[0] + (double)n[1] * (double)n[1] + (double)n[2] * (double)n[2]);
      CHECK_NEAR(norm, is_covered ? 1.0 : 0.0, 1e-5);
      CHECK((fixture_index(f, CONIC_PLANE_COUNT, x, y) > 0) == is_covered);
    }
}

int main(void) {
  static const int thread_counts[] = {1, 2, 7}, tiles[] = {64, 16, 32, 8};
  uint64_t reference[3][2][CONIC_N_METHODS][CONIC_N_DRAWN_PLANES];
  for (int t = 0; t < 3; t++) {
    fixture f = fixture_open(thread_counts[t]);
    for (int scene = 0; scene < 3; scene++) {
      fill(&f, scene);
      for (int variant = 0; variant < 2 * CONIC_N_METHODS; variant++)
        for (int i_tile = 0; i_tile < (t == 0 ? 4 : 2); i_tile++) {
          uint64_t hashes[CONIC_N_DRAWN_PLANES],
              *expected = reference[scene][variant / CONIC_N_METHODS][variant % CONIC_N_METHODS];
          f.options.tile = tiles[i_tile];
          f.options.passes = variant / CONIC_N_METHODS ? 1 : 3;
          f.options.method = (conic_method)(variant % CONIC_N_METHODS);
          f.options.shading = CONIC_SHADE_PHONG;
          fixture_render(&f);
          hash_all(&f, hashes);
          if (t == 0 && i_tile == 0) {
            memcpy(expected, hashes, sizeof hashes);
            check_defined(&f);
            check_instruction_sets(&f, expected);
            check_planes_alone(&f, expected);
            CHECK(f.statistics.pixels_covered > (f.options.method == CONIC_METHOD_POINT ? 200 : 1000));
          } else
            CHECK(memcmp(expected, hashes, sizeof hashes) == 0);
        }
      if (t == 0)
        printf("scene %d: %llu drawn, %llu culled, %llu skipped, %llu by ray, %llu fragments\n", scene,
               (unsigned long long)f.statistics.splats_drawn, (unsigned long long)f.statistics.splats_culled,
               (unsigned long long)f.statistics.splats_skipped,
               (unsigned long long)f.statistics.splats_by_method[CONIC_METHOD_RAY],
               (unsigned long long)f.statistics.fragments);
    }
    fixture_close(&f);
  }
  return check_result();
}
