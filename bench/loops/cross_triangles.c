/* Triangles, wild and hostile: their vertices, what each tile draws, and what its rows do to the splats' passes. */
#include "bench/loops/cross.h"
#include "raster/triangles/triangle_tile.h"
#include "tests/support/triangle_fixture.h"

/* A frame's vertices, one of its tiles, and a row of that as the slots find it: some blocks with splats' thresholds and
 * sums, some empty. */
typedef struct triangle_desk {
  cross_desk memory;
  const conic_triangle_frame *frame;
  const conic_finish *finish;
  size_t first_vertex;
  conic_screen_vertex *vertices;
  size_t i_tile;
  int x, y;
  conic_tile_rays rays;
  conic_band band;
  conic_triangle_tile *tile;
  conic_kept *kept;
  conic_block_sums *sums, before[CONIC_BAND_BLOCKS]; /* as add finds them */
} triangle_desk;

enum { VERTICES, TILE, KEPT, SUMS };

static triangle_desk *open_tile(const conic_triangle_frame *frame, const conic_finish *finish) {
  triangle_desk *d = cross_calloc(sizeof *d);
  d->frame = frame;
  d->finish = finish;
  d->vertices = cross_room(&d->memory, "vertices", frame->triangles->n_vertices * sizeof *d->vertices);
  d->tile = cross_room(&d->memory, "tile", sizeof *d->tile);
  d->kept = cross_room(&d->memory, "kept", (CONIC_BAND_BLOCKS + 1) * sizeof *d->kept);
  d->sums = cross_room(&d->memory, "sums", CONIC_BAND_BLOCKS * sizeof *d->sums);
  d->memory.arenas[KEPT].compared = 0; /* of it only thresholds are anyone's: compare_rows */
  return d;
}

/* Vertices with special values in them. */
static void spoil_vertices(conic_triangles *t, uint64_t seed) {
  static const float specials[] = {NAN, INFINITY, -INFINITY, 0.0f, -0.0f, 1e-42f, 1e30f, -1e30f, 1e-20f, 3e38f};
  uint64_t state = seed;
  for (size_t i = 0; i < t->n_vertices; i++)
    if (fixture_random(&state) < 0.05)
      t->position[i % 3][i] = specials[(int)(fixture_random(&state) * 10.0)];
}

static void run_vertices(const cross_tables *tables, cross_desk *desk) {
  triangle_desk *d = (triangle_desk *)(void *)desk;
  size_t n = d->frame->triangles->n_vertices;
  tables->raster.triangles.vertices(d->frame, d->first_vertex, n - d->first_vertex, d->vertices);
}

CROSS_RUN(run_draw, triangle_desk, tables->raster.triangles.draw(d->frame, d->i_tile, d->x, d->y, d->tile))
CROSS_RUN(run_hide, triangle_desk, tables->raster.triangles.hide(&d->band, &d->rays))

static void run_add(const cross_tables *tables, cross_desk *desk) {
  triangle_desk *d = (triangle_desk *)(void *)desk;
  memcpy(d->sums, d->before, sizeof d->before);
  tables->raster.triangles.add(&d->band, d->finish, &d->rays);
}

/* `blocks` are those of the row on any of the desks. */
static void set_row(triangle_desk *d, const conic_triangle_block *blocks, int i_row, uint64_t state) {
  const conic_triangle_frame *frame = d->frame;
  int left = frame->view->width - d->x, across = left < frame->tile ? left : frame->tile;
  d->band = (conic_band){.view = frame->view,
                         .x = d->x,
                         .y = d->y + i_row * CONIC_BLOCK_EDGE,
                         .n_blocks = (across + CONIC_BLOCK_EDGE - 1) / CONIC_BLOCK_EDGE,
                         .kept = d->kept,
                         .sums = d->sums};
  memset(d->sums, 0, CONIC_BAND_BLOCKS * sizeof *d->sums);
  for (int block = 0; block < d->band.n_blocks; block++) {
    d->band.n_kept[block] = fixture_random(&state) < 0.5;
    for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
      d->kept[block].threshold[l] = fixture_random(&state) < 0.5 ? 0.0f : (float)fixture_random(&state);
      for (int axis = 0; axis < 3; axis++) /* sums that a visible splat of no weight leaves: what is added is seen */
        d->sums[block].color[axis][l] = (float)fixture_random(&state);
    }
  }
  memcpy(d->before, d->sums, sizeof d->before);
  conic_triangle_tile_row(frame, d->tile, i_row, &d->band);
  if (d->band.triangles)
    d->band.triangles->blocks = blocks;
}

