/* .chy files: what is written is read, to the bit, and draws the same picture; what was spoiled is refused, also where
 * its sums were made right again, or can be used; what was built is sound. */
#include "core/base/byte_order.h"
#include "lod/hybrid/hybrid_layout.h"
#include "tests/support/files.h"
#include "tests/support/hybrid_fixture.h"
#include "tests/support/random_numbers.h"
#include "tests/support/seeds.h"

static conic_hybrid *build(conic_context *context, size_t side, double phase2, int with_colors) {
  conic_hybrid_options options;
  conic_hybrid_report report;
  conic_triangles mesh;
  conic_hybrid *hybrid;
  hybrid_terrain(context, side, &mesh);
  if (with_colors) {
    conic_triangles colored;
    CHECK_OK(conic_triangles_allocate(context, mesh.count, mesh.n_vertices,
                                      CONIC_TRIANGLES_COLORS | CONIC_TRIANGLES_NORMALS, &colored));
    memcpy(colored.corners, mesh.corners, mesh.count * sizeof *mesh.corners);
    for (int axis = 0; axis < 3; axis++) {
      memcpy(colored.position[axis], mesh.position[axis], mesh.n_vertices * sizeof(float));
      for (size_t i = 0; i < mesh.n_vertices; i++) {
        colored.color[axis][i] = 0.5f + 0.5f * (float)sin(7.0 * (double)mesh.position[axis][i]);
        colored.normal[axis][i] = axis == 1 ? 1.0f : 0.1f;
      }
      colored.origin[axis] = 1e6 * axis;
    }
    conic_triangles_release(context, &mesh);
    mesh = colored;
  }
  conic_hybrid_options_init(&options);
  options.phase2 = phase2;
  options.most_error = 0.0; /* all that were gathered are surfels */
  CHECK_OK(conic_hybrid_build(context, &mesh, &options, &hybrid, &report));
  CHECK(mesh.count == 0 && !mesh.corners);
  CHECK(report.n_faces == 2 * side * side && report.nan + report.zero + report.crowded + report.twisted == 0);
  CHECK(report.open == 4 * side && report.n_pieces == 1);
  return hybrid;
}

/* The picture of a selection: hashes of what is drawn. */
static uint64_t picture(conic_context *context, const conic_hybrid *hybrid, double error_px) {
  conic_hybrid_info info;
  conic_hybrid_selection selection;
  conic_hybrid_view view;
  conic_render_options options;
  conic_renderer *renderer;
  conic_camera camera;
  conic_image image;
  memset(&selection, 0, sizeof selection);
  conic_render_options_init(&options);
  conic_hybrid_view_init(&view);
  view.error_px = error_px;
  CHECK_OK(conic_hybrid_describe(hybrid, &info));
  hybrid_look(context, 17, 120, 1.0, info.minimum, info.maximum, &camera);
  CHECK_OK(conic_hybrid_select(hybrid, &camera, &options, &view, &selection));
  CHECK(selection.n_clusters[0] + selection.n_clusters[1] + selection.n_joined + selection.n_culled == info.n_clusters);
  CHECK_OK(conic_image_allocate(context, 120, 120, CONIC_DRAWN_PLANES | 1u << CONIC_PLANE_CLUSTER, &image));
  CHECK_OK(conic_renderer_create(context, &renderer));
  const conic_drawing drawing = {&selection.splats, &selection.triangles};
  CHECK_OK(conic_render_drawing(context, renderer, &drawing, &camera, &options, 1, &image, NULL));
  conic_hybrid_name(&selection, &image);
  const uint32_t *id = image.planes[CONIC_PLANE_ID], *cluster = image.planes[CONIC_PLANE_CLUSTER];
  size_t n_covered = 0;
  for (size_t i = 0; i < 120 * 120; i++) {
    CHECK((id[i] == CONIC_NO_ID) == (cluster[i] == CONIC_NO_ID));
    CHECK(id[i] == CONIC_NO_ID || cluster[i] < info.n_clusters + info.n_nodes);
    n_covered += id[i] != CONIC_NO_ID;
  }
  CHECK(n_covered > 2000);
  uint64_t hash = 0;
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    hash = hash * 31 + conic_image_hash(&image, (conic_plane)plane);
  conic_image_release(context, &image);
  conic_renderer_destroy(renderer);
  conic_hybrid_selection_release(context, &selection);
  return hash;
}

