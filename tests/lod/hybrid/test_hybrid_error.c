/* How far pictures of hybrid models are from those of the mesh itself. Of both, a picture of 256 × 256 is taken with
 * 8 × 8 samples a pixel, so that what is measured is the model and not the pixels: how far outlines moved, how far what
 * is drawn lies from the mesh, and how colours differ. What is to be drawn is chosen for the picture of 256 × 256. */
#include "core/base/vectors.h"
#include "lod/hybrid/model/hybrid_chunks.h"
#include "lod/mesh/face_tree.h"
#include "tests/support/hybrid_fixture.h"

enum { SIZE = 256, FINE = 8, WIDE = SIZE * FINE, N_ERRORS = 4 };

static const double errors_px[N_ERRORS] = {0.0, 0.5, 1.0, 3.0}; /* 0: as built */

/* The prefilter makes a surfel's outline wider by 1.5 samples, and each of two outlines is known to half the diagonal
 * of a sample. */
static const double slack_px = (1.5 + 1.42) / FINE;

/* What was measured, less a decibel or a seventh more: of each error the least PSNR (dB) and the largest FLIP, the PSNR
 * of the picture with one sample a pixel (of which the mesh's own has 30 to 34 dB), and how far surfels reach past the
 * silhouette as built. */
typedef struct limits {
  const char *name; /* of the data; null: a terrain */
  double psnr[N_ERRORS], flip[N_ERRORS], plain_psnr[N_ERRORS], built_px;
} limits;

static const limits all_limits[] = {
    {NULL, {39.4, 41.6, 34.7, 28.6}, {0.0026, 0.0081, 0.0205, 0.0406}, {27.8, 29.1, 28.3, 26.1}, 0.9},
    {"cow.obj", {33.7, 44.3, 36.9, 27.9}, {0.0087, 0.0038, 0.0107, 0.0293}, {23.2, 30.6, 29.7, 25.9}, 1.2},
    {"bunny.obj", {44.4, 41.5, 35.1, 24.8}, {0.0022, 0.0085, 0.0163, 0.0380}, {26.7, 32.0, 30.3, 22.9}, 0.5},
};

/* Fewer under a sanitizer, which takes ten times as long. */
#ifdef __SANITIZE_ADDRESS__
enum { N_MODELS = 2, N_DIRECTIONS = 1 };
#else
enum { N_MODELS = sizeof all_limits / sizeof *all_limits, N_DIRECTIONS = 1 };
#endif

typedef struct comparison {
  conic_context *context;
  conic_renderer *renderer;
  conic_triangles mesh;
  conic_mesh faces; /* the same */
  conic_face_tree tree;
  conic_hybrid *hybrid;
  conic_hybrid_selection selection;
  conic_render_options options;
  conic_camera camera, fine;
  conic_image truth, image;  /* with all samples */
  conic_image reduced_truth; /* of 256 × 256 */
} comparison;

typedef struct findings {
  double grown_px, shrunk_px; /* how far the hybrid's outline reaches past the mesh's, and the other way round */
  double off_px;              /* how far what is drawn is from the mesh */
  double psnr, flip, plain_psnr;
} findings;

static void draw(comparison *c, const conic_drawing *drawing, const conic_camera *camera, conic_image *image) {
  conic_image_release(c->context, image);
  CHECK_OK(conic_image_allocate(c->context, camera->width, camera->height, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z,
                                image));
  CHECK_OK(conic_render_drawing(c->context, c->renderer, drawing, camera, &c->options, 1, image, NULL));
}

/* A pixel is the mean of its samples. */
static void reduce(comparison *c, const conic_image *samples, conic_image *image) {
  const float *from = samples->planes[CONIC_PLANE_RGBA];
  CHECK_OK(conic_image_allocate(c->context, SIZE, SIZE, 1u << CONIC_PLANE_RGBA, image));
  for (int y = 0; y < SIZE; y++)
    for (int x = 0; x < SIZE; x++) {
      double sum[4] = {0.0, 0.0, 0.0, 0.0};
      for (int i = 0; i < FINE * FINE; i++)
        for (int channel = 0; channel < 4; channel++)
          sum[channel] += (double)from[4 * ((y * FINE + i / FINE) * WIDE + x * FINE + i % FINE) + channel];
      for (int channel = 0; channel < 4; channel++)
        ((float *)image->planes[CONIC_PLANE_RGBA])[4 * (y * SIZE + x) + channel] =
            (float)(sum[channel] / (FINE * FINE));
    }
}

