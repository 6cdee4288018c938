/* One choice of an instruction set holds for everything that a context does, but where a call's options name another;
 * and what it makes is the same. */
#include "core/lanes/instruction_sets.h"

#include "tests/support/octree_fixture.h"

enum { N_SPLATS = 6000 };

static conic_context *pinned_context(conic_isa isa) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  CHECK(options.isa == CONIC_ISA_AUTO);
  options.isa = isa;
  options.threads = 1;
  if (conic_context_create(&options, &context) != CONIC_OK)
    exit(1);
  return context;
}

/* All that differs with the context: the octree of the splats, what is chosen from it, and the picture. */
typedef struct made {
  uint64_t hash[CONIC_N_PLANES];
  size_t n_nodes;
  float error[N_SPLATS], radius[N_SPLATS];
  char isa[16];
} made;

/* A fixture in the pinned context. */
static fixture open_pinned(conic_isa isa) {
  fixture f = fixture_open(1);
  fixture_close(&f);
  f.context = pinned_context(isa);
  CHECK_OK(conic_renderer_create(f.context, &f.renderer));
  memset(&f.splats, 0, sizeof f.splats);
  memset(&f.image, 0, sizeof f.image);
  fixture_scene(&f, CONIC_SCENE_TERRAIN, N_SPLATS);
  octree_frame(&f, 120, 30, 40, 1.0);
  return f;
}

static made make(conic_isa isa) {
  static made m;
  conic_selection selection = {0};
  fixture f = open_pinned(isa);
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  memset(&m, 0, sizeof m);
  octree_select(octree, &f, 3.0, 0, &selection);
  octree_draw(&f, octree, &selection);
  m.n_nodes = octree->n_nodes;
  CHECK(m.n_nodes > 100 && m.n_nodes <= N_SPLATS && selection.n_inner > 0);
  memcpy(m.error, octree->error, m.n_nodes * sizeof *m.error);
  memcpy(m.radius, octree->radius, m.n_nodes * sizeof *m.radius);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    m.hash[plane] = conic_image_hash(&f.image, (conic_plane)plane);
  snprintf(m.isa, sizeof m.isa, "%s", f.statistics.isa);
  conic_selection_release(f.context, &selection);
  conic_octree_destroy(octree);
  fixture_close(&f);
  return m;
}

static void check_pinned(void) {
  const made best = make(CONIC_ISA_AUTO);
  CHECK(strcmp(best.isa, conic_isa_name(conic_isa_best())) == 0);
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    if (!conic_isa_is_here((conic_isa)isa))
      continue;
    made pinned = make((conic_isa)isa);
    CHECK(strcmp(pinned.isa, conic_isa_name((conic_isa)isa)) == 0);
    memcpy(pinned.isa, best.isa, sizeof pinned.isa);
    CHECK(memcmp(&pinned, &best, sizeof best) == 0);
  }
}

static void check_choice(void) {
  conic_context *context = pinned_context(CONIC_ISA_SCALAR);
  conic_isa chosen;
  CHECK_OK(conic_isa_choose(context, CONIC_ISA_AUTO, &chosen));
  CHECK(chosen == CONIC_ISA_SCALAR);
  CHECK_OK(conic_isa_choose(context, conic_isa_best(), &chosen));
  CHECK(chosen == conic_isa_best());
  CHECK(conic_isa_choose(context, CONIC_N_ISAS, &chosen) == CONIC_ERROR_UNSUPPORTED && chosen == CONIC_ISA_SCALAR);
  CHECK(conic_isa_is_here(CONIC_ISA_AUTO) && conic_isa_is_here(CONIC_ISA_SCALAR) &&
        conic_isa_is_here(conic_isa_best()));
  CHECK(!conic_isa_is_here(CONIC_ISA_NEON) || !conic_isa_is_here(CONIC_ISA_SSE2));
  CHECK(!conic_isa_name(CONIC_N_ISAS));
  conic_context_destroy(context);
}

/* What this machine has not got is refused by all that has such loops. */
static void check_absent(void) {
  const conic_isa absent = conic_isa_is_here(CONIC_ISA_NEON) ? CONIC_ISA_SSE2 : CONIC_ISA_NEON;
  fixture f = open_pinned(CONIC_ISA_AUTO);
  conic_octree *octree = octree_build(f.context, &f.splats, 0), *none;
  conic_surface *surface;
  conic_contributions *contributions;
  conic_selection selection = {0};
  conic_selection_options selecting;
  conic_octree_options building;
  conic_splats copy = octree_copy(f.context, &f.splats);
  conic_context *context = pinned_context(absent);
  conic_selection_options_init(&selecting);
  conic_octree_options_init(&building);
  CHECK(conic_surface_create(context, &f.splats, NULL, &surface) == CONIC_ERROR_UNSUPPORTED && !surface);
  CHECK(conic_octree_build(context, &copy, &building, &none) == CONIC_ERROR_UNSUPPORTED && !none);
  CHECK(conic_contributions_create(context, &f.splats, &f.camera, &f.options, &contributions) ==
        CONIC_ERROR_UNSUPPORTED);
  f.options.isa = absent;
  CHECK(conic_octree_select(octree, &f.camera, &f.options, &selecting, &selection) == CONIC_ERROR_UNSUPPORTED);
  CHECK_OK(conic_image_allocate(f.context, f.camera.width, f.camera.height, ALL_PLANES, &f.image));
  CHECK(conic_render(f.renderer, &f.splats, &f.camera, &f.options, &f.image, &f.statistics) == CONIC_ERROR_UNSUPPORTED);
  conic_selection_release(f.context, &selection);
  conic_octree_destroy(octree);
  conic_context_destroy(context);
  fixture_close(&f);
}

int main(void) {
  check_choice();
  check_pinned();
  check_absent();
  return check_result();
}
