/* The loops of building an octree and of choosing from it; and that what they leave out would change nothing. */
#include "bench/loops/cross.h"
#include "tests/support/octree_fixture.h"

enum { N_DISCS = 1000, ROOM = 1024, N_ARRAYS = 13, N_OVER = 300, N_BLOCKS = ROOM / CONIC_DISC_BLOCK };

/* --- covering --- */

typedef struct cover_desk {
  cross_desk memory;
  conic_disc_samples samples;
  conic_discs discs;
  conic_near_discs near;
  float *errors[3]; /* of all nodes: by everything, its own leaves first; everything at once; what is near */
  float (*numbers)[ROOM], (*block_numbers)[N_BLOCKS], (*near_numbers)[N_BLOCKS];
  uint64_t *n_near;
} cover_desk;

static cover_desk *open_cover(void) {
  cover_desk *d = cross_calloc(sizeof *d);
  d->numbers = cross_room(&d->memory, "discs", N_ARRAYS * sizeof *d->numbers);
  d->block_numbers = cross_room(&d->memory, "blocks", 6 * sizeof *d->block_numbers);
  d->near_numbers = cross_room(&d->memory, "near boxes", 6 * sizeof *d->near_numbers);
  d->near.blocks.block = cross_room(&d->memory, "near blocks", N_BLOCKS * sizeof(uint32_t));
  for (int i = 0; i < 3; i++)
    d->errors[i] = cross_room(&d->memory, "errors", N_OVER * sizeof *d->errors[i]);
  d->n_near = cross_room(&d->memory, "numbers of blocks", N_OVER * sizeof *d->n_near);
  d->near.flat = cross_room(&d->memory, "flattened", N_BLOCKS * sizeof *d->near.flat);
  d->near.are_flat = cross_room(&d->memory, "which are", (N_BLOCKS / CONIC_DISC_BLOCK + 1) * sizeof(uint16_t));
  for (int i = d->memory.n_arenas - 2; i < d->memory.n_arenas; i++)
    d->memory.arenas[i].compared = 0; /* what lanes work in */
  return d;
}

/* A wavy sheet of discs about (-1 … 1)², row by row, with a hole in the middle. */
static void lay_sheet(cover_desk *s) {
  conic_discs *discs = &s->discs;
  for (int axis = 0; axis < 3; axis++) {
    discs->center[axis] = s->numbers[axis];
    discs->u[axis] = s->numbers[3 + axis];
    discs->v[axis] = s->numbers[6 + axis];
    discs->half[axis] = s->numbers[9 + axis];
    discs->block_center[axis] = s->block_numbers[axis];
    discs->block_half[axis] = s->block_numbers[3 + axis];
    s->near.blocks.center[axis] = s->near_numbers[axis];
    s->near.blocks.half[axis] = s->near_numbers[3 + axis];
  }
  discs->error = s->numbers[12];
  discs->count = N_DISCS;
  for (size_t k = 0; k < N_DISCS; k++) {
    size_t row = k / 32;
    float x = (float)(k % 32) / 16.0f - 1.0f, y = (float)row / 16.0f - 1.0f;
    int is_hole = x * x + y * y < 0.09f;
    const float place[3] = {is_hole ? 2.0f + x : x, y, 0.05f * x * y};
    for (int axis = 0; axis < 3; axis++) {
      discs->center[axis][k] = place[axis];
      discs->u[axis][k] = axis == 0 ? 0.06f : 0.01f * x;
      discs->v[axis][k] = axis == 1 ? 0.05f : 0.02f * y;
    }
    discs->error[k] = k % 17 == 0 ? 0.004f : 0.0f;
  }
  conic_discs_set_half(discs, 0);
  conic_discs_close(discs);
  conic_disc_samples_init(&s->samples);
}

/* A node over the leaves from `begin` on; some are where nothing is. */
static conic_node_disc node_over(const conic_discs *discs, size_t begin, int i) {
  float size = 0.05f + 0.002f * (float)(i % 100), shift = i % 7 == 0 ? 0.3f : 0.0f;
  conic_node_disc node = {.u = {size, 0.0f, 0.02f * size},
                          .v = {0.0f, 0.7f * size, 0.0f},
                          .n = {-0.019996f, 0.0f, 0.99980006f},
                          .enough = 0.3f * size};
  for (int axis = 0; axis < 3; axis++)
    node.center[axis] = discs->center[axis][begin] + shift;
  return node;
}

