/* The triangles' slots of every kernel table against the plain C one, bit for bit, on wild and on hostile input, and
 * within what they may write. */
#include "raster/kernels/tile_kernels.h"
#include "raster/triangles/triangle_tile.h"
#include "tests/support/triangle_fixture.h"

/* A frame of triangles, prepared by a table. */
static conic_triangle_frame prepare(fixture *f, const conic_triangles *t, conic_view *view,
                                    const conic_tile_kernels *kernels, int tile) {
  static float nothing;
  conic_triangle_frame frame;
  conic_splats none;
  memset(&frame, 0, sizeof frame);
  memset(&none, 0, sizeof none);
  none.position[0] = none.tangent_u[0] = none.tangent_v[0] = &nothing;
  CHECK_OK(conic_view_init(f->context, &none, &f->camera, &f->options, 0.05, 0.0, view));
  conic_triangle_frame_begin(&frame, f->context, t, view, &f->camera);
  conic_triangle_frame_tiles(&frame, tile);
  frame.epsilon = 0.1f;
  CHECK_OK(conic_triangle_frame_prepare(&frame, kernels));
  return frame;
}

/* Vertices with special values in them. */
static void spoil(conic_triangles *t, uint64_t seed) {
  static const float specials[] = {NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 1e-42f, 1e30f, -1e30f, 1e-20f, 3e38f};
  uint64_t state = seed;
  for (size_t i = 0; i < t->n_vertices; i++)
    if (fixture_random(&state) < 0.05)
      t->position[i % 3][i] = specials[(int)(fixture_random(&state) * 10.0)];
}

static void compare_vertices(const conic_triangle_frame *frame, const conic_tile_kernels *kernels) {
  enum { MOST = 4096 };
  static conic_screen_vertex expected[MOST + 2], found[MOST + 2];
  size_t n = frame->triangles->n_vertices < MOST ? frame->triangles->n_vertices : MOST;
  for (size_t begin = 0; begin < 21; begin += 7) { /* from places that are no multiples of a vector, and to such */
    memset(expected, 0xa5, sizeof expected);
    memset(found, 0xa5, sizeof found);
    conic_triangle_vertices(frame, begin, n - begin, expected);
    kernels->triangle_vertices(frame, begin, n - begin, found);
    CHECK(memcmp(expected, found, sizeof found) == 0);
  }
}

/* One row of a tile as the slots find it: some blocks with splats' thresholds and sums, some empty. */
typedef struct row_desk {
  conic_band band;
  conic_triangle_tile tile;
  conic_kept kept[CONIC_BAND_BLOCKS + 1];
  conic_block_sums sums[CONIC_BAND_BLOCKS];
} row_desk;

static void set_row(row_desk *d, const conic_triangle_frame *frame, int i_row, int x, int y, uint64_t seed) {
  uint64_t state = seed;
  memset(&d->band, 0, sizeof d->band);
  d->band.view = frame->view;
  d->band.x = x;
  d->band.y = y + i_row * CONIC_BLOCK_EDGE;
  int left = frame->view->width - x, across = left < frame->tile ? left : frame->tile;
  d->band.n_blocks = (across + CONIC_BLOCK_EDGE - 1) / CONIC_BLOCK_EDGE;
  d->band.kept = d->kept;
  d->band.sums = d->sums;
  memset(d->sums, 0, sizeof d->sums);
  for (int block = 0; block < d->band.n_blocks; block++) {
    d->band.n_kept[block] = fixture_random(&state) < 0.5;
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
      d->kept[block].threshold[l] = fixture_random(&state) < 0.5 ? 0.0f : (float)fixture_random(&state);
      for (int axis = 0; axis < 3; axis++) /* sums that a visible splat of no weight leaves: what is added is seen */
        d->sums[block].color[axis][l] = (float)fixture_random(&state);
    }
  }
  conic_triangle_tile_row(frame, &d->tile, i_row, &d->band);
}

