/* A picture of splats or triangles that is judged: the classes of its pixels, values that stand for ranges, and what
 * floats of other programs may do. */
#include "conic/picture.h"
#include "tests/support/triangle_fixture.h"

enum { SIZE = 70 };

typedef struct judging {
  conic_reference reference;
  conic_oracle_judgement judgement;
  uint8_t classes[SIZE * SIZE];
} judging;

static void open_scene(fixture *f, double distance) {
  fixture_camera(f, SIZE, SIZE, 60.0);
  f->camera.cam_from_world[2][3] = 3.0;
  f->camera.cam_from_world[0][3] = -distance;
  fixture_scene(f, CONIC_SCENE_KNOT, 1500);
  f->splats.origin[0] = distance;
}

static void judge_with(fixture *f, const conic_triangles *t, conic_float_kind floats, const conic_image *image,
                       const conic_image *greatest, judging *j) {
  const conic_drawing drawing = {&f->splats, t};
  conic_oracle_asking asking;
  conic_oracle_judging options;
  conic_oracle_asking_init(&asking);
  conic_oracle_judging_init(&options);
  asking.floats = floats;
  options.greatest = greatest;
  CHECK_OK(conic_oracle_render_asked(f->context, &drawing, &f->camera, &f->options, &asking, &j->reference));
  CHECK_OK(conic_oracle_judge(f->context, &j->reference, &options, image, j->classes, &j->judgement));
  conic_reference_release(f->context, &j->reference);
  size_t sum = 0;
  for (int k = 0; k < CONIC_N_PIXEL_CLASSES; k++)
    sum += j->judgement.pixels[k];
  CHECK(sum == SIZE * SIZE);
}

static size_t wrong_of(const judging *j) {
  return j->judgement.pixels[CONIC_PIXEL_WRONG];
}

static void test_classes(fixture *f) {
  judging j;
  open_scene(f, 0.0);
  fixture_render(f);
  judge_with(f, NULL, CONIC_FLOATS_OWN, &f->image, NULL, &j);
  CHECK(wrong_of(&j) == 0 && j.judgement.n_worst == 0 && j.judgement.verdict.pass);
  CHECK(j.judgement.pixels[CONIC_PIXEL_EQUAL] > 1000 && j.judgement.pixels[CONIC_PIXEL_ROUNDED] > 100);
  float *rgba = f->image.planes[CONIC_PLANE_RGBA], *z = f->image.planes[CONIC_PLANE_Z];
  const size_t middle = 12 * SIZE + 35, other = 58 * SIZE + 35, third = 3;
  rgba[4 * middle + 1] += 0.01f;
  z[other] = NAN;
  rgba[4 * third] = INFINITY;
  judge_with(f, NULL, CONIC_FLOATS_OWN, &f->image, NULL, &j);
  CHECK(wrong_of(&j) == 3 && j.judgement.n_worst == 3);
  CHECK(j.classes[middle] == CONIC_PIXEL_WRONG && j.classes[other] == CONIC_PIXEL_WRONG &&
        j.classes[third] == CONIC_PIXEL_WRONG);
  CHECK(j.judgement.worst[2].x == 35 && j.judgement.worst[2].y == 12 && j.judgement.worst[2].channel == 1 &&
        j.judgement.worst[2].found > j.judgement.worst[2].high);
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) /* what is not there is not judged */
    if (plane != CONIC_PLANE_COUNT) {
      conic_image alone = {.width = 1, .planes[0] = f->image.planes[plane]};
      conic_image_release(f->context, &alone);
      f->image.planes[plane] = NULL;
    }
  judge_with(f, NULL, CONIC_FLOATS_OWN, &f->image, NULL, &j);
  CHECK(wrong_of(&j) == 0 && !j.judgement.verdict.planes[CONIC_PLANE_RGBA].is_compared);
  fixture_render(f);
  rgba = f->image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < SIZE * SIZE; i++)
    rgba[4 * i + 3] = 1.0f;
  judge_with(f, NULL, CONIC_FLOATS_OWN, &f->image, NULL, &j);
  CHECK(wrong_of(&j) > 1000);
  f->image.lacks_alpha = 1;
  judge_with(f, NULL, CONIC_FLOATS_OWN, &f->image, NULL, &j);
  CHECK(wrong_of(&j) == 0);
}

/* The picture's colours as codes, and what they stand for. */
static void make_codes(fixture *f, unsigned most, double add, conic_picture *picture) {
  conic_picture_options options;
  conic_image codes;
  conic_picture_options_init(&options);
  options.rounding = add > 0.0 ? CONIC_CODES_NEAREST : CONIC_CODES_DOWN;
  CHECK_OK(conic_image_allocate(f->context, SIZE, SIZE, 1u, &codes));
  const float *from = f->image.planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < 4 * SIZE * SIZE; i++)
    ((float *)codes.planes[0])[i] = (float)(fmin(floor((double)from[i] * most + add), most) / most);
  CHECK_OK(conic_picture_take(f->context, &codes, most, &options, picture));
}