/* Finds what is near a node, up to `reach` about its centre. */
static void look_near(const cross_tables *tables, cover_desk *s, const conic_node_disc *node, float reach) {
  for (int axis = 0; axis < 3; axis++) {
    s->near.center[axis] = node->center[axis];
    s->near.half[axis] = reach;
  }
  tables->octree.find_near(&s->discs, &s->near);
}

static void run_find_near(const cross_tables *tables, cross_desk *desk) {
  cover_desk *s = (cover_desk *)(void *)desk;
  for (int i = 0; i < N_OVER; i++) {
    conic_node_disc node = node_over(&s->discs, (size_t)(i * 37) % (N_DISCS - 8), i);
    look_near(tables, s, &node, 0.06f * (float)(i % 50));
    s->n_near[i] = s->near.blocks.count;
  }
}

static void run_cover(const cross_tables *tables, cross_desk *desk) {
  cover_desk *s = (cover_desk *)(void *)desk;
  for (int i = 0; i < N_OVER; i++) {
    size_t begin = (size_t)(i * 37) % (N_DISCS - 8), end = begin + 2 + (size_t)(i % 6);
    conic_node_disc node = node_over(&s->discs, begin, i);
    look_near(tables, s, &node, 3.0f);
    CHECK(s->near.blocks.count == (N_DISCS + CONIC_DISC_BLOCK - 1) / CONIC_DISC_BLOCK);
    s->errors[0][i] = tables->octree.cover(&s->samples, &s->discs, begin, end, &s->near, &node);
    s->errors[1][i] = tables->octree.cover(&s->samples, &s->discs, 0, N_DISCS, &s->near, &node);
    look_near(tables, s, &node, 0.06f * (float)(i % 5));
    s->errors[2][i] = tables->octree.cover(&s->samples, &s->discs, begin, end, &s->near, &node);
  }
}

/* Whatever of the discs is looked at first, and however few are thought to be near. */
static void check_cover(const cover_desk *s) {
  int n_enough = 0;
  for (int i = 0; i < N_OVER; i++) {
    float enough = node_over(&s->discs, (size_t)(i * 37) % (N_DISCS - 8), i).enough, error = s->errors[0][i];
    CHECK(error >= enough && error < HUGE_VALF);
    CHECK(error == s->errors[1][i] && error == s->errors[2][i]);
    n_enough += error == enough;
  }
  CHECK(n_enough > N_OVER / 10 && n_enough < N_OVER);
}

static void try_cover(cross *c) {
  static const cross_slot slots[] = {{"find near", "octree", run_find_near, "node", N_OVER},
                                     {"cover", "octree", run_cover, "3 nodes", N_OVER}};
  cover_desk *desks[CONIC_N_ISAS];
  for (int i = 0; i < c->n_tables; i++) {
    desks[i] = open_cover();
    lay_sheet(desks[i]);
  }
  cross_try(c, &slots[0], (cross_desk **)(void *)desks);
  cross_try(c, &slots[1], (cross_desk **)(void *)desks);
  for (int i = 0; i < c->n_tables; i++) {
    check_cover(desks[i]);
    cross_close(&desks[i]->memory);
  }
}

/* --- fitting --- */

enum { N_LEAVES = 4003, N_REACHES = 43, N_SHAPES = (N_LEAVES - CONIC_FEW_LEAVES) / 7 + 1 };

static const conic_node_frame tilted = {
    .position = {0.01, 0.02, 0.0}, .u = {0.8, 0.6, 0.0}, .v = {-0.6, 0.8, 0.0}, .n = {0.0, 0.0, 1.0}, .ratio = 0.5};

static const conic_ellipse shape = {.major = {0.6, 0.8}, .ratio = 0.4};

