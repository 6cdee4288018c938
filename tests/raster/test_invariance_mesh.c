/* One image, one set of bits, of meshes and of hybrid models: over threads, tile sizes, instruction sets and passes;
 * and the models themselves over threads. */
#include "core/lanes/instruction_sets.h"
#include "lod/hybrid/model/hybrid_model.h"
#include "tests/support/hybrid_fixture.h"
#include "tests/support/triangle_fixture.h"

enum { WIDTH = 190, HEIGHT = 130, N_PASSES = 2 };

/* What is drawn. */
enum { MESH, MIXED, BUILT, JOINED, SURFELS, N_SCENES };

typedef struct model {
  conic_hybrid *hybrid;
  conic_hybrid_info info;
  conic_hybrid_selection selection;
  conic_triangles mesh;
} model;

typedef struct hashes {
  uint64_t planes[CONIC_N_PLANES];
} hashes;

/* A terrain with colours and a picture on it, in map coordinates. */
static conic_triangles make_mesh(fixture *f, size_t side) {
  conic_triangles plain;
  hybrid_terrain(f->context, side, &plain);
  conic_triangles mesh =
      triangles_make(f, plain.count, plain.n_vertices, CONIC_TRIANGLES_COLORS | CONIC_TRIANGLES_TEXTURE_COORDINATES);
  memcpy(mesh.corners, plain.corners, plain.count * sizeof *plain.corners);
  for (int axis = 0; axis < 3; axis++) {
    mesh.origin[axis] = 230000.25 * axis;
    for (size_t i = 0; i < plain.n_vertices; i++) {
      mesh.position[axis][i] = plain.position[axis][i];
      mesh.color[axis][i] = 0.3f + 0.7f * plain.position[(axis + 2) % 3][i];
    }
  }
  for (size_t i = 0; i < plain.n_vertices; i++) {
    mesh.texture_coordinate[0][i] = 3.0f * plain.position[0][i];
    mesh.texture_coordinate[1][i] = 2.0f * plain.position[2][i];
  }
  conic_triangles_release(f->context, &plain);
  CHECK_OK(conic_triangles_texture(f->context, &mesh, triangles_make_texture(f)));
  return mesh;
}

static model open_model(fixture *f) {
  model m;
  conic_triangles given = make_mesh(f, 40);
  conic_hybrid_options options;
  memset(&m, 0, sizeof m);
  m.mesh = make_mesh(f, 40);
  conic_hybrid_options_init(&options);
  options.most_error = 0.0; /* its colours change so fast that else there would be no surfels */
  CHECK_OK(conic_hybrid_build(f->context, &given, &options, &m.hybrid, NULL));
  CHECK_OK(conic_hybrid_describe(m.hybrid, &m.info));
  f->options.near_z = m.info.near_z;
  hybrid_look(f->context, 10, WIDTH, 1.3, m.info.minimum, m.info.maximum, &f->camera);
  f->camera.height = HEIGHT;
  f->camera.cy -= 0.5 * (WIDTH - HEIGHT);
  fixture_scene(f, CONIC_SCENE_SPHERE, 3000); /* about a corner of the terrain, and smaller */
  for (int axis = 0; axis < 3; axis++) {
    f->splats.origin[axis] = m.mesh.origin[axis] + (axis == 1 ? 0.0 : 0.8);
    for (size_t i = 0; i < f->splats.count; i++) {
      f->splats.position[axis][i] *= 0.25f;
      f->splats.tangent_u[axis][i] *= 0.25f;
      f->splats.tangent_v[axis][i] *= 0.25f;
    }
  }
  return m;
}

static void close_model(fixture *f, model *m) {
  conic_hybrid_selection_release(f->context, &m->selection);
  conic_hybrid_destroy(m->hybrid);
  conic_triangles_release(f->context, &m->mesh);
}