/* Samples from (x, y) to the nearest that is covered, looked for as far as `most`, else that. */
static double nearest_covered(const float *z, int x, int y, int most) {
  int best2 = most * most;
  for (int dy = -most; dy <= most; dy++) {
    for (int dx = -most; dx <= most && dy * dy < best2; dx++) {
      int u = x + dx, v = y + dy, squared = dx * dx + dy * dy;
      if (squared < best2 && u >= 0 && v >= 0 && u < WIDE && v < WIDE && z[v * WIDE + u] != 0.0f)
        best2 = squared;
    }
  }
  return sqrt(best2);
}

/* The farthest that a sample which `a` covers is from those that `b` does, in pixels; 10 at most. */
static double past_outline_px(const conic_image *a, const conic_image *b) {
  const float *a_z = a->planes[CONIC_PLANE_Z], *b_z = b->planes[CONIC_PLANE_Z];
  double farthest = 0.0;
  for (int y = 0; y < WIDE; y++)
    for (int x = 0; x < WIDE; x++)
      if (a_z[y * WIDE + x] != 0.0f && b_z[y * WIDE + x] == 0.0f)
        farthest = fmax(farthest, nearest_covered(b_z, x, y, 10 * FINE));
  return farthest / FINE;
}

/* The farthest that a drawn place is from the mesh, in pixels at its depth. Every fifth sample is looked at. */
static double off_mesh_px(const comparison *c) {
  const float *depths = c->image.planes[CONIC_PLANE_Z];
  const conic_camera *camera = &c->fine;
  double farthest_px = 0.0;
  for (int y = 0; y < WIDE; y += 5)
    for (int x = 0; x < WIDE; x += 5) {
      double z = (double)depths[y * WIDE + x], at[3], unit = z / c->camera.fx;
      if (z == 0.0)
        continue;
      const double seen[3] = {(x + 0.5 - camera->cx) / camera->fx * z - camera->cam_from_world[0][3],
                              (y + 0.5 - camera->cy) / camera->fy * z - camera->cam_from_world[1][3],
                              z - camera->cam_from_world[2][3]};
      for (int axis = 0; axis < 3; axis++) {
        at[axis] = -c->mesh.origin[axis];
        for (int row = 0; row < 3; row++)
          at[axis] += camera->cam_from_world[row][axis] * seen[row];
      }
      farthest_px = conic_face_tree_farther(&c->tree, at, farthest_px * unit) / unit;
    }
  return farthest_px;
}

/* What the file says that its clusters, as built, are off at most, in pixels of this picture. */
static double stated_px(const comparison *c) {
  const conic_hybrid *h = c->hybrid;
  double worst = 0.0;
  for (size_t i = 0; i < h->n_clusters; i++) {
    const conic_hybrid_cluster *cluster = &h->clusters[i];
    const conic_hybrid_level *built = &h->levels[cluster->first_level + cluster->built];
    double at[3], around = (double)(cluster->bound.radius + built->reach);
    for (int row = 0; row < 3; row++) {
      const double *m = c->camera.cam_from_world[row];
      at[row] = m[3];
      for (int axis = 0; axis < 3; axis++)
        at[row] += m[axis] * (h->origin[axis] + (double)cluster->bound.center[axis]);
    }
    double front = at[2] - around, far = conic_length(at) + around;
    worst = fmax(worst, (double)built->error * c->camera.fx * far / (front * front));
  }
  return worst;
}

/* PSNR of the picture as it is usually drawn, with one sample a pixel. */
static double plain_psnr(comparison *c, const conic_drawing *drawing) {
  conic_image plain = {.width = 0};
  conic_difference difference;
  draw(c, drawing, &c->camera, &plain);
  CHECK_OK(conic_image_compare(c->context, &c->reduced_truth, &plain, &difference));
  conic_image_release(c->context, &plain);
  return difference.psnr;
}