static void test_codes(fixture *f) {
  judging j;
  open_scene(f, 0.0);
  for (int c = 0; c < 3; c++) /* some are cut off */
    for (size_t i = 0; i < f->splats.count; i++)
      f->splats.color[c][i] *= 1.5f;
  fixture_render(f);
  for (unsigned most = 255; most <= 65535; most += 65280)
    for (int is_nearest = 0; is_nearest < 2; is_nearest++) {
      conic_picture picture;
      make_codes(f, most, is_nearest ? 0.5 : 0.0, &picture);
      CHECK(picture.greatest.width == SIZE && picture.most_code == most);
      judge_with(f, NULL, CONIC_FLOATS_OWN, &picture.image, &picture.greatest, &j);
      CHECK(wrong_of(&j) == 0);
      judge_with(f, NULL, CONIC_FLOATS_OWN, &picture.image, NULL, &j); /* as if codes were exact */
      CHECK(wrong_of(&j) > 500);
      float *low = picture.image.planes[0], *high = picture.greatest.planes[0];
      size_t at = 4 * (12 * SIZE + 35);
      low[at] += 2.0f / (float)most + 2e-4f;
      high[at] += 2.0f / (float)most + 2e-4f;
      judge_with(f, NULL, CONIC_FLOATS_OWN, &picture.image, &picture.greatest, &j);
      CHECK(wrong_of(&j) == 1 && j.judgement.worst[0].x == 35 && j.judgement.worst[0].y == 12);
      conic_picture_release(f->context, &picture);
    }
}

/* Centres that are off as sums in floats may be: that is right of a renderer of floats, and wrong of conic, which forms
 * them in double. */
static void test_floats(fixture *f) {
  judging j;
  uint64_t state = 3;
  const double distance = 200.0;
  open_scene(f, distance);
  conic_splats moved;
  CHECK_OK(conic_splats_allocate(f->context, f->splats.count, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, &moved));
  for (int axis = 0; axis < 3; axis++) {
    moved.origin[axis] = f->splats.origin[axis];
    for (size_t i = 0; i < moved.count; i++) {
      double off = axis == 0 ? 4.0 * 0x1p-24 * distance * (2.0 * fixture_random(&state) - 1.0) : 0.0;
      moved.position[axis][i] = (float)((double)f->splats.position[axis][i] + off);
      moved.tangent_u[axis][i] = f->splats.tangent_u[axis][i];
      moved.tangent_v[axis][i] = f->splats.tangent_v[axis][i];
      moved.color[axis][i] = f->splats.color[axis] ? f->splats.color[axis][i] : 1.0f;
    }
  }
  conic_splats own = f->splats;
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    f->options.method = (conic_method)method;
    f->splats = moved;
    fixture_render(f);
    f->splats = own;
    judge_with(f, NULL, CONIC_FLOATS_FAST, &f->image, NULL, &j);
    CHECK(wrong_of(&j) == 0);
    judge_with(f, NULL, CONIC_FLOATS_OWN, &f->image, NULL, &j);
    CHECK(wrong_of(&j) > (method == CONIC_METHOD_POINT ? 0 : 200));
    float *rgba = f->image.planes[CONIC_PLANE_RGBA]; /* what is more than that stays wrong */
    rgba[4 * (12 * SIZE + 35)] += 0.05f;
    judge_with(f, NULL, CONIC_FLOATS_FAST, &f->image, NULL, &j);
    CHECK(wrong_of(&j) == 1);
  }
  f->options.method = CONIC_METHOD_CONIC;
  conic_splats_release(f->context, &moved);
}

/* The same of a mesh, whose corners then lie elsewhere by less than a step of their raster. */
static void test_mesh(fixture *f) {
  judging j;
  const double distance = 200.0;
  conic_triangles t = triangles_torus(f, 20, 10, 0.4);
  uint64_t state = 4;
  open_scene(f, distance);
  fixture_splats(f, 0);
  t.origin[0] = distance;
  conic_drawing drawing = {&f->splats, &t};
  const unsigned but_normals = ALL_PLANES & ~(1u << CONIC_PLANE_NORMAL); /* these turn as the corners move */
  CHECK_OK(conic_image_allocate(f->context, SIZE, SIZE, but_normals, &f->image));
  for (size_t i = 0; i < t.n_vertices; i++)
    t.position[0][i] += (float)(2.0 * 0x1p-24 * distance * (2.0 * fixture_random(&state) - 1.0));
  CHECK_OK(
      conic_render_drawing(f->context, f->renderer, &drawing, &f->camera, &f->options, 1, &f->image, &f->statistics));
  conic_triangles_release(f->context, &t);
  t = triangles_torus(f, 20, 10, 0.4);
  t.origin[0] = distance;
  judge_with(f, &t, CONIC_FLOATS_FAST, &f->image, NULL, &j);
  CHECK(wrong_of(&j) == 0 && f->statistics.triangles_drawn > 50);
  judge_with(f, &t, CONIC_FLOATS_OWN, &f->image, NULL, &j);
  CHECK(wrong_of(&j) > 0);
  conic_triangles_release(f->context, &t);
}

int main(void) {
  fixture f = fixture_open(2);
  test_classes(&f);
  test_codes(&f);
  test_floats(&f);
  conic_image_release(f.context, &f.image);
  test_mesh(&f);
  fixture_close(&f);
  return check_result();
}
