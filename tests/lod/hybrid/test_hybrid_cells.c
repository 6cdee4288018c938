/* Models that are built in cells, of meshes that are read some faces at a time: of one cell they are those of the mesh
 * as a whole; the threads change nothing; and cells meet without a gap, whether their faces share vertices or only
 * places. */
#include "lod/hybrid/build/hybrid_build.h"
#include "lod/hybrid/model/hybrid_chunks.h"
#include "lod/mesh/mesh_cells.h"
#include "tests/support/files.h"
#include "tests/support/hybrid_fixture.h"

enum { FACES_A_CELL = 400 };

static size_t side = 36; /* of the terrain, in squares */

/* A terrain; as a soup each face has vertices of its own. One face has a corner that is none. */
static void write_ply(conic_context *context, const char *path, int is_soup) {
  conic_triangles mesh;
  FILE *file = fopen(path, "w");
  if (!file)
    exit(1);
  hybrid_terrain(context, side, &mesh);
  size_t n_vertices = is_soup ? 3 * mesh.count : mesh.n_vertices;
  fprintf(file, "ply\nformat ascii 1.0\nelement vertex %zu\nproperty float x\nproperty float y\nproperty float z\n",
          n_vertices + 1);
  fprintf(file, "element face %zu\nproperty list uchar int vertex_indices\nend_header\n", mesh.count + 1);
  for (size_t i = 0; i < n_vertices; i++) {
    size_t vertex = is_soup ? mesh.corners[i / 3][i % 3] : i;
    fprintf(file, "%.9g %.9g %.9g\n", (double)mesh.position[0][vertex], (double)mesh.position[1][vertex],
            (double)mesh.position[2][vertex]);
  }
  fprintf(file, "nan 0 0\n3 0 1 %zu\n", n_vertices);
  for (size_t i = 0; i < mesh.count; i++) {
    const uint32_t own[3] = {(uint32_t)(3 * i), (uint32_t)(3 * i + 1), (uint32_t)(3 * i + 2)};
    const uint32_t *corners = is_soup ? own : mesh.corners[i];
    fprintf(file, "3 %u %u %u\n", corners[0], corners[1], corners[2]);
  }
  CHECK(fclose(file) == 0);
  conic_triangles_release(context, &mesh);
}

static conic_hybrid *build_cells(conic_context *context, const char *path, size_t most_faces) {
  conic_hybrid_options options;
  conic_hybrid_streaming streaming;
  conic_hybrid_report report;
  conic_hybrid *hybrid;
  conic_hybrid_options_init(&options);
  options.most_area = 0.3; /* so that there are some faces to a patch */
  conic_hybrid_streaming_init(&streaming);
  CHECK_OK(conic_hybrid_build_cells(context, path, path, &options, &streaming, most_faces, &hybrid, &report));
  CHECK(report.n_faces == 2 * side * side + 1 && report.nan == 1 && report.zero == 0);
  return hybrid;
}

static conic_hybrid *build_whole(conic_context *context, const char *path) {
  conic_hybrid_options options;
  conic_triangles mesh;
  conic_hybrid *hybrid;
  conic_hybrid_options_init(&options);
  options.most_area = 0.3;
  CHECK_OK(conic_triangles_read(context, path, &mesh));
  CHECK_OK(conic_triangles_crease(context, &mesh, 30.0));
  CHECK_OK(conic_hybrid_build(context, &mesh, &options, &hybrid, NULL));
  return hybrid;
}

static uint64_t sum_of_file(conic_context *context, conic_hybrid *hybrid) {
  const char *path = files_path("cells.chy");
  conic_mapping file;
  conic_hybrid *back;
  conic_hybrid_defects defects;
  CHECK_OK(conic_hybrid_write(hybrid, path));
  CHECK_OK(conic_hybrid_read(context, path, &back));
  CHECK_OK(conic_hybrid_check(back, &defects));
  CHECK(defects.values + defects.spheres + defects.cones + defects.levels == 0);
  conic_hybrid_destroy(back);
  CHECK_OK(conic_mapping_open(context, path, &file));
  uint64_t sum = conic_checksum(file.bytes, file.n_bytes);
  conic_mapping_close(context, &file);
  CHECK(unlink(path) == 0);
  return sum;
}

/* A place of the mesh as a cluster has it. */
typedef struct corner_place {
  float at[3];
  uint32_t cluster;
} corner_place;

static int compare_corners(const void *a, const void *b) {
  return memcmp(a, b, sizeof(corner_place));
}