static void compare_rows(const triangle_desk *a, const triangle_desk *b) {
  for (int block = 0; block < a->band.n_blocks; block++) {
    CHECK(memcmp(a->kept[block].threshold, b->kept[block].threshold, sizeof a->kept[block].threshold) == 0);
    CHECK(a->band.n_kept[block] == b->band.n_kept[block]);
  }
}

static void try_row(cross *c, triangle_desk **desks, const cross_slot slots[2], int i_row) {
  uint64_t state = c->seed + desks[0]->i_tile * 31 + (uint64_t)i_row;
  for (int i = 0; i < c->n_tables; i++)
    set_row(desks[i], desks[0]->tile->blocks[i_row], i_row, state);
  for (int k = 0; k < 2 && desks[0]->band.triangles; k++) {
    cross_try(c, &slots[k], (cross_desk **)(void *)desks);
    for (int i = 1; i < c->n_tables; i++)
      compare_rows(desks[0], desks[i]);
  }
}

/* Returns how many fragments are drawn. */
static uint64_t try_tile(cross *c, triangle_desk **desks, size_t i_tile) {
  const conic_triangle_frame *frame = desks[0]->frame;
  const cross_slot slots[] = {{"triangles draw", NULL, run_draw, "tile", 1.0},
                              {"triangles hide", NULL, run_hide, "row", 1.0},
                              {"triangles add", NULL, run_add, "row", 1.0}};
  for (int i = 0; i < c->n_tables; i++) {
    triangle_desk *d = desks[i];
    d->i_tile = i_tile;
    d->x = (int)(i_tile % (size_t)frame->n_tiles_x) * frame->tile;
    d->y = (int)(i_tile / (size_t)frame->n_tiles_x) * frame->tile;
    conic_tile_rays_init(frame->view, d->x, d->y, &d->rays);
    memset(d->tile, CROSS_PATTERN, sizeof *d->tile);
  }
  cross_try(c, &slots[0], (cross_desk **)(void *)desks);
  int n_rows = c->is_bench ? 1 : frame->tile / CONIC_BLOCK_EDGE;
  for (int i_row = 0; i_row < n_rows && desks[0]->y + i_row * CONIC_BLOCK_EDGE < frame->view->height; i_row++)
    try_row(c, desks, slots + 1, i_row);
  return desks[0]->tile->n_fragments;
}

/* From places that are no multiples of a vector, and to such. */
static void try_vertices(cross *c, triangle_desk **desks) {
  size_t n = desks[0]->frame->triangles->n_vertices;
  const cross_slot slot = {"vertices", NULL, run_vertices, "vertex", (double)n};
  for (size_t begin = 0; begin < (c->is_bench ? 1 : 21); begin += 7) {
    for (int i = 0; i < c->n_tables; i++) {
      desks[i]->first_vertex = begin;
      memset(desks[i]->vertices, CROSS_PATTERN, n * sizeof *desks[i]->vertices);
    }
    cross_try(c, &slot, (cross_desk **)(void *)desks);
  }
}

static void try_frame(cross *c, const conic_triangle_frame *frame, const conic_finish *finish) {
  triangle_desk *desks[CONIC_N_ISAS];
  uint64_t n_fragments = 0;
  for (int i = 0; i < c->n_tables; i++)
    desks[i] = open_tile(frame, finish);
  try_vertices(c, desks);
  for (size_t i_tile = c->is_bench ? frame->n_tiles / 2 : 0; i_tile < frame->n_tiles; i_tile++) {
    n_fragments += try_tile(c, desks, i_tile);
    if (c->is_bench)
      break;
  }
  CHECK(n_fragments > 10000 || c->is_bench);
  for (int i = 0; i < c->n_tables; i++)
    cross_close(&desks[i]->memory);
}

/* A frame of them in tiles of the size, by plain C. */
static conic_triangle_frame prepare_frame(cross *c, fixture *f, const conic_triangles *t, conic_view *view, int tile) {
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
  CHECK_OK(conic_triangle_frame_prepare(&frame, &c->tables[0].raster.triangles));
  return frame;
}

int cli_cross_triangles(cross *c) {
  static const int tiles[] = {64, 8, 32};
  fixture f = fixture_open(1);
  fixture_camera(&f, 171, 103, 110.0);
  const conic_finish finish = {.options = &f.options, .world_from_cam = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int i = 0; i < (c->is_bench ? 1 : 3); i++) {
    conic_view view;
    conic_triangles t = triangles_wild(&f, 1500);
    if (i == 2)
      spoil_vertices(&t, c->seed);
    conic_triangle_frame frame = prepare_frame(c, &f, &t, &view, tiles[i]);
    try_frame(c, &frame, &finish);
    conic_triangle_frame_release(f.context, &frame);
    conic_triangles_release(f.context, &t);
  }
  fixture_close(&f);
  return check_failures;
}
