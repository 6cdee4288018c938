/* .chy files: what is written is read, to the bit, and draws the same picture; what was spoiled is refused, also where
 * its sums were made right again, or can be used; what was built is sound. */
#include "core/base/byte_order.h"
#include "lod/hybrid/model/hybrid_chunks.h"
#include "lod/hybrid/model/hybrid_layout.h"
#include "tests/support/files.h"
#include "tests/support/hybrid_fixture.h"
#include "tests/support/mend.h"
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

/* The picture of a selection: hashes of what is drawn; by an error, a budget of surfels and triangles, or as built; and
 * what reading it took. */
static uint64_t picture_of(conic_context *context, const conic_hybrid *hybrid, double error_px, uint64_t budget,
                           conic_hybrid_selection *read) {
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
  view.budget = budget;
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
  *read = selection;
  conic_hybrid_selection_release(context, &selection);
  return hash;
}

static uint64_t picture(conic_context *context, const conic_hybrid *hybrid, double error_px) {
  conic_hybrid_selection read;
  return picture_of(context, hybrid, error_px, 0, &read);
}

static conic_status select_as_built(conic_context *context, const conic_hybrid *hybrid) {
  conic_hybrid_selection selection = {.scratch = NULL};
  conic_hybrid_view view;
  conic_render_options options;
  conic_hybrid_info info;
  conic_camera camera;
  conic_render_options_init(&options);
  conic_hybrid_view_init(&view);
  CHECK_OK(conic_hybrid_describe(hybrid, &info));
  hybrid_look(context, 17, 120, 1.0, info.minimum, info.maximum, &camera);
  conic_status status = conic_hybrid_select(hybrid, &camera, &options, &view, &selection);
  conic_hybrid_selection_release(context, &selection);
  return status;
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

/* A model with vertices left out along its clusters' borders; they are a small part of it: what is changed are then its
 * first chunks. */
static void add_hill(seed_set *set, conic_context *context, size_t *first, size_t *n) {
  const char *path = files_path("hill.chy");
  conic_hybrid *hybrid = build(context, 24, -2.0, 0);
  size_t n_bytes = (size_t)conic_hybrid_file_bytes(hybrid);
  conic_hybrid_place ends = conic_hybrid_chunk_place(hybrid, 0);
  for (uint32_t i = 0; i < hybrid->n_clusters; i++)
    if (hybrid->clusters[i].n_slots > 0)
      ends = conic_hybrid_chunk_place(hybrid, conic_hybrid_ends_chunk(hybrid, i));
  CHECK(hybrid->clusters[1].n_borders > 1 && hybrid->clusters[1].n_slots > 4);
  CHECK_OK(conic_hybrid_write(hybrid, path));
  unsigned char *bytes = malloc(n_bytes);
  FILE *file = fopen(path, "rb");
  CHECK(bytes && file && fread(bytes, 1, n_bytes, file) == n_bytes);
  if (file)
    fclose(file);
  CHECK(unlink(path) == 0);
  *first = n_bytes - (size_t)hybrid->n_data;
  *n = (size_t)(ends.at + ends.n_bytes);
  seeds_add(set, "chy", "chy", 0, bytes, n_bytes);
  free(bytes);
  conic_hybrid_destroy(hybrid);
}

/* Half of the changes are to the bytes that are asked for. */
static size_t place_to_change(uint64_t *state, size_t n_bytes, size_t first, size_t n) {
  if (random_unit(state) < 0.5)
    return first + (size_t)(random_unit(state) * (double)n);
  return 8 + (size_t)(random_unit(state) * (double)(n_bytes - 8));
}

/* Of a file that is opened, pictures read what they show, and are those of the model as a whole, whatever the memory;
 * what is not damaged is drawn, too. */
static void test_parts(conic_context *context) {
  static const struct {
    double error_px;
    uint64_t budget;
  } views[] = {{15.0, 0}, {0.0, 60}, {1.0, 0}, {0.0, 2000}, {0.0, 0}, {1.0, 0}};
  static const uint64_t memories[] = {0, 7 << 19};
  const char *path = files_path("parts.chy");
  conic_hybrid *hybrid = build(context, 60, 0.4, 1), *opened;
  uint64_t n_bytes = conic_hybrid_file_bytes(hybrid);
  conic_layers_access access;
  conic_hybrid_selection read;
  CHECK_OK(conic_hybrid_write(hybrid, path));
  conic_layers_access_init(&access);
  for (size_t m = 0; m < sizeof memories / sizeof *memories; m++) {
    uint64_t n_read = 0;
    access.memory_bytes = memories[m];
    CHECK_OK(conic_hybrid_open(context, path, &access, &opened));
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
      uint64_t whole = picture_of(context, hybrid, views[i].error_px, views[i].budget, &read);
      CHECK(read.n_chunks == 0 && read.n_bytes_read == 0);
      CHECK(picture_of(context, opened, views[i].error_px, views[i].budget, &read) == whole);
      CHECK(read.n_chunks > 0 && read.n_bytes_read >= n_read && read.n_bytes_received == 0);
      CHECK(i > 0 || read.n_bytes_read < n_bytes / 4); /* far below what there is */
      CHECK(memories[m] == 0 || read.n_bytes_kept <= memories[m] / 8);
      n_read = read.n_bytes_read;
    }
    CHECK(memories[m] > 0 ? n_read > read.n_bytes_kept + 100000 : n_read < n_bytes); /* some was dropped */
    conic_hybrid_destroy(opened);
  }
  access.memory_bytes = 1 << 18; /* too little for what is drawn as built */
  CHECK_OK(conic_hybrid_open(context, path, &access, &opened));
  conic_hybrid_defects defects;
  CHECK(conic_hybrid_check(opened, &defects) == CONIC_ERROR_ARGUMENT); /* of a whole model alone */
  CHECK(select_as_built(context, opened) == CONIC_ERROR_MEMORY);
  conic_hybrid_destroy(opened);
  conic_hybrid_destroy(hybrid);
  CHECK(unlink(path) == 0);
}