/* Vertices of all clusters' first or coarsest triangles, sorted. */
static corner_place *list_corners(const conic_hybrid *h, int is_coarsest, size_t *n) {
  size_t room = 0;
  for (size_t i = 0; i < h->n_clusters; i++)
    room += h->levels[h->clusters[i].first_level].n_vertices;
  corner_place *places = malloc((room + 1) * sizeof *places);
  if (!places)
    exit(1);
  *n = 0;
  for (uint32_t i = 0; i < h->n_clusters; i++) {
    const conic_hybrid_cluster *cluster = &h->clusters[i];
    uint32_t k = cluster->first_level;
    while (is_coarsest && k + 1 < cluster->first_level + cluster->n_levels &&
           h->levels[k + 1].kind == CONIC_HYBRID_TRIANGLES)
      k++;
    conic_hybrid_piece piece = conic_hybrid_piece_of(h, k);
    for (size_t v = 0; v < h->levels[k].n_vertices; v++, (*n)++) {
      for (int axis = 0; axis < 3; axis++)
        places[*n].at[axis] = piece.vertices.position[axis][v] + 0.0f;
      places[*n].cluster = i;
    }
  }
  qsort(places, *n, sizeof *places, compare_corners);
  return places;
}

/* Which cell a cluster is of, of those whose clusters begin there. */
static uint32_t cell_of(const uint32_t *starts, size_t n_cells, uint32_t cluster) {
  uint32_t cell = 0;
  while (cell + 1 < n_cells && starts[cell + 1] <= cluster)
    cell++;
  return cell;
}

/* The cluster across a border has a vertex at its end. */
static void check_across(const conic_hybrid *h, const corner_place *places, size_t n) {
  size_t n_borders = 0, n_wrong = 0;
  for (uint32_t i = 0; i < h->n_clusters; i++)
    for (uint32_t k = 0; k < h->clusters[i].n_borders; k++, n_borders++) {
      const conic_cluster_border *border = &conic_hybrid_frame_of(h, i).borders[k];
      conic_hybrid_vertices ends = conic_hybrid_ends_of(h, i);
      corner_place end = {.cluster = border->across};
      for (int axis = 0; axis < 3; axis++)
        end.at[axis] = ends.position[axis][border->from] + 0.0f;
      n_wrong += bsearch(&end, places, n, sizeof *places, compare_corners) == NULL;
    }
  CHECK(n_borders > 0 && n_wrong == 0);
}

/* Where two cells meet, no vertex is left out, however coarse they are. */
static void check_seams(const conic_hybrid *h, const uint32_t *starts, size_t n_cells, int is_soup) {
  size_t n_fine, n_coarse, n_shared = 0, n_left = 0;
  corner_place *fine = list_corners(h, 0, &n_fine), *coarse = list_corners(h, 1, &n_coarse);
  for (size_t i = 0, end; i < n_fine; i = end) {
    int is_shared = 0;
    for (end = i + 1; end < n_fine && memcmp(fine[i].at, fine[end].at, sizeof fine[i].at) == 0; end++)
      is_shared |= cell_of(starts, n_cells, fine[end].cluster) != cell_of(starts, n_cells, fine[i].cluster);
    for (size_t k = i; k < end && is_shared; k++) {
      n_shared++;
      n_left += bsearch(&fine[k], coarse, n_coarse, sizeof *coarse, compare_corners) == NULL;
    }
  }
  CHECK(n_shared > 100 && n_left == 0);
  if (!is_soup)
    check_across(h, fine, n_fine);
  CHECK(is_soup || n_coarse < n_fine / 2); /* others are left out; of a soup all stay */
  free(fine);
  free(coarse);
}

/* By the clusters of each cell by itself. */
static void test_seams(conic_context *context, const char *path, const conic_hybrid *h, int is_soup) {
  conic_mesh_cells *cells;
  CHECK_OK(conic_mesh_cells_find(context, path, path, FACES_A_CELL, &cells));
  size_t n_cells = conic_mesh_cells_count(cells), n_faces = 0, n_all = 0;
  CHECK(n_cells >= 6 && n_cells <= 20);
  uint32_t starts[21] = {0};
  for (size_t i = 0; i < n_cells && n_cells <= 20; i++) {
    conic_triangles mesh;
    size_t n_own, n_seen = 0;
    uint32_t cluster = starts[i];
    CHECK_OK(conic_mesh_cells_take(cells, i, &mesh, &n_own));
    CHECK(n_own > 0 && n_own <= FACES_A_CELL && n_own < mesh.count);
    n_faces += n_own;
    n_all += mesh.count;
    for (size_t k = 0; k < n_own; k++) /* one face is drawn by no cluster */
      for (int corner = 0; corner < 3; corner++)
        if (!(mesh.position[0][mesh.corners[k][corner]] >= 0.0f)) {
          n_own--;
          break;
        }
    for (; cluster < h->n_clusters && n_seen < n_own; cluster++)
      n_seen += h->levels[h->clusters[cluster].first_level].count;
    CHECK(n_seen == n_own);
    starts[i + 1] = cluster;
    conic_triangles_release(context, &mesh);
  }
  CHECK(n_faces == 2 * side * side + 1 && starts[n_cells] == h->n_clusters && n_all < 2 * n_faces);
  check_seams(h, starts, n_cells, is_soup);
  conic_mesh_cells_release(cells);
}