static findings compare(comparison *c, double error_px) {
  findings found;
  conic_hybrid_view view;
  conic_image small;
  conic_difference difference;
  conic_hybrid_view_init(&view);
  view.error_px = error_px;
  CHECK_OK(conic_hybrid_select(c->hybrid, &c->camera, &c->options, &view, &c->selection));
  const conic_drawing drawing = {&c->selection.splats, &c->selection.triangles};
  found.plain_psnr = plain_psnr(c, &drawing);
  draw(c, &drawing, &c->fine, &c->image);
  reduce(c, &c->image, &small);
  CHECK_OK(conic_image_compare(c->context, &c->reduced_truth, &small, &difference));
  found.psnr = difference.psnr;
  found.flip = difference.flip;
  conic_image_release(c->context, &small);
  found.grown_px = past_outline_px(&c->image, &c->truth);
  found.shrunk_px = past_outline_px(&c->truth, &c->image);
  found.off_px = off_mesh_px(c);
  return found;
}

static void look(comparison *c, int direction) {
  const conic_drawing mesh = {NULL, &c->mesh};
  conic_hybrid_info info;
  CHECK_OK(conic_hybrid_describe(c->hybrid, &info));
  c->options.near_z = info.near_z;
  c->options.splat_length = info.splat_length;
  hybrid_look(c->context, direction, SIZE, 1.0, info.minimum, info.maximum, &c->camera);
  c->fine = c->camera;
  c->fine.width = c->fine.height = WIDE;
  c->fine.fx *= FINE;
  c->fine.fy *= FINE;
  c->fine.cx *= FINE;
  c->fine.cy *= FINE;
  draw(c, &mesh, &c->fine, &c->truth);
  conic_image_release(c->context, &c->reduced_truth);
  reduce(c, &c->truth, &c->reduced_truth);
}

static void check_direction(comparison *c, const limits *limit, int direction) {
  const conic_drawing mesh = {NULL, &c->mesh};
  const char *name = limit->name ? limit->name : "terrain";
  look(c, direction);
  fprintf(stderr, "%s, direction %2d, the mesh with one sample: %.2f dB\n", name, direction, plain_psnr(c, &mesh));
  for (int i = 0; i < N_ERRORS; i++) {
    int is_built = errors_px[i] == 0.0;
    double promised_px = is_built ? stated_px(c) : errors_px[i];
    findings found = compare(c, errors_px[i]);
    fprintf(stderr,
            "%s, direction %2d, error %.1f: outline +%.2f -%.2f px, off %.2f of %.2f px, %.2f dB, FLIP %.4f, plain "
            "%.2f dB\n",
            name, direction, errors_px[i], found.grown_px, found.shrunk_px, found.off_px, promised_px, found.psnr,
            found.flip, found.plain_psnr);
    CHECK(found.grown_px <= promised_px + slack_px);
    CHECK(found.shrunk_px <= (is_built ? 1.0 / FINE : promised_px + slack_px));
    CHECK(found.off_px <= promised_px + slack_px);
    CHECK(!is_built || found.grown_px <= limit->built_px);
    CHECK(found.psnr >= limit->psnr[i]);
    CHECK(found.flip <= limit->flip[i]);
    CHECK(found.plain_psnr >= limit->plain_psnr[i]);
  }
}

/* Where nodes stand for clusters, by surfels or as points, they too keep what they promise. */
static void check_nodes(comparison *c, const char *name) {
  static const double far_px[] = {12.0, 40.0};
  for (int i = 0; i < 2; i++) {
    conic_hybrid_view view;
    conic_hybrid_view_init(&view);
    view.error_px = far_px[i];
    view.only_kind = CONIC_HYBRID_SURFELS;
    CHECK_OK(conic_hybrid_select(c->hybrid, &c->camera, &c->options, &view, &c->selection));
    const conic_drawing drawing = {&c->selection.splats, &c->selection.triangles};
    draw(c, &drawing, &c->fine, &c->image);
    double off_px = off_mesh_px(c);
    fprintf(stderr, "%s, error %.0f: %zu nodes and %zu points for %zu patches, off %.2f px\n", name, far_px[i],
            c->selection.n_nodes, c->selection.n_points, c->selection.n_joined, off_px);
    CHECK(off_px <= c->selection.error_px + slack_px && c->selection.error_px <= far_px[i]);
    CHECK(c->selection.n_nodes + c->selection.n_points > 0 || i == 0);
  }
}

typedef struct disc {
  double at[3], u[3], v[3]; /* half axes of the outline */
} disc;