static void check_sound(const conic_hybrid *hybrid) {
  conic_hybrid_defects defects;
  CHECK_OK(conic_hybrid_check(hybrid, &defects));
  CHECK(defects.values + defects.spheres + defects.cones + defects.levels == 0);
}

static void test_there_and_back(conic_context *context, double phase2, int with_colors) {
  const char *path = files_path("made.chy"), *again = files_path("again.chy");
  conic_hybrid *hybrid = build(context, 24, phase2, with_colors), *back;
  conic_hybrid_info info, info_back;
  CHECK_OK(conic_hybrid_write(hybrid, path));
  CHECK(conic_hybrid_is_file(path) && !conic_octree_is_file(path));
  CHECK_OK(conic_hybrid_read(context, path, &back));
  CHECK_OK(conic_hybrid_describe(hybrid, &info));
  CHECK_OK(conic_hybrid_describe(back, &info_back));
  CHECK(memcmp(&info, &info_back, sizeof info) == 0);
  CHECK(info.n_triangles + info.n_surfels > 0 && info.n_clusters >= 1);
  CHECK((info.n_surfel_clusters > 0) == (phase2 > -2.0));
  check_sound(hybrid);
  check_sound(back);
  CHECK(picture(context, hybrid, 0.0) == picture(context, back, 0.0));
  CHECK(picture(context, hybrid, 1.0) == picture(context, back, 1.0));
  CHECK(picture(context, hybrid, 15.0) == picture(context, back, 15.0)); /* by nodes */
  CHECK_OK(conic_hybrid_write(back, again));
  unsigned char *first = malloc(info.n_bytes + 1), *second = malloc(info.n_bytes + 1);
  FILE *files[2] = {fopen(path, "rb"), fopen(again, "rb")};
  if (!first || !second || !files[0] || !files[1])
    exit(1);
  CHECK(fread(first, 1, info.n_bytes + 1, files[0]) == info.n_bytes);
  CHECK(fread(second, 1, info.n_bytes + 1, files[1]) == info.n_bytes);
  CHECK(memcmp(first, second, info.n_bytes) == 0);
  fclose(files[0]);
  fclose(files[1]);
  free(first);
  free(second);
  conic_hybrid_destroy(back);
  conic_hybrid_destroy(hybrid);
  CHECK(unlink(path) == 0 && unlink(again) == 0);
}

/* Threads change nothing of what is built. */
static void test_threads(void) {
  uint64_t sums[2];
  for (int i = 0; i < 2; i++) {
    conic_context *context = check_context(i ? 3 : 1);
    conic_hybrid *hybrid = build(context, 40, 0.4, 0);
    sums[i] = conic_checksum(hybrid->owned, (size_t)conic_hybrid_file_bytes(hybrid));
    conic_hybrid_destroy(hybrid);
    conic_context_destroy(context);
  }
  CHECK(sums[0] == sums[1]);
}

/* A model with vertices left out along its clusters' borders. */
static void add_hill(seed_set *set, conic_context *context) {
  const char *path = files_path("hill.chy");
  conic_hybrid *hybrid = build(context, 24, -2.0, 0);
  size_t n_bytes = (size_t)conic_hybrid_file_bytes(hybrid);
  CHECK(hybrid->n_borders > 4 && hybrid->n_slots > 10);
  CHECK_OK(conic_hybrid_write(hybrid, path));
  unsigned char *bytes = malloc(n_bytes);
  FILE *file = fopen(path, "rb");
  CHECK(bytes && file && fread(bytes, 1, n_bytes, file) == n_bytes);
  if (file)
    fclose(file);
  CHECK(unlink(path) == 0);
  seeds_add(set, "chy", "chy", 0, bytes, n_bytes);
  free(bytes);
  conic_hybrid_destroy(hybrid);
}