static void test_mesh(conic_context *context, int is_soup) {
  char path[512];
  snprintf(path, sizeof path, "%s", files_path("cells.ply"));
  write_ply(context, path, is_soup);
  conic_hybrid *whole = build_whole(context, path), *one = build_cells(context, path, 1000000);
  CHECK(sum_of_file(context, whole) == sum_of_file(context, one));
  conic_hybrid_destroy(one);
  conic_hybrid_destroy(whole);
  conic_hybrid *cells = build_cells(context, path, FACES_A_CELL);
  uint64_t sum = sum_of_file(context, cells);
  CHECK(cells->nodes[0].point.radius > 0.0f && cells->n_nodes < 2 * cells->n_clusters);
  test_seams(context, path, cells, is_soup);
  conic_hybrid_destroy(cells);
  conic_context *other = check_context(3);
  cells = build_cells(other, path, FACES_A_CELL);
  CHECK(sum_of_file(other, cells) == sum);
  conic_hybrid_destroy(cells);
  conic_context_destroy(other);
  CHECK(unlink(path) == 0);
}

/* Of many cells, which nothing simplifies as a whole: budgets near the least that there are, where what fits clusters
 * to each other is most of what is drawn, so that a great many errors are too small. */
static void test_budgets(conic_context *context) {
  char path[512];
  conic_hybrid_info info;
  conic_camera camera;
  conic_render_options render;
  conic_hybrid_selection selection = {0};
  snprintf(path, sizeof path, "%s", files_path("large.ply"));
  side = 120;
  write_ply(context, path, 0);
  conic_hybrid *cells = build_cells(context, path, FACES_A_CELL);
  conic_render_options_init(&render);
  CHECK_OK(conic_hybrid_describe(cells, &info));
  hybrid_look(context, 17, 512, 1.0, info.minimum, info.maximum, &camera);
  double error_px = HUGE_VAL;
  for (uint64_t budget = 250; budget <= 16000; budget *= 2) {
    conic_hybrid_view view;
    conic_hybrid_view_init(&view);
    view.budget = budget;
    CHECK_OK(conic_hybrid_select(cells, &camera, &render, &view, &selection));
    uint64_t n = selection.splats.count + selection.triangles.count;
    CHECK(n <= budget && n > budget / 3 && selection.error_px < 0.7 * error_px);
    error_px = selection.error_px;
  }
  conic_hybrid_selection_release(context, &selection);
  conic_hybrid_destroy(cells);
  CHECK(unlink(path) == 0);
}

static void test_refused_meshes(conic_context *context) {
  conic_hybrid_options options;
  conic_hybrid_streaming streaming;
  conic_hybrid *hybrid;
  conic_hybrid_options_init(&options);
  conic_hybrid_streaming_init(&streaming);
  const char *path = files_write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  CHECK(conic_hybrid_build_file(context, path, path, &options, &streaming, &hybrid, NULL) == CONIC_ERROR_INPUT);
  CHECK(!hybrid && strstr(files_message, "only of a PLY faces are read some at a time") != NULL);
  path = files_write("empty.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                  "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                  "end_header\n0 0 0\n0 0 0\n1 0 0\n3 0 1 2\n");
  CHECK(conic_hybrid_build_file(context, path, path, &options, &streaming, &hybrid, NULL) == CONIC_ERROR_INPUT);
  CHECK(!hybrid && strstr(files_message, "no face that could be drawn") != NULL);
  streaming.memory_bytes = 1 << 20;
  CHECK(conic_hybrid_build_file(context, path, path, &options, &streaming, &hybrid, NULL) == CONIC_ERROR_MEMORY);
  CHECK(unlink(files_path("flat.obj")) == 0 && unlink(files_path("empty.ply")) == 0);
}

int main(void) {
  conic_context *context = files_context();
  test_mesh(context, 0);
  test_mesh(context, 1);
  test_budgets(context);
  test_refused_meshes(context);
  files_end(context);
  return check_result();
}