typedef struct fit_desk {
  cross_desk memory;
  const conic_splats *leaves;
  conic_leaf_reach *all, *slow; /* of so many of the last leaves: all at once, and one by one */
  double *ratios;
} fit_desk;

/* How many leaves a reach is of: a few, and many, up to the set's last. */
static size_t n_reached(int i) {
  return i < 40 ? (size_t)i + 1 : 40 + 991 * ((size_t)i - 39);
}

static void run_add_reach(const cross_tables *tables, cross_desk *desk) {
  fit_desk *d = (fit_desk *)(void *)desk;
  for (int i = 0; i < N_REACHES; i++) {
    size_t end = d->leaves->count, begin = end - n_reached(i);
    d->all[i] = (conic_leaf_reach){.cosine = 1.0};
    tables->octree.add_reach(d->leaves, begin, end, 1.5, &tilted, &d->all[i]);
  }
}

static void run_add_each(const cross_tables *tables, cross_desk *desk) {
  fit_desk *d = (fit_desk *)(void *)desk;
  for (int i = 0; i < N_REACHES; i++) {
    size_t end = d->leaves->count, begin = end - n_reached(i);
    d->slow[i] = (conic_leaf_reach){.cosine = 1.0};
    for (size_t k = begin; k < end; k++)
      tables->octree.add_reach(d->leaves, k, k + 1, 1.5, &tilted, &d->slow[i]);
  }
}

static void run_choose_ratio(const cross_tables *tables, cross_desk *desk) {
  fit_desk *d = (fit_desk *)(void *)desk;
  for (size_t i = 0; i < N_SHAPES; i++)
    d->ratios[i] = tables->octree.choose_ratio(d->leaves, 7 * i, 7 * i + 2 + 7 * i % (CONIC_FEW_LEAVES - 1), 1.5,
                                               tilted.position, tilted.u, tilted.v, &shape, 0.1);
}

/* What is left out would change nothing; ratios are some of those tried. */
static void check_fit(const fit_desk *d) {
  int n_changed = 0;
  for (int i = 0; i < N_REACHES; i++) {
    const conic_leaf_reach *all = &d->all[i];
    CHECK(memcmp(all, &d->slow[i], sizeof *all) == 0);
    CHECK(all->reach > 0.0 && all->radius > 0.0 && all->height > 0.0 && all->cosine < 1.0);
  }
  for (int i = 0; i < N_SHAPES; i++) {
    CHECK(d->ratios[i] >= 0.5 * 0.4 && d->ratios[i] <= 1.5 * 0.4);
    n_changed += d->ratios[i] != shape.ratio;
  }
  CHECK(n_changed > 20);
}

static void try_fit(cross *c) {
  static const cross_slot slots[] = {{"add reach", "octree", run_add_reach, "range", N_REACHES},
                                     {"add reach", "one by one", run_add_each, "range", N_REACHES},
                                     {"choose ratio", "octree", run_choose_ratio, "shape", N_SHAPES}};
  fit_desk *desks[CONIC_N_ISAS];
  fixture f = fixture_open(1);
  fixture_scene(&f, CONIC_SCENE_TERRAIN, N_LEAVES);
  for (int i = 0; i < c->n_tables; i++) {
    desks[i] = cross_calloc(sizeof *desks[i]);
    desks[i]->leaves = &f.splats;
    desks[i]->all = cross_room(&desks[i]->memory, "reaches", N_REACHES * sizeof *desks[i]->all);
    desks[i]->slow = cross_room(&desks[i]->memory, "reaches one by one", N_REACHES * sizeof *desks[i]->slow);
    desks[i]->ratios = cross_room(&desks[i]->memory, "ratios", N_SHAPES * sizeof *desks[i]->ratios);
  }
  for (int i = 0; i < 3; i++)
    cross_try(c, &slots[i], (cross_desk **)(void *)desks);
  for (int i = 0; i < c->n_tables; i++) {
    check_fit(desks[i]);
    cross_close(&desks[i]->memory);
  }
  fixture_close(&f);
}

/* --- choosing --- */

enum { N_PUT = 77, N_FIELDS = 13 };

