/* Colours of hybrid models, by vertices and by textures, against those of the mesh; and creases, which stay. */
#include "core/base/color.h"
#include "core/base/memory.h"
#include "core/base/trigonometry.h"
#include "lod/clusters/cluster_seen.h"
#include "lod/mesh/face_tree.h"
#include "tests/support/hybrid_fixture.h"

enum { SIZE = 256, FINE = 4, WIDE = SIZE * FINE };

typedef struct colored {
  conic_context *context;
  conic_renderer *renderer;
  conic_triangles mesh;
  conic_mesh faces; /* the same */
  conic_adjacency adjacency;
  conic_face_tree tree;
  conic_hybrid *hybrid;
  conic_hybrid_selection selection;
  conic_render_options options;
  conic_camera camera, fine;
  conic_image truth, image;
} colored;

/* Stripes across the hills, sharp within one edge of the mesh. */
static void stripe(conic_context *context, conic_triangles *mesh) {
  for (int channel = 0; channel < 3; channel++) {
    mesh->color[channel] = conic_memory_allocate(context, mesh->n_vertices, sizeof(float));
    for (size_t i = 0; i < mesh->n_vertices; i++) {
      double along = 14.0 * (double)mesh->position[0][i] + 2.0 * (double)mesh->position[2][i];
      mesh->color[channel][i] = (int)along % 2 ? 0.8f : 0.02f + 0.1f * (float)channel;
    }
  }
}

/* A picture of patches, seen from above. */
static void dress(conic_context *context, conic_triangles *mesh) {
  enum { TEXELS = 256 };
  conic_image image;
  conic_texture *texture;
  CHECK_OK(conic_image_allocate(context, TEXELS, TEXELS, 1u << CONIC_PLANE_RGBA, &image));
  for (int i = 0; i < TEXELS * TEXELS; i++) {
    double x = 0.1 * (i % TEXELS), y = 0.1 * (i / TEXELS);
    for (int channel = 0; channel < 3; channel++)
      ((float *)image.planes[CONIC_PLANE_RGBA])[4 * i + channel] =
          (float)(0.4 + 0.35 * conic_sin(x + channel + 0.7 * conic_sin(1.7 * y)) * conic_cos(y - 0.5 * x));
    ((float *)image.planes[CONIC_PLANE_RGBA])[4 * i + 3] = 1.0f;
  }
  for (int k = 0; k < 2; k++) {
    mesh->texture_coordinate[k] = conic_memory_allocate(context, mesh->n_vertices, sizeof(float));
    memcpy(mesh->texture_coordinate[k], mesh->position[2 * k], mesh->n_vertices * sizeof(float));
  }
  CHECK_OK(conic_texture_create(context, &image, CONIC_WRAP_CLAMP, &texture));
  CHECK_OK(conic_triangles_texture(context, mesh, texture));
  conic_image_release(context, &image);
}

static void make_mesh(conic_context *context, int is_textured, conic_triangles *mesh) {
  hybrid_terrain(context, 60, mesh);
  (is_textured ? dress : stripe)(context, mesh);
}

static void draw(colored *c, const conic_drawing *drawing, conic_image *image) {
  conic_image_release(c->context, image);
  CHECK_OK(conic_image_allocate(
      c->context, WIDE, WIDE,
      1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_ID | 1u << CONIC_PLANE_CLUSTER, image));
  CHECK_OK(conic_render_drawing(c->context, c->renderer, drawing, &c->fine, &c->options, 1, image, NULL));
}

static void choose(colored *c, double error_px, double color_error) {
  conic_hybrid_view view;
  conic_hybrid_view_init(&view);
  CHECK(view.color_error == CONIC_JUST_VISIBLE);
  view.error_px = error_px;
  view.color_error = color_error;
  CHECK_OK(conic_hybrid_select(c->hybrid, &c->camera, &c->options, &view, &c->selection));
  CHECK(c->selection.color_error <= color_error && c->selection.error_px <= error_px);
  const conic_drawing drawing = {&c->selection.splats, &c->selection.triangles};
  draw(c, &drawing, &c->image);
  conic_hybrid_name(&c->selection, &c->image);
}

/* PSNR of the means of the samples of each pixel. */
static double psnr_of(const colored *c) {
  const float *a = c->truth.planes[CONIC_PLANE_RGBA], *b = c->image.planes[CONIC_PLANE_RGBA];
  double square = 0.0;
  for (int y = 0; y < SIZE; y++)
    for (int x = 0; x < SIZE; x++)
      for (int channel = 0; channel < 3; channel++) {
        double sums[2] = {0.0, 0.0};
        for (int i = 0; i < FINE * FINE; i++) {
          int at = 4 * ((y * FINE + i / FINE) * WIDE + x * FINE + i % FINE) + channel;
          sums[0] += (double)a[at] / (FINE * FINE);
          sums[1] += (double)b[at] / (FINE * FINE);
        }
        double off = conic_srgb_encode(sums[0]) - conic_srgb_encode(sums[1]);
        square += off * off;
      }
  return -10.0 * log10(square / (3.0 * SIZE * SIZE));
}