static disc disc_of(const conic_hybrid *h, const conic_hybrid_level *level, uint32_t i) {
  conic_hybrid_piece piece = conic_hybrid_piece_of(h, (uint32_t)(level - h->levels));
  disc d;
  for (int axis = 0; axis < 3; axis++) {
    d.at[axis] = (double)piece.surfels[axis][i];
    d.u[axis] = (double)h->cutoff * (double)piece.surfels[3 + axis][i];
    d.v[axis] = (double)h->cutoff * (double)piece.surfels[6 + axis][i];
  }
  return d;
}

/* How far its places are from the mesh, if more than `known`; not those at which the model was measured. */
static double disc_off_mesh(const comparison *c, const disc *d, double known) {
  for (int ring = 0; ring < 6; ring++)
    for (int k = 0; k < 19; k++) {
      double at[3], way = (k + 0.3) * 2.0 * 3.14159265358979 / 19.0, size = (1.0 + ring) / 6.0;
      for (int axis = 0; axis < 3; axis++)
        at[axis] = d->at[axis] + size * (cos(way) * d->u[axis] + sin(way) * d->v[axis]);
      known = conic_face_tree_farther(&c->tree, at, known);
    }
  return known;
}

/* No less than how far a place is from the disc; `size` becomes how far from its middle it lies over it, in half axes.
 */
static double off_disc(const disc *d, const double at[3], double *size) {
  double way[3], x, y;
  for (int axis = 0; axis < 3; axis++)
    way[axis] = at[axis] - d->at[axis];
  x = conic_dot(way, d->u) / conic_dot(d->u, d->u);
  y = conic_dot(way, d->v) / conic_dot(d->v, d->v);
  *size = sqrt(x * x + y * y);
  for (int axis = 0; axis < 3; axis++)
    way[axis] -= (x * d->u[axis] + y * d->v[axis]) / fmax(*size, 1.0);
  return conic_length(way);
}

/* How far the vertices of a node's faces are from the discs of one of its levels; and how many there are of them, and
 * how many that no disc covers. */
static double vertices_off(const conic_hybrid *h, const conic_hybrid_node *node, const conic_hybrid_level *level,
                           long counts[2]) {
  double farthest = 0.0;
  for (uint32_t i = node->begin; i < node->end; i++) {
    const conic_hybrid_level *faces = &h->levels[h->clusters[i].first_level];
    conic_hybrid_piece piece = conic_hybrid_piece_of(h, h->clusters[i].first_level);
    for (uint32_t k = 0; k < faces->n_vertices; k += 1 + faces->n_vertices / 20) {
      double at[3];
      for (int axis = 0; axis < 3; axis++)
        at[axis] = (double)piece.vertices.position[axis][k];
      double nearest = HUGE_VAL, least = HUGE_VAL, size;
      for (uint32_t m = 0; m < level->count; m++) {
        disc d = disc_of(h, level, m);
        double off = off_disc(&d, at, &size);
        nearest = fmin(nearest, off);
        least = off <= (double)level->error ? fmin(least, size) : least;
      }
      farthest = fmax(farthest, nearest);
      counts[0]++;
      counts[1] += !(least <= 1.0);
    }
  }
  return farthest;
}

/* These meshes have one colour, and so have nodes. */
static void check_colors(const conic_hybrid *h, const conic_hybrid_node *node) {
  for (uint32_t k = 0; k < node->n_levels; k++) {
    const conic_hybrid_level *level = &h->levels[node->first_level + k];
    conic_hybrid_piece piece = conic_hybrid_piece_of(h, node->first_level + k);
    for (int channel = 0; channel < 3 && level->kind == CONIC_HYBRID_SURFELS; channel++)
      for (uint32_t i = 0; i < level->count; i++)
        CHECK(fabsf(piece.surfels[9 + channel][i] - node->point.color[channel]) < 1e-5f);
  }
}

/* The greatest error of the finest surfels of a node's clusters. */
static double finest_error(const conic_hybrid *h, const conic_hybrid_node *node) {
  double greatest = 0.0;
  for (uint32_t i = node->begin; i < node->end; i++) {
    const conic_hybrid_cluster *cluster = &h->clusters[i];
    for (uint32_t k = 0, is_found = 0; k < cluster->n_levels && !is_found; k++) {
      const conic_hybrid_level *level = &h->levels[cluster->first_level + k];
      is_found = level->kind == CONIC_HYBRID_SURFELS;
      greatest = is_found ? fmax(greatest, (double)level->error) : greatest;
    }
  }
  return greatest;
}