typedef struct choose_desk {
  cross_desk memory;
  const conic_octree *octree;
  const conic_octree_view *view;
  const uint32_t *sources;
  float *pixels;
  conic_splats put;
  uint32_t *ids;
} choose_desk;

static choose_desk *open_choose(const conic_octree *octree, const conic_octree_view *view, const uint32_t *sources) {
  choose_desk *d = cross_calloc(sizeof *d);
  d->octree = octree;
  d->view = view;
  d->sources = sources;
  d->pixels = cross_room(&d->memory, "errors", (octree->n_nodes + CONIC_OCTREE_GROUP) * sizeof *d->pixels);
  d->memory.arenas[0].compared = octree->n_nodes * sizeof *d->pixels;
  d->ids = cross_room(&d->memory, "ids", N_PUT * sizeof *d->ids);
  float **const arrays[] = {d->put.position, d->put.tangent_u, d->put.tangent_v, d->put.color};
  for (int i = 0; i < N_FIELDS - 1; i++)
    arrays[i / 3][i % 3] = cross_room(&d->memory, "splats", N_PUT * sizeof(float));
  d->put.opacity = cross_room(&d->memory, "opacities", N_PUT * sizeof(float));
  d->put.count = N_PUT;
  return d;
}

CROSS_RUN(run_measure, choose_desk, tables->octree.measure(d->octree, d->view, 0, d->octree->n_nodes, d->pixels))
CROSS_RUN(run_put, choose_desk, tables->octree.put(d->octree, d->sources, N_PUT, d->view->eye, &d->put, d->ids, 0))

/* What is put are the nodes' own numbers. */
static void check_put(const choose_desk *d) {
  int n_turned = 0, n_other = 0;
  for (size_t k = 0; k < N_PUT; k++) {
    int is_node = d->sources[k] >> 31 != 0;
    const conic_drawn_node *from =
        &(is_node ? d->octree->drawn : d->octree->drawn_leaves)[d->sources[k] & ~CONIC_NODE_BIT];
    int is_turned = d->put.tangent_v[0][k] != from->tangent_v[0];
    n_turned += is_turned;
    n_other += d->ids[k] != from->id || d->put.opacity[k] != from->opacity || (is_turned && !is_node);
    for (int axis = 0; axis < 3; axis++)
      n_other += d->put.position[axis][k] != from->position[axis] || d->put.color[axis][k] != from->color[axis] ||
                 d->put.tangent_u[axis][k] != from->tangent_u[axis] ||
                 d->put.tangent_v[axis][k] != (is_turned ? -from->tangent_v[axis] : from->tangent_v[axis]);
  }
  CHECK(n_other == 0);
  CHECK(n_turned > 0 && n_turned < N_PUT / 3);
}

static void try_choose(cross *c) {
  uint32_t sources[N_PUT];
  fixture f = fixture_open(1);
  fixture_scene(&f, CONIC_SCENE_KNOT, 3000);
  octree_frame(&f, 200, 10, 30, 3.0);
  f.options.cull_back = 1;
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  CHECK_OK(conic_octree_decode_all(octree));
  conic_octree_view view;
  conic_octree_view_init(octree, &f.camera, &f.options, conic_octree_near(octree), &view);
  const cross_slot slots[] = {{"measure", "octree", run_measure, "node", (double)octree->n_nodes},
                              {"put", "octree", run_put, "splat", N_PUT}};
  choose_desk *desks[CONIC_N_ISAS];
  for (uint32_t k = 0; k < N_PUT; k++)
    sources[k] = k % 3 ? k * 31 : CONIC_NODE_BIT | (k * 11);
  for (int i = 0; i < c->n_tables; i++)
    desks[i] = open_choose(octree, &view, sources);
  cross_try(c, &slots[0], (cross_desk **)(void *)desks);
  cross_try(c, &slots[1], (cross_desk **)(void *)desks);
  for (int i = 0; i < c->n_tables; i++) {
    check_put(desks[i]);
    cross_close(&desks[i]->memory);
  }
  conic_octree_destroy(octree);
  fixture_close(&f);
}

int cli_cross_octree(cross *c) {
  try_choose(c);
  try_cover(c);
  try_fit(c);
  return check_failures;
}