/* The place of the model that a sample shows. */
static void place_of(const colored *c, int i, double at[3]) {
  const conic_camera *camera = &c->fine;
  double z = (double)((const float *)c->image.planes[CONIC_PLANE_Z])[i];
  const double seen[3] = {(i % WIDE + 0.5 - camera->cx) / camera->fx * z - camera->cam_from_world[0][3],
                          (i / WIDE + 0.5 - camera->cy) / camera->fy * z - camera->cam_from_world[1][3],
                          z - camera->cam_from_world[2][3]};
  for (int axis = 0; axis < 3; axis++) {
    at[axis] = -c->mesh.origin[axis];
    for (int row = 0; row < 3; row++)
      at[axis] += camera->cam_from_world[row][axis] * seen[row];
  }
}

/* By how many steps what a sample shows differs from the mesh where it is nearest. */
static double steps_off(const colored *c, int i) {
  const float *rgba = (const float *)c->image.planes[CONIC_PLANE_RGBA] + 4 * (size_t)i;
  const double drawn[3] = {(double)rgba[0], (double)rgba[1], (double)rgba[2]};
  double at[3], corners[3][3], lab[3], steps[3], square = 0.0;
  uint32_t near = 0;
  conic_seen_place place = {.material = 0};
  place_of(c, i, at);
  conic_face_tree_bound(&c->tree, at, &near, 0.0);
  for (int corner = 0; corner < 3; corner++)
    conic_mesh_corner(&c->faces, near, corner, corners[corner]);
  const double *const pointers[3] = {corners[0], corners[1], corners[2]};
  conic_seen_nearest(at, pointers, place.bary);
  memcpy(place.corners, c->mesh.corners[near], sizeof place.corners);
  conic_seen_color(&c->mesh, &place, steps);
  conic_oklab_of(drawn, lab);
  for (int k = 0; k < 3; k++)
    square += (100.0 * lab[k] - steps[k]) * (100.0 * lab[k] - steps[k]);
  return sqrt(square);
}

/* The greatest root mean square of a cluster's samples, of those that have some hundreds. Every third is looked at. */
static double worst_cluster(const colored *c) {
  const uint32_t *cluster = c->image.planes[CONIC_PLANE_CLUSTER];
  size_t n = c->hybrid->n_clusters + c->hybrid->n_nodes;
  double *sums = calloc(2 * n, sizeof *sums), worst = 0.0;
  CHECK(sums != NULL);
  for (int y = 0; y < WIDE; y += 3)
    for (int x = 0; x < WIDE; x += 3)
      if (cluster[y * WIDE + x] != CONIC_NO_ID) {
        double off = steps_off(c, y * WIDE + x);
        sums[2 * cluster[y * WIDE + x]] += off * off;
        sums[2 * cluster[y * WIDE + x] + 1] += 1.0;
      }
  for (size_t i = 0; i < n; i++)
    if (sums[2 * i + 1] >= 300.0)
      worst = fmax(worst, sqrt(sums[2 * i] / sums[2 * i + 1]));
  free(sums);
  return worst;
}

static void open_colored(colored *c, int is_textured) {
  conic_triangles taken;
  conic_hybrid_options options;
  conic_hybrid_info info;
  make_mesh(c->context, is_textured, &c->mesh);
  make_mesh(c->context, is_textured, &taken);
  c->faces = (conic_mesh){c->mesh.n_vertices,
                          c->mesh.count,
                          {c->mesh.position[0], c->mesh.position[1], c->mesh.position[2]},
                          (const uint32_t(*)[3])c->mesh.corners};
  CHECK_OK(conic_adjacency_find(c->context, &c->faces, &c->adjacency));
  CHECK_OK(conic_face_tree_build(c->context, &c->faces, &c->adjacency, &c->tree));
  conic_hybrid_options_init(&options);
  CHECK_OK(conic_hybrid_build(c->context, &taken, &options, &c->hybrid, NULL));
  CHECK_OK(conic_hybrid_describe(c->hybrid, &info));
  CHECK(info.has_colors);
  conic_render_options_init(&c->options);
  c->options.shading = CONIC_SHADE_NONE;
  c->options.near_z = info.near_z;
  c->options.splat_length = info.splat_length;
  hybrid_look(c->context, 17, SIZE, 1.0, info.minimum, info.maximum, &c->camera);
  c->fine = c->camera;
  c->fine.width = c->fine.height = WIDE;
  c->fine.fx *= FINE;
  c->fine.fy *= FINE;
  c->fine.cx *= FINE;
  c->fine.cy *= FINE;
}

