/* The reach of outlines is that of all points one by one, to the bit, by every instruction set: whatever bounds leave
 * out did not matter. */
#include "raster/framing/outline_reach.h"

#include "core/lanes/instruction_sets.h"
#include "tests/support/fixture.h"
#include "tests/support/random_numbers.h"

enum { N_SPLATS = 40001, N_TRIANGLES = 3001 };

static double random_between(uint64_t *state, double low, double high) {
  return low + (high - low) * random_unit(state);
}

/* Of very different sizes, in a box or on a plane; some are no numbers, some have clip lines. */
static void scatter(fixture *f, double size, double flat, int has_oddities, uint64_t *state) {
  static const float odd[] = {NAN, INFINITY, -INFINITY, 3e38f, -1e30f, 1e-42f};
  fixture_splats(f, N_SPLATS);
  for (size_t i = 0; i < N_SPLATS; i++) {
    double radius = size * pow(10.0, random_between(state, -6.0, -2.0));
    for (int axis = 0; axis < 3; axis++) {
      double span = axis == 1 ? flat * size : size;
      f->splats.position[axis][i] = (float)random_between(state, -span, span);
      f->splats.tangent_u[axis][i] = (float)random_between(state, -radius, radius);
      f->splats.tangent_v[axis][i] = (float)random_between(state, -radius, radius);
    }
    if (has_oddities && i % 997 == 3) {
      float *const *columns = i % 3 == 0 ? f->splats.position : i % 3 == 1 ? f->splats.tangent_u : f->splats.tangent_v;
      columns[i % 2][i] = odd[i % 6];
    }
  }
}

/* Every place of `r`, by the definition. */
static double reach_of_all(const conic_outline_reach *r, const double direction[3]) {
  const conic_splats *s = r->drawing->splats;
  const conic_triangles *t = r->drawing->triangles;
  double farthest = -HUGE_VAL;
  size_t i_clip = 0;
  for (size_t i = 0; i < s->count + 3 * t->count; i++) {
    int is_splat = i < s->count, is_within = 1;
    size_t k = is_splat ? i : t->corners[(i - s->count) / 3][(i - s->count) % 3];
    double at[3], along = 0.0, along_u = 0.0, along_v = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double offset = (is_splat ? s->origin : t->origin)[axis] - r->center[axis];
      at[axis] = (double)(is_splat ? s->position : t->position)[axis][k] + offset;
      is_within &= at[axis] >= r->low[axis] && at[axis] <= r->high[axis];
    }
    int is_clipped = is_splat && i_clip < s->n_clips && s->clips[i_clip].splat == i;
    i_clip += (size_t)is_clipped;
    along = direction[0] * at[0] + direction[1] * at[1] + direction[2] * at[2];
    if (is_splat && !is_clipped) {
      double u[3], v[3];
      for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)s->tangent_u[axis][k];
        v[axis] = (double)s->tangent_v[axis][k];
      }
      along_u = direction[0] * u[0] + direction[1] * u[1] + direction[2] * u[2];
      along_v = direction[0] * v[0] + direction[1] * v[1] + direction[2] * v[2];
      double outline = r->cutoff * sqrt(along_u * along_u + along_v * along_v);
      along += outline - outline == 0.0 ? outline : 0.0;
    }
    farthest = is_within && along > farthest ? along : farthest;
  }
  return farthest;
}

static void test_directions(conic_context *context, conic_outline_reach *r, uint64_t *state) {
  r->n = 10;
  for (size_t i = 0; i < r->n; i++)
    for (int axis = 0; axis < 3; axis++) {
      r->narrow[i][axis] = random_between(state, -1.0, 1.0);
      r->wide[i][axis] = i == 9 ? r->narrow[i][axis] : r->narrow[i][axis] + random_between(state, -0.5, 0.5);
    }
  CHECK_OK(conic_reach_open(context, r));
  for (int round = 0; round < 4; round++) {
    for (size_t i = 0; i < r->n; i++) {
      r->parts[i] = round == 0 ? 1.0 : random_unit(state);
      for (int axis = 0; axis < 3; axis++)
        r->directions[i][axis] = r->parts[i] * r->wide[i][axis] + (1.0 - r->parts[i]) * r->narrow[i][axis];
    }
    CHECK_OK(conic_reach_measure(context, r));
    for (size_t i = 0; i < r->n; i++)
      CHECK(r->farthest[i] == reach_of_all(r, r->directions[i]));
  }
  conic_reach_close(context, r);
}

static void scatter_triangles(conic_context *context, double size, conic_triangles *t, uint64_t *state) {
  CHECK_OK(conic_triangles_allocate(context, N_TRIANGLES, N_TRIANGLES, 0, t));
  for (size_t i = 0; i < N_TRIANGLES; i++)
    for (int axis = 0; axis < 3; axis++) {
      t->position[axis][i] = (float)random_between(state, -size, size);
      t->corners[i][axis] = (uint32_t)(random_unit(state) * N_TRIANGLES);
    }
}

typedef struct scene {
  double size, flat, far; /* half its edge, how much of that is its height, and how far off it lies */
  int has_oddities;
} scene;

static void test_scene(conic_isa isa, const scene *given) {
  fixture f = fixture_open(2);
  uint64_t state = 11;
  conic_clip clips[N_SPLATS / 50 + 1];
  conic_triangles triangles;
  conic_context *context;
  conic_context_options options;
  conic_context_options_init(&options);
  options.isa = isa;
  CHECK_OK(conic_context_create(&options, &context));
  scatter(&f, given->size, given->flat, given->has_oddities, &state);
  scatter_triangles(f.context, 0.99 * given->size, &triangles, &state);
  conic_splats *s = &f.splats;
  for (size_t i = 0; given->has_oddities && i < N_SPLATS; i += 50)
    clips[s->n_clips++] = (conic_clip){.splat = (uint32_t)i, .n_lines = 1};
  s->clips = clips;
  const conic_drawing drawing = {s, &triangles};
  conic_outline_reach r = {.drawing = &drawing, .cutoff = 1.5};
  for (int axis = 0; axis < 3; axis++) {
    s->origin[axis] = given->far;
    triangles.origin[axis] = given->far * (1.0 + 1e-9);
    r.center[axis] = given->far + 0.3 * given->size * axis;
    r.low[axis] = -0.9 * given->size;
    r.high[axis] = given->size;
  }
  test_directions(context, &r, &state);
  s->clips = NULL;
  s->n_clips = 0;
  conic_triangles_release(f.context, &triangles);
  conic_context_destroy(context);
  fixture_close(&f);
}

int main(void) {
  static const scene scenes[] = {{1.0, 1.0, 0.0, 0},   {1.0, 0.0, 1e7, 1},   {1e-30, 1.0, 0.0, 0},
                                 {1e30, 1e-3, 0.0, 1}, {100.0, 1.0, 3e5, 1}, {0.0, 0.0, 5.0, 1}};
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++)
    for (size_t i = 0; conic_isa_is_here((conic_isa)isa) && i < sizeof scenes / sizeof scenes[0]; i++)
      test_scene((conic_isa)isa, &scenes[i]);
  return check_result();
}