/* A byte of the finest level is wrong: what does not need it is drawn. */
static void test_damaged_part(conic_context *context) {
  conic_hybrid *hybrid = build(context, 24, -2.0, 0), *opened;
  const char *path = files_path("parts.chy");
  size_t n_bytes = (size_t)conic_hybrid_file_bytes(hybrid);
  CHECK_OK(conic_hybrid_write(hybrid, path));
  uint64_t far_off = picture(context, hybrid, 15.0);
  size_t at = n_bytes - (size_t)hybrid->n_data + (size_t)conic_hybrid_chunk_place(hybrid, 0).at + 100;
  conic_hybrid_destroy(hybrid);
  FILE *file = fopen(path, "r+b");
  CHECK(file && fseek(file, (long)at, SEEK_SET) == 0 && fputs("damaged", file) >= 0);
  CHECK(file && fclose(file) == 0);
  CHECK(conic_hybrid_read(context, path, &hybrid) == CONIC_ERROR_INPUT && !hybrid);
  CHECK_OK(conic_hybrid_open(context, path, NULL, &opened));
  CHECK(picture(context, opened, 15.0) == far_off);
  CHECK(select_as_built(context, opened) == CONIC_ERROR_INPUT);
  CHECK(strstr(files_message, "cannot read chunk 0: a chunk that is damaged (at byte ") != NULL);
  CHECK(picture(context, opened, 15.0) == far_off);
  conic_hybrid_destroy(opened);
  CHECK(unlink(path) == 0);
}

/* What is opened of a file draws the same as what is read, or is refused where that is. */
static void check_opened(conic_context *context, const char *path, const conic_hybrid *read) {
  conic_hybrid *opened;
  conic_status status = conic_hybrid_open(context, path, NULL, &opened);
  CHECK(status == CONIC_OK || (status == CONIC_ERROR_INPUT && !read));
  if (status == CONIC_OK) {
    status = select_as_built(context, opened);
    CHECK(status == CONIC_OK || (status == CONIC_ERROR_INPUT && !read));
  }
  conic_hybrid_destroy(opened);
}

/* A byte is changed and the sums made right: it is refused, or it can be drawn. */
static void test_mended(conic_context *context) {
  seed_set *set = calloc(1, sizeof *set);
  uint64_t state = 3;
  if (!set)
    exit(1);
  seeds_hybrid(set, context, 0);
  seeds_hybrid(set, context, 1);
  size_t first, n;
  add_hill(set, context, &first, &n);
  int n_refused = 0;
  for (int i = 0; i < set->n; i++) {
    const seed *from = &set->seeds[i];
    unsigned char *bytes = malloc(from->n_bytes);
    for (int run = 0; run < 500 && bytes; run++) {
      conic_hybrid *hybrid;
      memcpy(bytes, from->bytes, from->n_bytes);
      size_t at = i + 1 < set->n ? 8 + (size_t)(random_unit(&state) * (double)(from->n_bytes - 8))
                                 : place_to_change(&state, from->n_bytes, first, n);
      bytes[at] = (unsigned char)(random_unit(&state) * 256.0);
      mend_hybrid(bytes, from->n_bytes);
      const char *path = files_write_bytes("mended.chy", bytes, from->n_bytes);
      conic_status status = conic_hybrid_read(context, path, &hybrid);
      CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT);
      n_refused += status != CONIC_OK;
      if (run % 4 == 0)
        check_opened(context, path, hybrid);
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
  test_parts(context);
  test_damaged_part(context);
  test_mended(context);
  test_refused(context);
  files_end(context);
  return check_result();
}
