/* Splats that all lie on one another, of which each could cover each: what a node looks at is bounded, alike in all
 * instruction sets; and whoever waits for the octree may stop it at any time. */
#include "tests/support/octree_fixture.h"

enum { N_SPLATS = 20000 };

typedef struct listener {
  int n_calls[3]; /* within splitting, fitting and finding errors, not only between them */
  double stop_at; /* answers so from there on */
} listener;

static int listen(void *cookie, const char *task, double fraction) {
  static const double stages[3][2] = {{0.1, 0.3}, {0.4, 0.6}, {0.6, 0.9}};
  listener *heard = cookie;
  if (strcmp(task, "octree") != 0)
    return 0;
  for (int i = 0; i < 3; i++)
    heard->n_calls[i] += fraction > stages[i][0] && fraction < stages[i][1];
  return fraction >= heard->stop_at;
}

static conic_context *open_context(conic_isa isa, int threads, listener *heard) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.isa = isa;
  options.threads = threads;
  options.progress = listen;
  options.progress_cookie = heard;
  if (conic_context_create(&options, &context) != CONIC_OK)
    exit(1);
  return context;
}

/* Of all sizes, tilted all ways. */
static conic_splats make_pile(conic_context *context, size_t count) {
  conic_splats splats;
  uint64_t state = 5;
  CHECK_OK(conic_splats_allocate(context, count, CONIC_SPLATS_TANGENTS, &splats));
  for (size_t i = 0; i < count; i++)
    for (int axis = 0; axis < 3; axis++) {
      splats.position[axis][i] = 0.3f;
      splats.tangent_u[axis][i] = (float)(0.1 * fixture_random(&state) - 0.05);
      splats.tangent_v[axis][i] = (float)(0.1 * fixture_random(&state) - 0.05);
    }
  return splats;
}

static void test_instruction_sets(void) {
  listener heard = {.stop_at = 2.0};
  conic_context *plain = open_context(CONIC_ISA_SCALAR, 2, &heard), *best = open_context(CONIC_ISA_AUTO, 1, &heard);
  conic_splats pile = make_pile(plain, N_SPLATS);
  conic_octree *a = octree_build(plain, &pile, 0), *b = octree_build(best, &pile, 0);
  CHECK(a->n_nodes == b->n_nodes);
  CHECK(memcmp(a->codes, b->codes, a->n_nodes * CONIC_NODE_BYTES) == 0);
  octree_check_sound(a);
  conic_octree_destroy(a);
  conic_octree_destroy(b);
  conic_splats_release(plain, &pile);
  conic_context_destroy(plain);
  conic_context_destroy(best);
}

static void test_stopping(void) {
  listener heard = {.stop_at = 2.0};
  conic_context *context = open_context(CONIC_ISA_AUTO, 1, &heard);
  conic_splats pile = make_pile(context, 5 * N_SPLATS);
  conic_octree *octree = octree_build(context, &pile, 0);
  for (int i = 0; i < 3; i++)
    CHECK(heard.n_calls[i] >= 5);
  conic_octree_destroy(octree);
  for (int i = 0; i < 3; i++) {
    static const double places[3] = {0.2, 0.5, 0.75};
    conic_splats copy = octree_copy(context, &pile);
    conic_octree_options options;
    conic_octree_options_init(&options);
    heard = (listener){.stop_at = places[i]};
    CHECK(conic_octree_build(context, &copy, &options, &octree) == CONIC_ERROR_CANCELLED && !octree);
    CHECK(heard.n_calls[i] >= 1);
  }
  conic_splats_release(context, &pile);
  conic_context_destroy(context);
}

int main(void) {
  test_instruction_sets();
  test_stopping();
  return check_result();
}