/* Slots and borders are a small part of a file: half of the changes are to them. */
static size_t place_to_change(uint64_t *state, const unsigned char *bytes, size_t n_bytes) {
  size_t from = 8;
  if (random_unit(state) < 0.5) {
    conic_chy_header h = {.n_slots = conic_load_64(bytes + 160), .n_borders = conic_load_64(bytes + 168)};
    size_t n_chains =
        (size_t)h.n_slots * sizeof(conic_cluster_slot) + (size_t)h.n_borders * sizeof(conic_cluster_border);
    from = n_chains < n_bytes - 8 ? n_bytes - n_chains - 8 : 8;
  }
  return from + (size_t)(random_unit(state) * (double)(n_bytes - from));
}

/* A byte is changed and the sums made right: it is refused, or it can be drawn. */
static void test_mended(conic_context *context) {
  seed_set *set = calloc(1, sizeof *set);
  uint64_t state = 3;
  if (!set)
    exit(1);
  seeds_hybrid(set, context, 0);
  seeds_hybrid(set, context, 1);
  add_hill(set, context);
  int n_refused = 0;
  for (int i = 0; i < set->n; i++) {
    const seed *from = &set->seeds[i];
    unsigned char *bytes = malloc(from->n_bytes);
    for (int run = 0; run < 1500 && bytes; run++) {
      conic_hybrid *hybrid;
      memcpy(bytes, from->bytes, from->n_bytes);
      size_t at = place_to_change(&state, from->bytes, from->n_bytes);
      bytes[at] = (unsigned char)(random_unit(&state) * 256.0);
      conic_hybrid_mend(bytes, from->n_bytes);
      const char *path = files_write_bytes("mended.chy", bytes, from->n_bytes);
      conic_status status = conic_hybrid_read(context, path, &hybrid);
      CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT);
      n_refused += status != CONIC_OK;
      if (status == CONIC_OK) {
        conic_hybrid_defects defects;
        conic_hybrid_selection selection;
        conic_hybrid_view view;
        conic_render_options options;
        conic_camera camera;
        const double low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
        memset(&selection, 0, sizeof selection);
        conic_render_options_init(&options);
        conic_hybrid_view_init(&view);
        view.error_px = run % 3 == 2 ? 20.0 : (double)(run % 3);
        options.near_z = 0.01;
        hybrid_look(context, 3, 40, 1.0, low, high, &camera);
        CHECK_OK(conic_hybrid_check(hybrid, &defects));
        CHECK_OK(conic_hybrid_select(hybrid, &camera, &options, &view, &selection));
        CHECK_OK(conic_triangles_check(context, &selection.triangles, "selection"));
        conic_hybrid_selection_release(context, &selection);
        conic_hybrid_destroy(hybrid);
      }
      CHECK(unlink(path) == 0);
    }
    free(bytes);
  }
  seeds_release(set);
  CHECK(n_refused > 100);
}

/* What cannot be made a model of. */
static void test_refused(conic_context *context) {
  conic_hybrid_options options;
  conic_triangles mesh;
  conic_hybrid *hybrid;
  conic_hybrid_options_init(&options);
  CHECK_OK(conic_triangles_allocate(context, 1, 3, 0, &mesh));
  for (int axis = 0; axis < 3; axis++)
    memset(mesh.position[axis], 0, 3 * sizeof(float));
  for (uint32_t corner = 0; corner < 3; corner++)
    mesh.corners[0][corner] = corner;
  CHECK(conic_hybrid_build(context, &mesh, &options, &hybrid, NULL) == CONIC_ERROR_INPUT && !hybrid);
  hybrid_terrain(context, 4, &mesh);
  mesh.corners[3][1] = 1000;
  CHECK(conic_hybrid_build(context, &mesh, &options, &hybrid, NULL) != CONIC_OK && !hybrid);
  hybrid_terrain(context, 4, &mesh);
  options.density = -1.0;
  CHECK(conic_hybrid_build(context, &mesh, &options, &hybrid, NULL) == CONIC_ERROR_ARGUMENT && !hybrid);
}

int main(void) {
  conic_context *context = files_context();
  test_there_and_back(context, 0.4, 0);
  test_there_and_back(context, -2.0, 1);
  test_there_and_back(context, 1e6, 1);
  test_threads();
  test_mended(context);
  test_refused(context);
  files_end(context);
  return check_result();
}
