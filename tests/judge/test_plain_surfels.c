/* The bounds of surface splats hold whatever a plain renderer's compiler and device do with its floats: no pixel of its
 * pictures is wrong. Each evaluation is a picture of random discs, drawn by an arithmetic that fuses, orders and
 * approximates by chance.
 *
 * test_plain_surfels SOURCE [COUNT [FIRST]]: a campaign of so many evaluations, from this one on. */
#include "tests/judge/plain_conic.h"
#include "tests/judge/plain_surfels.h"
#include "tests/support/fixture.h"

enum { SIDE = 24, MOST_TOLD = 20 };

typedef struct surfel_tally {
  size_t evaluations, pixels[CONIC_N_PIXEL_CLASSES], unbounded, violated;
} surfel_tally;

static double surfel_chance(plain_floats *f, double low, double high) {
  return low + (high - low) * plain_chance(f, 1u << 24) * 0x1p-24;
}

static void random_unit_vector(plain_floats *f, double v[3]) {
  double square = 0.0;
  while (!(square > 0.01 && square < 1.0)) {
    square = 0.0;
    for (int k = 0; k < 3; k++) {
      v[k] = surfel_chance(f, -1.0, 1.0);
      square += v[k] * v[k];
    }
  }
  for (int k = 0; k < 3; k++)
    v[k] /= sqrt(square);
}

/* Two vectors across n at right angles to each other. */
static void span_across(const double n[3], double u[3], double v[3]) {
  const int least = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
  double length = sqrt(1.0 - n[least] * n[least]);
  for (int k = 0; k < 3; k++)
    u[k] = ((k == least) - n[least] * n[k]) / length;
  for (int k = 0; k < 3; k++)
    v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
}

/* Manners of scenes: a ball, sheets one behind the other, discs anywhere, tiny ones, and such as are seen from their
 * edges. */
enum { BALL, SHEETS, CONFETTI, TINY, EDGES, N_SURFEL_MANNERS };

static void place_disc(plain_floats *f, int manner, size_t i, double p[3], double n[3]) {
  random_unit_vector(f, n);
  for (int k = 0; k < 3; k++)
    p[k] = manner == BALL ? n[k] : surfel_chance(f, -1.0, 1.0);
  if (manner == SHEETS) {
    n[0] = 0.3;
    n[1] = 0.1;
    n[2] = sqrt(0.9);
    p[2] = -0.3 * p[0] + 0.02 * (double)(i % 2);
  }
  if (manner == EDGES) { /* the eye lies nearly in the plane */
    const double to_eye[3] = {p[0], p[1], p[2] + 4.0};
    double across[3], length = 0.0;
    for (int k = 0; k < 3; k++)
      across[k] = to_eye[(k + 1) % 3] * n[(k + 2) % 3] - to_eye[(k + 2) % 3] * n[(k + 1) % 3];
    for (int k = 0; k < 3; k++)
      length += across[k] * across[k];
    for (int k = 0; k < 3; k++)
      n[k] = across[k] / sqrt(length);
  }
}

/* The camera stands 4 before the origin. */
static void scatter_discs(fixture *f, plain_floats *chance) {
  const int manner = (int)plain_chance(chance, N_SURFEL_MANNERS);
  const size_t n = 20 + plain_chance(chance, 200);
  const double size = manner == TINY ? 0.004 : surfel_chance(chance, 0.03, 0.15);
  fixture_camera(f, SIDE, SIDE, SIDE * surfel_chance(chance, 0.8, 2.0));
  f->camera.cx += surfel_chance(chance, -3.0, 3.0);
  f->camera.cam_from_world[2][3] = 4.0;
  fixture_splats(f, n);
  for (size_t i = 0; i < n; i++) {
    double p[3], normal[3], u[3], v[3], thin = plain_chance(chance, 3) ? 1.0 : surfel_chance(chance, 0.1, 1.0);
    place_disc(chance, manner, i, p, normal);
    span_across(normal, u, v);
    for (int k = 0; k < 3; k++) {
      u[k] *= size;
      v[k] *= size * thin;
    }
    fixture_set(f, i, p, u, v, (float)surfel_chance(chance, 0.0, 1.0), (float)surfel_chance(chance, 0.0, 1.0), 0.5f);
  }
}

static plain_surfels plain_surfels_of(const conic_splats *s) {
  plain_surfels p = {.count = s->count};
  float **const to[4] = {&p.center, &p.axes[0], &p.axes[1], &p.color};
  float *const *const from[4] = {s->position, s->tangent_u, s->tangent_v, s->color};
  for (int k = 0; k < 4; k++) {
    *to[k] = calloc(s->count, 3 * sizeof(float));
    for (size_t i = 0; i < 3 * s->count; i++)
      (*to[k])[i] = from[k][i % 3][i / 3];
  }
  return p;
}