/* What is said of nodes' errors, held against the mesh itself: of surfels what is said is measured, and so may be off
 * by a tenth; of the mesh and of points nothing. */
static void check_said(const comparison *c, const char *name) {
  const conic_hybrid *h = c->hybrid;
  double discs = 0.0, vertices = 0.0;
  long counts[2] = {0, 0};
  for (size_t i = 0; i < h->n_nodes; i++) {
    const conic_hybrid_node *node = &h->nodes[i];
    const double center[3] = {(double)node->bound.center[0], (double)node->bound.center[1],
                              (double)node->bound.center[2]};
    double off = conic_face_tree_farther(&c->tree, center, 0.0);
    CHECK(node->point.radius > 0.0f && (double)node->point.error >= (double)node->point.radius + off);
    check_colors(h, node);
    for (uint32_t k = 0; k < node->n_levels; k++) {
      const conic_hybrid_level *level = &h->levels[node->first_level + k];
      double error = (double)level->error, farthest = 0.0;
      if (level->kind == CONIC_HYBRID_TRIANGLES)
        continue;
      CHECK(error >= finest_error(h, node));
      for (uint32_t m = 0; m < level->count; m++) {
        disc d = disc_of(h, level, m);
        farthest = disc_off_mesh(c, &d, farthest);
      }
      discs = fmax(discs, farthest / error);
      vertices = fmax(vertices, vertices_off(h, node, level, counts) / error);
    }
  }
  fprintf(stderr, "%s: of what nodes say, surfels are %.3f off the mesh and the mesh %.3f off them, %ld of %ld bare\n",
          name, discs, vertices, counts[1], counts[0]);
  CHECK(discs <= 1.1 && vertices <= 1.0 && counts[0] > 100 && counts[1] == 0);
}

static void check_model(conic_context *context, const limits *limit, const char *path) {
  static const int directions[] = {17, 9};
  comparison c = {.context = context};
  conic_adjacency adjacency;
  conic_triangles copy;
  conic_hybrid_options options;
  conic_hybrid_options_init(&options);
  conic_render_options_init(&c.options);
  hybrid_mesh(context, path, 60, &c.mesh);
  hybrid_mesh(context, path, 60, &copy);
  c.faces = (conic_mesh){.n_vertices = c.mesh.n_vertices, .n_faces = c.mesh.count};
  c.faces.faces = (const uint32_t(*)[3])c.mesh.corners;
  for (int axis = 0; axis < 3; axis++)
    c.faces.position[axis] = c.mesh.position[axis];
  CHECK_OK(conic_adjacency_find(context, &c.faces, &adjacency));
  CHECK_OK(conic_face_tree_build(context, &c.faces, &adjacency, &c.tree));
  CHECK_OK(conic_hybrid_build(context, &copy, &options, &c.hybrid, NULL));
  CHECK_OK(conic_renderer_create(context, &c.renderer));
  for (size_t i = 0; i < N_DIRECTIONS; i++)
    check_direction(&c, limit, directions[i]);
  check_nodes(&c, limit->name ? limit->name : "terrain");
  check_said(&c, limit->name ? limit->name : "terrain");
  conic_image_release(context, &c.reduced_truth);
  conic_image_release(context, &c.truth);
  conic_image_release(context, &c.image);
  conic_hybrid_selection_release(context, &c.selection);
  conic_renderer_destroy(c.renderer);
  conic_hybrid_destroy(c.hybrid);
  conic_face_tree_release(context, &c.tree);
  conic_adjacency_release(context, &adjacency);
  conic_triangles_release(context, &c.mesh);
}

int main(int argc, char **argv) {
  conic_context *context = check_context(2);
  for (size_t i = 0; i < N_MODELS; i++) {
    const char *name = all_limits[i].name;
    const char *path = name ? check_data(argc > 1 ? argv[1] : ".", name) : NULL;
    if (!name || path)
      check_model(context, &all_limits[i], path);
  }
  conic_context_destroy(context);
  return check_result();
}