static void close_colored(colored *c) {
  conic_image_release(c->context, &c->truth);
  conic_image_release(c->context, &c->image);
  conic_hybrid_selection_release(c->context, &c->selection);
  conic_hybrid_destroy(c->hybrid);
  conic_face_tree_release(c->context, &c->tree);
  conic_adjacency_release(c->context, &c->adjacency);
  conic_triangles_release(c->context, &c->mesh);
}

/* What is asked for is kept, and it is this that keeps it: without, the same error of places loses colours. */
static void test_colors(conic_context *context, conic_renderer *renderer, int is_textured) {
  static const struct {
    double error_px, psnr[2]; /* of stripes, of a texture */
    size_t most;              /* triangles and surfels, of 7200 faces */
  } asked[] = {{1.0, {38.0, 38.0}, 4400}, {4.0, {30.0, 34.0}, 2100}};
  colored c = {.context = context, .renderer = renderer};
  open_colored(&c, is_textured);
  const conic_drawing mesh = {NULL, &c.mesh};
  draw(&c, &mesh, &c.truth);
  for (int i = 0; i < 2; i++) {
    choose(&c, asked[i].error_px, CONIC_JUST_VISIBLE);
    double worst = worst_cluster(&c), psnr = psnr_of(&c);
    size_t n = c.selection.triangles.count + c.selection.splats.count;
    choose(&c, asked[i].error_px, HUGE_VAL);
    double free_worst = worst_cluster(&c), free_psnr = psnr_of(&c);
    fprintf(stderr, "%s, error %g: %.2f steps, %.2f dB, %zu; colours left alone: %.2f, %.2f dB, %zu\n",
            is_textured ? "texture" : "stripes", asked[i].error_px, worst, psnr, n, free_worst, free_psnr,
            c.selection.triangles.count + c.selection.splats.count);
    CHECK(psnr >= asked[i].psnr[is_textured] && worst <= 1.5 * CONIC_JUST_VISIBLE && n <= asked[i].most);
    CHECK(free_worst >= worst && free_psnr <= psnr);
    CHECK((is_textured && i == 0) || free_psnr < asked[i].psnr[is_textured]);
  }
  close_colored(&c);
}

/* --- creases --- */

/* Two slopes that meet in a ridge, of side × side squares each, curved a little along it. */
static void make_roof(conic_context *context, size_t side, conic_triangles *mesh) {
  hybrid_terrain(context, 2 * side, mesh);
  for (size_t i = 0; i < mesh->n_vertices; i++) {
    double x = (double)mesh->position[0][i] - 0.5, z = (double)mesh->position[2][i];
    mesh->position[1][i] = (float)(0.9 * (0.5 - fabs(x)) + 0.05 * conic_sin(3.0 * z));
  }
  CHECK_OK(conic_triangles_crease(context, mesh, 30.0));
}

/* Whatever level a patch has, and beside whichever others: triangles have the normals of their own side of the ridge,
 * and that is seen wherever they are no needles. */
static void test_creases(conic_context *context) {
  conic_triangles mesh;
  conic_hybrid_options options;
  conic_hybrid *hybrid;
  conic_hybrid_selection selection = {.scratch = NULL};
  conic_render_options render;
  conic_camera camera;
  conic_hybrid_info info;
  make_roof(context, 24, &mesh);
  conic_hybrid_options_init(&options);
  options.most_area = 0.1;
  CHECK_OK(conic_hybrid_build(context, &mesh, &options, &hybrid, NULL));
  CHECK_OK(conic_hybrid_describe(hybrid, &info));
  conic_render_options_init(&render);
  render.near_z = info.near_z;
  hybrid_look(context, 17, 512, 4.0, info.minimum, info.maximum, &camera);
  for (int i = 0; i < 5; i++) {
    conic_hybrid_view view;
    conic_hybrid_view_init(&view);
    view.error_px = 0.1 * (double)(1 << 2 * i);
    view.only_kind = CONIC_HYBRID_TRIANGLES;
    CHECK_OK(conic_hybrid_select(hybrid, &camera, &render, &view, &selection));
    const conic_triangles *t = &selection.triangles;
    for (size_t k = 0; k < t->count; k++) {
      uint32_t a = t->corners[k][0];
      for (int corner = 1; corner < 3; corner++) {
        uint32_t b = t->corners[k][corner];
        CHECK(fabsf(t->normal[0][a]) > 0.5f && t->normal[0][a] * t->normal[0][b] > 0.25f);
      }
    }
    fprintf(stderr, "roof, error %g: %zu triangles\n", view.error_px, t->count);
    CHECK(i < 4 || t->count < 200);
  }
  conic_hybrid_selection_release(context, &selection);
  conic_hybrid_destroy(hybrid);
}

int main(void) {
  conic_context *context = check_context(0);
  conic_renderer *renderer;
  CHECK_OK(conic_renderer_create(context, &renderer));
  for (int is_textured = 0; is_textured < 2; is_textured++)
    test_colors(context, renderer, is_textured);
  test_creases(context);
  conic_renderer_destroy(renderer);
  conic_context_destroy(context);
  return check_result();
}
