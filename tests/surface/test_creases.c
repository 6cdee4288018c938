/* Sharp surfaces: a noisy cube keeps its edges and corners, and what has no creases stays as it is, to the bit. */
#include "core/estimate/features.h"
#include "tests/support/sanitized.h"
#include "tests/support/surface_shapes.h"

enum { SIDE = 16, N_POINTS = 6 * SIDE * SIDE };

static double noise(uint64_t *state) { /* of variance 1, nearly Gaussian */
  double sum = -6.0;
  for (int i = 0; i < 12; i++)
    sum += random_unit(state);
  return sum;
}

/* The cube from 0 to SIDE on each axis, a sample a unit of area, with noise along each axis. */
static conic_splats noisy_cube(conic_context *context, double sigma) {
  conic_splats cube = shape_allocate(context, N_POINTS, CONIC_SPLATS_NORMALS);
  uint64_t state = 5;
  for (int i = 0; i < N_POINTS; i++) {
    int axis = i / (SIDE * SIDE) / 2, is_far = i / (SIDE * SIDE) % 2, at = i % (SIDE * SIDE);
    double place[3];
    place[axis] = is_far ? SIDE : 0.0;
    place[(axis + 1) % 3] = at % SIDE + 0.15 + 0.7 * random_unit(&state);
    place[(axis + 2) % 3] = at / SIDE + 0.15 + 0.7 * random_unit(&state);
    for (int k = 0; k < 3; k++) {
      cube.position[k][i] = (float)(place[k] + sigma * noise(&state));
      cube.normal[k][i] = k != axis ? 0.0f : is_far ? 1.0f : -1.0f;
    }
  }
  return cube;
}

/* How far a place lies from the cube's surface, and from the nearest edge. */
static double from_cube(const double p[3], double *from_edge) {
  double outside[3], to_face[3], out2 = 0.0, least = SIDE, second = SIDE;
  for (int k = 0; k < 3; k++) {
    double over = fmax(-p[k], p[k] - SIDE);
    outside[k] = fmax(over, 0.0);
    to_face[k] = fabs(over);
    out2 += outside[k] * outside[k];
  }
  for (int k = 0; k < 3; k++) {
    second = to_face[k] < least ? least : fmin(second, to_face[k]);
    least = fmin(least, to_face[k]);
  }
  *from_edge = second;
  return out2 > 0.0 ? sqrt(out2) : least;
}

typedef struct cube_errors {
  double edges, faces; /* rms */
  size_t n_strays;     /* off by more than half a spacing */
  size_t n;
} cube_errors;

static cube_errors project_cube(conic_context *context, const conic_splats *cube, int is_sharp, conic_isa isa,
                                conic_splats *clean) {
  conic_surface_options options;
  conic_surface_options_init(&options);
  options.is_sharp = (uint64_t)is_sharp;
  options.isa = isa;
  options.h = 2.5;
  conic_surface *surface = shape_surface(context, cube, &options);
  cube_errors errors = {0.0, 0.0, 0, 0};
  size_t n_edges = 0, n_faces = 0;
  CHECK_OK(conic_surface_clean(surface, clean, NULL));
  for (size_t i = 0; i < clean->count; i++) {
    const double p[3] = {(double)clean->position[0][i], (double)clean->position[1][i], (double)clean->position[2][i]};
    double from_edge, off = from_cube(p, &from_edge);
    errors.edges += from_edge < 1.0 ? off * off : 0.0;
    errors.faces += from_edge > 3.0 ? off * off : 0.0;
    errors.n_strays += off > 0.5;
    n_edges += from_edge < 1.0;
    n_faces += from_edge > 3.0;
  }
  errors = (cube_errors){sqrt(errors.edges / (double)n_edges), sqrt(errors.faces / (double)n_faces), errors.n_strays,
                         clean->count};
  conic_surface_destroy(surface);
  return errors;
}

static int are_same(const conic_splats *a, const conic_splats *b) {
  int are = a->count == b->count;
  for (int axis = 0; axis < 3 && are; axis++)
    are = memcmp(a->position[axis], b->position[axis], a->count * sizeof(float)) == 0 &&
          memcmp(a->normal[axis], b->normal[axis], a->count * sizeof(float)) == 0;
  return are;
}