static conic_drawing choose(fixture *f, model *m, int scene) {
  conic_hybrid_view view;
  if (scene == MESH || scene == MIXED)
    return (conic_drawing){scene == MIXED ? &f->splats : NULL, &m->mesh};
  conic_hybrid_view_init(&view);
  view.error_px = scene == JOINED ? 12.0 : 0.0; /* for which nodes stand for patches */
  view.color_error = HUGE_VAL;
  view.only_kind = scene == SURFELS ? CONIC_HYBRID_SURFELS : -1;
  CHECK_OK(conic_hybrid_select(m->hybrid, &f->camera, &f->options, &view, &m->selection));
  return (conic_drawing){&m->selection.splats, &m->selection.triangles};
}

static hashes draw(fixture *f, model *m, int scene) {
  hashes found;
  const conic_drawing drawing = choose(f, m, scene);
  int is_hybrid = scene >= BUILT;
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, WIDTH, HEIGHT, ALL_PLANES | (is_hybrid ? 1u << CONIC_PLANE_CLUSTER : 0u),
                                &f->image));
  CHECK_OK(
      conic_render_drawing(f->context, f->renderer, &drawing, &f->camera, &f->options, 1, &f->image, &f->statistics));
  if (is_hybrid)
    conic_hybrid_name(&m->selection, &f->image);
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    found.planes[plane] = conic_image_hash(&f->image, (conic_plane)plane);
  return found;
}

static void check_same(const hashes *expected, const hashes *found, int scene, const char *variant, int value) {
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    if (expected->planes[plane] != found->planes[plane]) {
      fprintf(stderr, "scene %d, %s %d: plane %s differs\n", scene, variant, value,
              conic_plane_describe((conic_plane)plane)->name);
      check_failures++;
    }
}

static void check_instruction_sets(fixture *f, model *m, int scene, const hashes *expected) {
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    if (!conic_isa_is_here((conic_isa)isa))
      continue;
    f->options.isa = (conic_isa)isa;
    hashes found = draw(f, m, scene);
    check_same(expected, &found, scene, "instruction set", isa);
  }
  f->options.isa = CONIC_ISA_AUTO;
}

/* That the scenes are what they should be: both kinds are seen, but where there is only one, and nodes where they must
 * be. */
static void check_contents(const fixture *f, const model *m, int scene) {
  const conic_render_statistics *s = &f->statistics;
  CHECK(s->pixels_covered > 2000);
  CHECK((s->splats_drawn > 50) == (scene != MESH));
  CHECK((s->triangles_drawn > 50) == (scene != SURFELS && scene != JOINED));
  CHECK(scene != JOINED || m->selection.n_joined > 0);
}

int main(void) {
  static const int thread_counts[] = {1, 2, 7}, tiles[] = {64, 16, 32, 8};
  hashes expected[N_SCENES][N_PASSES];
  uint64_t expected_sum = 0;
  for (int t = 0; t < 3; t++) {
    fixture f = fixture_open(thread_counts[t]);
    f.options.shading = CONIC_SHADE_PHONG;
    model m = open_model(&f);
    uint64_t sum = conic_checksum(m.hybrid->owned, (size_t)m.info.n_bytes);
    expected_sum = t == 0 ? sum : expected_sum;
    CHECK(sum == expected_sum);
    for (int variant = 0; variant < N_SCENES * N_PASSES; variant++) {
      int scene = variant / N_PASSES, i_passes = variant % N_PASSES;
      hashes *wanted = &expected[scene][i_passes];
      f.options.passes = i_passes ? 1 : 3;
      for (int i = 0; i < (t == 0 ? 4 : 2); i++) {
        f.options.tile = tiles[i];
        hashes found = draw(&f, &m, scene);
        if (t == 0 && i == 0) {
          *wanted = found;
          check_contents(&f, &m, scene);
          check_instruction_sets(&f, &m, scene, wanted);
        }
        check_same(wanted, &found, scene, t == 0 ? "tile" : "threads", t == 0 ? tiles[i] : thread_counts[t]);
      }
    }
    close_model(&f, &m);
    fixture_close(&f);
  }
  for (int scene = 0; scene < N_SCENES; scene++) /* no scene is another one by chance */
    for (int other = 0; other < scene; other++)
      CHECK(expected[scene][0].planes[CONIC_PLANE_RGBA] != expected[other][0].planes[CONIC_PLANE_RGBA]);
  return check_result();
}
