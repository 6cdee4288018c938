/* How far places are from a mesh, by its tree and by asking every face; faces at the same places count once. */
#include "lod/mesh/face_tree.h"
#include "lod/mesh/mesh.h"
#include "tests/support/check.h"
#include "tests/support/random_numbers.h"

enum { N_OWN = 60, N_TWINS = 20, N_FACES = N_OWN * N_TWINS, N_VERTICES = 2 * 30, N_PLACES = 400 };

typedef struct soup {
  float position[3][N_VERTICES];
  uint32_t faces[N_FACES][3];
  conic_mesh mesh;
} soup;

static uint32_t random_below(uint64_t *state, uint32_t n) {
  return (uint32_t)(random_unit(state) * (double)n);
}

/* Each vertex is there twice, at one place. Every face but the first of its kind begins with any corner, is wound
 * either way, and takes either of the vertices. */
static void fill(soup *s, uint64_t *state) {
  const uint32_t half = N_VERTICES / 2;
  for (int axis = 0; axis < 3; axis++)
    for (uint32_t i = 0; i < half; i++)
      s->position[axis][i] = s->position[axis][i + half] = (float)random_unit(state);
  for (uint32_t own = 0; own < N_OWN; own++) {
    const uint32_t first = own % half, second = (first + 1 + own / half) % half, third = (second + 5) % half;
    const uint32_t corners[3] = {first, second, third};
    for (int twin = 0; twin < N_TWINS; twin++) {
      uint32_t begin = random_below(state, 3), step = 1 + random_below(state, 2);
      for (uint32_t corner = 0; corner < 3; corner++)
        s->faces[own + (uint32_t)twin * N_OWN][corner] =
            corners[(begin + step * corner) % 3] + half * random_below(state, 2);
    }
  }
  s->mesh = (conic_mesh){.n_vertices = N_VERTICES,
                         .n_faces = N_FACES,
                         .position = {s->position[0], s->position[1], s->position[2]},
                         .faces = (const uint32_t(*)[3])s->faces};
}

static double distance_of_face(const conic_mesh *mesh, size_t face, const double at[3]) {
  double corners[3][3];
  for (int corner = 0; corner < 3; corner++)
    conic_mesh_corner(mesh, face, corner, corners[corner]);
  return sqrt(conic_distance2_to_triangle(at, corners[0], corners[1], corners[2]));
}

static double distance_of_all(const conic_mesh *mesh, const double at[3]) {
  double least = HUGE_VAL;
  for (size_t i = 0; i < mesh->n_faces; i++) {
    double distance = distance_of_face(mesh, i, at);
    least = distance < least ? distance : least;
  }
  return least;
}

static void check_place(const conic_face_tree *tree, const double at[3], uint32_t guess) {
  double distance = distance_of_all(tree->mesh, at);
  for (int k = 0; k < 4; k++) {
    double enough = distance * (0.4 + 0.4 * k);
    int is_farther = enough < distance;
    uint32_t near = guess;
    double found = conic_face_tree_farther(tree, at, enough), bound = conic_face_tree_bound(tree, at, &near, enough);
    CHECK_NEAR(found, is_farther ? distance : enough, 1e-12);
    CHECK_NEAR(conic_face_tree_farther_by(tree, at, guess, enough), is_farther ? distance : enough, 1e-12);
    CHECK(bound >= distance - 1e-12 && bound <= (is_farther ? distance + 1e-12 : enough));
    CHECK_NEAR(distance_of_face(tree->mesh, near, at), bound, 1e-12);
  }
}

int main(void) {
  conic_context *context = check_context(1);
  static soup s;
  conic_adjacency adjacency;
  conic_face_tree tree;
  uint64_t state = 3;
  fill(&s, &state);
  CHECK_OK(conic_adjacency_find(context, &s.mesh, &adjacency));
  CHECK_OK(conic_face_tree_build(context, &s.mesh, &adjacency, &tree));
  CHECK(tree.n_faces == N_OWN);
  for (size_t i = 0; i < tree.n_faces; i++)
    CHECK(tree.faces[i] < N_OWN); /* the first of its kind */
  for (int i = 0; i < N_PLACES; i++) {
    double at[3];
    for (int axis = 0; axis < 3; axis++)
      at[axis] = 2.0 * random_unit(&state) - 0.5;
    check_place(&tree, at, random_below(&state, N_FACES));
  }
  conic_face_tree_release(context, &tree);
  conic_adjacency_release(context, &adjacency);
  conic_context_destroy(context);
  return check_result();
}