static int same_rows(const row_desk *a, const row_desk *b) {
  int n = a->band.n_blocks;
  for (int block = 0; block < n; block++) {
    if (memcmp(a->kept[block].threshold, b->kept[block].threshold, sizeof a->kept[block].threshold) != 0)
      return 0;
    if (a->band.n_kept[block] != b->band.n_kept[block] ||
        memcmp(&a->sums[block], &b->sums[block], sizeof a->sums[block]) != 0)
      return 0;
  }
  return memcmp(a->tile.row.visible, b->tile.row.visible, sizeof a->tile.row.visible) == 0 &&
         memcmp(a->tile.row.heaviest, b->tile.row.heaviest, sizeof a->tile.row.heaviest) == 0 &&
         memcmp(a->tile.row.nearest, b->tile.row.nearest, sizeof a->tile.row.nearest) == 0;
}

static size_t compare_tile(const conic_triangle_frame *frame, const conic_tile_kernels *kernels, size_t i_tile,
                           const conic_finish *finish) {
  static row_desk expected, found;
  const conic_tile_kernels *plain = &conic_tile_kernels_scalar;
  int x = (int)(i_tile % (size_t)frame->n_tiles_x) * frame->tile;
  int y = (int)(i_tile / (size_t)frame->n_tiles_x) * frame->tile;
  conic_tile_rays rays;
  conic_tile_rays_init(frame->view, x, y, &rays);
  memset(&expected.tile, 0xa5, sizeof expected.tile);
  memset(&found.tile, 0xa5, sizeof found.tile);
  plain->triangles_draw(frame, i_tile, x, y, &expected.tile);
  kernels->triangles_draw(frame, i_tile, x, y, &found.tile);
  CHECK(expected.tile.n_fragments == found.tile.n_fragments);
  CHECK(memcmp(expected.tile.blocks, found.tile.blocks, sizeof found.tile.blocks) == 0);
  CHECK(memcmp(expected.tile.covered, found.tile.covered, sizeof found.tile.covered) == 0);
  for (int i_row = 0; i_row < frame->tile / CONIC_BLOCK_EDGE && y + i_row * CONIC_BLOCK_EDGE < frame->view->height;
       i_row++) {
    set_row(&expected, frame, i_row, x, y, i_tile * 31 + (size_t)i_row);
    set_row(&found, frame, i_row, x, y, i_tile * 31 + (size_t)i_row);
    if (!expected.band.triangles)
      continue;
    plain->triangles_hide(&expected.band, &rays);
    kernels->triangles_hide(&found.band, &rays);
    plain->triangles_add(&expected.band, finish, &rays);
    kernels->triangles_add(&found.band, finish, &rays);
    CHECK(same_rows(&expected, &found));
  }
  return expected.tile.n_fragments;
}

static void compare_table(const conic_tile_kernels *kernels) {
  static const int tiles[] = {8, 64, 32};
  fixture f = fixture_open(1);
  fixture_camera(&f, 171, 103, 110.0);
  conic_finish finish;
  memset(&finish, 0, sizeof finish);
  finish.options = &f.options;
  for (int axis = 0; axis < 3; axis++)
    finish.world_from_cam[axis][axis] = 1.0f;
  for (int i = 0; i < 3; i++) {
    conic_view view;
    conic_triangles t = triangles_wild(&f, 1500);
    if (i == 2)
      spoil(&t, 9);
    conic_triangle_frame frame = prepare(&f, &t, &view, kernels, tiles[i]);
    size_t n_fragments = 0;
    compare_vertices(&frame, kernels);
    for (size_t i_tile = 0; i_tile < frame.n_tiles; i_tile++)
      n_fragments += compare_tile(&frame, kernels, i_tile, &finish);
    CHECK(n_fragments > 10000);
    conic_triangle_frame_release(f.context, &frame);
    conic_triangles_release(f.context, &t);
  }
  fixture_close(&f);
}

int main(void) {
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    const conic_tile_kernels *kernels = conic_tile_kernels_of((conic_isa)isa);
    if (!kernels)
      continue;
    printf("%s\n", kernels->name);
    compare_table(kernels);
  }
  return check_result();
}