/* How far the outlines of splats, as far as clip lines leave them, stand out of the cube. */
static double stands_out(const conic_splats *splats, double cutoff) {
  double farthest = 0.0, on_edge;
  size_t at = 0;
  for (size_t i = 0; i < splats->count; i++) {
    const conic_clip *clip = at < splats->n_clips && splats->clips[at].splat == i ? &splats->clips[at++] : NULL;
    for (int k = 0; k < 32; k++) {
      double u = cutoff * cos(k * 0.19634954), v = cutoff * sin(k * 0.19634954), place[3];
      int n_keeping = 0, n_lines = clip ? clip->n_lines : 0;
      for (int line = 0; line < n_lines; line++)
        n_keeping +=
            (double)clip->lines[line][0] * u + (double)clip->lines[line][1] * v + (double)clip->lines[line][2] >= 0.0;
      if (clip && (clip->operation == CONIC_CLIP_OR ? n_keeping == 0 : n_keeping < n_lines))
        continue;
      for (int axis = 0; axis < 3; axis++)
        place[axis] = (double)splats->position[axis][i] + u * (double)splats->tangent_u[axis][i] +
                      v * (double)splats->tangent_v[axis][i];
      double off = from_cube(place, &on_edge), least = fmin(fmin(place[0], place[1]), place[2]);
      double most = fmax(fmax(place[0], place[1]), place[2]);
      farthest = least < 0.0 || most > SIDE ? fmax(farthest, off) : farthest;
    }
  }
  return farthest;
}

static void check_outlines(conic_context *context, conic_splats *sharp) {
  conic_estimate_options options;
  conic_model model = {.points = *sharp};
  conic_estimate_options_init(&options);
  CHECK_OK(conic_model_to_splats(context, &options, &model, NULL));
  double round = stands_out(&model.points, (double)options.cutoff);
  CHECK_OK(conic_features_in_points(context, 0.8660254, 1, &options, &model.points));
  double clipped = stands_out(&model.points, (double)options.cutoff);
  printf("outlines stand out by %.2f spacings, clipped by %.2f\n", round, clipped);
  CHECK(round > 2.0 && clipped < 1.1);
  *sharp = model.points;
}

static void check_cube(conic_context *context) {
  conic_splats cube = noisy_cube(context, 0.3), round, sharp, again;
  cube_errors blunt = project_cube(context, &cube, 0, CONIC_ISA_AUTO, &round);
  cube_errors kept = project_cube(context, &cube, 1, CONIC_ISA_AUTO, &sharp);
  printf("noise of 0.3 spacings: edges off by %.3f, sharp %.3f; faces by %.3f, sharp %.3f; %zu, %zu of %d points\n",
         blunt.edges, kept.edges, blunt.faces, kept.faces, blunt.n, kept.n, N_POINTS);
  CHECK(kept.edges < 0.15 && kept.edges < 0.6 * blunt.edges);
  CHECK(kept.faces <= blunt.faces);
  CHECK(kept.n >= N_POINTS * 99 / 100);
  printf("%zu points are off by more than half a spacing\n", kept.n_strays);
  CHECK(kept.n_strays <= N_POINTS / 1000);
  conic_context *one = check_context(1);
  project_cube(one, &cube, 1, CONIC_ISA_SCALAR, &again);
  CHECK(are_same(&again, &sharp));
  conic_splats_release(one, &again);
  conic_context_destroy(one);
  check_outlines(context, &sharp);
  conic_splats_release(context, &round);
  conic_splats_release(context, &sharp);
  conic_splats_release(context, &cube);
}

/* Without noise, a sample nearer to an edge than a sixth of a spacing may be taken for one of the other side. */
static void check_clean_cube(conic_context *context) {
  conic_splats cube = noisy_cube(context, 0.0), sharp;
  cube_errors errors = project_cube(context, &cube, 1, CONIC_ISA_AUTO, &sharp);
  printf("without noise: edges off by %.2g, %zu points\n", errors.edges, errors.n);
  CHECK(errors.edges < 0.1 && errors.n == N_POINTS);
  conic_splats_release(context, &sharp);
  conic_splats_release(context, &cube);
}

static void check_smooth(conic_context *context) {
  conic_splats torus = shape_sample(context, SHAPE_TORUS, IS_SANITIZED ? 1500 : 6000, 0.3, 4), results[2];
  for (int is_sharp = 0; is_sharp < 2; is_sharp++) {
    conic_surface_options options;
    conic_surface_options_init(&options);
    options.is_sharp = (uint64_t)is_sharp;
    conic_surface *surface = shape_surface(context, &torus, &options);
    CHECK_OK(conic_surface_clean(surface, &results[is_sharp], NULL));
    conic_surface_destroy(surface);
  }
  CHECK(are_same(&results[0], &results[1]));
  for (int i = 0; i < 2; i++)
    conic_splats_release(context, &results[i]);
  conic_splats_release(context, &torus);
}

int main(void) {
  conic_context *context = check_context(2);
  check_cube(context);
  if (!IS_SANITIZED)
    check_clean_cube(context);
  check_smooth(context);
  conic_context_destroy(context);
  return check_result();
}