static void tell_wrong_surfels(uint64_t seed, const plain_surfel_settings *s, const conic_oracle_judgement *j) {
  static size_t n_told;
  if (n_told++ >= MOST_TOLD)
    return;
  printf("evaluation %llu: affine %d, prefilter %g (fused %d, shuffled %d, fast %d, exp %d): %zu wrong\n",
         (unsigned long long)seed, s->is_affine, (double)s->prefilter, s->floats.fused, s->floats.is_shuffled,
         s->floats.is_fast, (int)s->floats.exp, j->pixels[CONIC_PIXEL_WRONG]);
  for (int k = 0; k < j->n_worst && k < 3; k++)
    printf("  pixel %d,%d %s[%d]: %.9g not in %.9g to %.9g\n", j->worst[k].x, j->worst[k].y,
           conic_plane_describe((conic_plane)j->worst[k].plane)->name, j->worst[k].channel, j->worst[k].found,
           j->worst[k].low, j->worst[k].high);
}

static void judge_plain_picture(fixture *f, uint64_t seed, const plain_surfel_settings *settings, conic_float_kind kind,
                                const plain_picture *picture, surfel_tally *tally) {
  conic_reference reference;
  conic_oracle_judgement judgement;
  conic_image image =
      image_of_plain(f->context, picture, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_COUNT);
  conic_oracle_asking asking;
  conic_oracle_asking_init(&asking);
  asking.floats = kind;
  const conic_drawing drawing = {.splats = &f->splats};
  CHECK_OK(conic_oracle_render_asked(f->context, &drawing, &f->camera, &f->options, &asking, &reference));
  CHECK_OK(conic_oracle_judge(f->context, &reference, NULL, &image, NULL, &judgement));
  tally->evaluations++;
  tally->violated += judgement.pixels[CONIC_PIXEL_WRONG] > 0;
  tally->unbounded += reference.unbounded_pixels;
  for (int k = 0; k < CONIC_N_PIXEL_CLASSES; k++)
    tally->pixels[k] += judgement.pixels[k];
  if (judgement.pixels[CONIC_PIXEL_WRONG])
    tell_wrong_surfels(seed, settings, &judgement);
  conic_reference_release(f->context, &reference);
  conic_image_release(f->context, &image);
}

static void evaluate_surfels(fixture *f, uint64_t seed, surfel_tally tallies[2]) {
  plain_floats chance = {.state = seed * 15485863};
  plain_surfel_settings settings = {.cutoff = 1.5f};
  settings.is_affine = (int)plain_chance(&chance, 2);
  settings.prefilter = plain_chance(&chance, 4) ? 1.0f : 0.25f;
  const int is_fast = (int)plain_chance(&chance, 2);
  settings.floats = plain_floats_by_chance(seed * 7919 + 1, is_fast);
  scatter_discs(f, &chance);
  f->options.method = settings.is_affine ? CONIC_METHOD_AFFINE : CONIC_METHOD_CONIC;
  f->options.prefilter = settings.prefilter;
  plain_surfels surfels = plain_surfels_of(&f->splats);
  const plain_camera camera = plain_camera_of(&f->camera);
  plain_picture picture = plain_picture_allocate(SIDE, SIDE);
  CHECK(plain_surfels_draw(&surfels, &camera, &settings, &picture) == 0);
  judge_plain_picture(f, seed, &settings, is_fast ? CONIC_FLOATS_FAST : CONIC_FLOATS_STRICT, &picture,
                      &tallies[settings.is_affine]);
  plain_picture_release(&picture);
  plain_surfels_release(&surfels);
}

int main(int argc, char **argv) {
  const uint64_t n = argc > 2 ? strtoull(argv[2], NULL, 10) : 150, first = argc > 3 ? strtoull(argv[3], NULL, 10) : 1;
  surfel_tally tallies[2] = {{.evaluations = 0}, {.evaluations = 0}};
  fixture f = fixture_open(1);
  for (uint64_t seed = first; seed < first + n; seed++)
    evaluate_surfels(&f, seed, tallies);
  for (int is_affine = 0; is_affine < 2; is_affine++) {
    const surfel_tally *t = &tallies[is_affine];
    printf("%-6s %5zu evaluations: equal %7zu, rounded %7zu, explained %6zu, wrong %4zu; unbounded %zu; violated %zu\n",
           is_affine ? "affine" : "conic", t->evaluations, t->pixels[CONIC_PIXEL_EQUAL], t->pixels[CONIC_PIXEL_ROUNDED],
           t->pixels[CONIC_PIXEL_EXPLAINED], t->pixels[CONIC_PIXEL_WRONG], t->unbounded, t->violated);
    CHECK(t->violated == 0);
  }
  fixture_close(&f);
  return check_result();
}
