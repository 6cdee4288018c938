/* The loops of building give the same on every instruction set, and what they leave out would change nothing. */
#include "core/base/memory.h"
#include "core/lanes/processor.h"
#include "lod/octree/octree_kernels.h"
#include "tests/support/octree_fixture.h"

enum { N_DISCS = 1000, ROOM = 1024, N_ARRAYS = 13, N_NODES = 300, N_BLOCKS = ROOM / CONIC_DISC_BLOCK };

typedef struct surface {
  float numbers[N_ARRAYS][ROOM], block_numbers[6][N_BLOCKS], list_numbers[12][N_BLOCKS];
  uint32_t blocks[2][N_BLOCKS];
  float flat[N_BLOCKS][CONIC_FLAT_NUMBERS][CONIC_DISC_BLOCK];
  conic_discs discs;
  conic_near_discs near;
} surface;

/* A wavy sheet of discs about (-1 … 1)², row by row, with a hole in the middle. */
static void lay_sheet(surface *s) {
  conic_discs *discs = &s->discs;
  for (int axis = 0; axis < 3; axis++) {
    discs->center[axis] = s->numbers[axis];
    discs->u[axis] = s->numbers[3 + axis];
    discs->v[axis] = s->numbers[6 + axis];
    discs->half[axis] = s->numbers[9 + axis];
    discs->block_center[axis] = s->block_numbers[axis];
    discs->block_half[axis] = s->block_numbers[3 + axis];
    s->near.blocks.center[axis] = s->list_numbers[axis];
    s->near.blocks.half[axis] = s->list_numbers[3 + axis];
    s->near.of_node.center[axis] = s->list_numbers[6 + axis];
    s->near.of_node.half[axis] = s->list_numbers[9 + axis];
  }
  s->near.blocks.block = s->blocks[0];
  s->near.of_node.block = s->blocks[1];
  s->near.flat = s->flat;
  discs->error = s->numbers[12];
  discs->count = N_DISCS;
  for (size_t k = 0; k < N_DISCS; k++) {
    float x = (float)(k % 32) / 16.0f - 1.0f, y = (float)(k / 32) / 16.0f - 1.0f;
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

/* All that this machine has besides the plain ones. Returns how many. */
static int list_kernels(conic_octree_kernels kernels[2]) {
  int n = 0;
#if defined(__x86_64__)
  if (conic_has_avx2())
    kernels[n++] = (conic_octree_kernels){conic_cover_avx2,        conic_find_near_avx2, conic_add_reach_avx2,
                                          conic_choose_ratio_avx2, conic_measure_avx2,   conic_put_avx2};
#endif
  kernels[n++] = conic_octree_kernels_choose();
  return n;
}

/* What is near a node, up to `reach` about its centre. */
static void set_near(surface *s, const conic_node_disc *node, float reach) {
  for (int axis = 0; axis < 3; axis++) {
    s->near.center[axis] = node->center[axis];
    s->near.half[axis] = reach;
  }
}

static void test_cover(void) {
  static surface s;
  conic_disc_samples samples;
  conic_disc_samples_init(&samples);
  lay_sheet(&s);
  conic_octree_kernels kernels[2];
  int n_kernels = list_kernels(kernels), n_enough = 0, n_moved = 0;
  for (int i = 0; i < N_NODES; i++) {
    size_t begin = (size_t)(i * 37) % (N_DISCS - 8), end = begin + 2 + (size_t)(i % 6);
    conic_node_disc node = node_over(&s.discs, begin, i);
    set_near(&s, &node, 3.0f); /* everything */
    conic_find_near_baseline(&s.discs, &s.near);
    CHECK(s.near.blocks.count == (N_DISCS + CONIC_DISC_BLOCK - 1) / CONIC_DISC_BLOCK);
    float error = conic_cover_baseline(&samples, &s.discs, begin, end, &s.near, &node);
    CHECK(error >= node.enough && error < HUGE_VALF);
    n_enough += error == node.enough;
    /* Whatever of the discs is looked at first, and however few are thought to be near. */
    for (int k = 0; k < n_kernels; k++) {
      n_moved += error != kernels[k].cover(&samples, &s.discs, begin, end, &s.near, &node);
      n_moved += error != kernels[k].cover(&samples, &s.discs, 0, N_DISCS, &s.near, &node);
    }
    set_near(&s, &node, 0.06f * (float)(i % 5));
    for (int k = 0; k < n_kernels; k++) {
      kernels[k].find_near(&s.discs, &s.near);
      n_moved += error != kernels[k].cover(&samples, &s.discs, begin, end, &s.near, &node);
    }
  }
  CHECK(n_enough > N_NODES / 10 && n_enough < N_NODES);
  CHECK(n_moved == 0);
}

static const conic_node_frame tilted = {
    .position = {0.01, 0.02, 0.0}, .u = {0.8, 0.6, 0.0}, .v = {-0.6, 0.8, 0.0}, .n = {0.0, 0.0, 1.0}, .ratio = 0.5};

/* All at once and one by one, up to the set's last: what is left out would change nothing. */
static void test_reach(void) {
  fixture f = fixture_open(1);
  fixture_scene(&f, CONIC_SCENE_TERRAIN, 4003);
  conic_octree_kernels kernels[2];
  int n_kernels = list_kernels(kernels);
  for (size_t n = 1; n <= f.splats.count; n += n < 40 ? 1 : 991) {
    size_t begin = f.splats.count - n;
    conic_leaf_reach all = {.cosine = 1.0};
    conic_add_reach_baseline(&f.splats, begin, f.splats.count, 1.5, &tilted, &all);
    for (int k = 0; k < n_kernels; k++) {
      conic_leaf_reach again = {.cosine = 1.0}, slow = again;
      kernels[k].add_reach(&f.splats, begin, f.splats.count, 1.5, &tilted, &again);
      for (size_t i = begin; i < f.splats.count; i++)
        kernels[k].add_reach(&f.splats, i, i + 1, 1.5, &tilted, &slow);
      CHECK(memcmp(&all, &again, sizeof all) == 0);
      CHECK(memcmp(&all, &slow, sizeof all) == 0);
    }
    CHECK(all.reach > 0.0 && all.radius > 0.0 && all.height > 0.0 && all.cosine < 1.0);
  }
  fixture_close(&f);
}

/* The ratio chosen is one of those tried, and the instruction sets agree about it. */
static void test_ratio(void) {
  fixture f = fixture_open(1);
  fixture_scene(&f, CONIC_SCENE_TERRAIN, 2000);
  const conic_ellipse shape = {.major = {0.6, 0.8}, .ratio = 0.4};
  conic_octree_kernels kernels[2];
  int n_kernels = list_kernels(kernels), n_changed = 0;
  for (size_t begin = 0; begin + CONIC_FEW_LEAVES <= f.splats.count; begin += 7) {
    size_t end = begin + 2 + begin % (CONIC_FEW_LEAVES - 1);
    double ratio =
        conic_choose_ratio_baseline(&f.splats, begin, end, 1.5, tilted.position, tilted.u, tilted.v, &shape, 0.1);
    for (int k = 0; k < n_kernels; k++)
      CHECK(ratio ==
            kernels[k].choose_ratio(&f.splats, begin, end, 1.5, tilted.position, tilted.u, tilted.v, &shape, 0.1));
    CHECK(ratio >= 0.5 * 0.4 && ratio <= 1.5 * 0.4);
    n_changed += ratio != shape.ratio;
  }
  CHECK(n_changed > 20);
  fixture_close(&f);
}

/* Measured and taken apart, nodes are the same on every instruction set; what is put are the nodes' own numbers. */
static void test_choosing(void) {
  enum { N = 3000, N_PUT = 77 };
  static float pixels[3][N + CONIC_OCTREE_GROUP];
  static uint32_t ids[3][N_PUT], sources[N_PUT];
  fixture f = fixture_open(1);
  conic_splats put[3];
  conic_octree_kernels kernels[3] = {{.measure = conic_measure_baseline, .put = conic_put_baseline}};
  int n_kernels = 1 + list_kernels(kernels + 1);
  fixture_scene(&f, CONIC_SCENE_KNOT, N);
  octree_frame(&f, 200, 10, 30, 3.0);
  f.options.cull_back = 1;
  conic_octree *octree = octree_build(f.context, &f.splats, 0);
  CHECK_OK(conic_octree_decode_all(octree));
  conic_octree_view view;
  conic_octree_view_init(octree, &f.camera, &f.options, conic_octree_near(octree), &view);
  for (uint32_t k = 0; k < N_PUT; k++)
    sources[k] = k % 3 ? k * 31 : CONIC_NODE_BIT | (k * 11);
  for (int i = 0; i < n_kernels; i++) {
    unsigned fields = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES;
    kernels[i].measure(octree, &view, 0, octree->n_nodes, pixels[i]);
    CHECK(memcmp(pixels[0], pixels[i], octree->n_nodes * sizeof(float)) == 0);
    CHECK_OK(conic_splats_allocate(f.context, N_PUT + 5, fields, &put[i]));
    kernels[i].put(octree, sources, N_PUT, view.eye, &put[i], ids[i], 0);
  }
  int n_turned = 0, n_other = 0;
  for (int i = 0; i < n_kernels; i++)
    for (size_t k = 0; k < N_PUT; k++) {
      int is_node = sources[k] >> 31 != 0;
      const conic_drawn_node *from = &(is_node ? octree->drawn : octree->drawn_leaves)[sources[k] & ~CONIC_NODE_BIT];
      int is_turned = put[i].tangent_v[0][k] != from->tangent_v[0];
      n_turned += is_turned;
      n_other += ids[i][k] != from->id || put[i].opacity[k] != from->opacity || (is_turned && !is_node);
      for (int axis = 0; axis < 3; axis++)
        n_other += put[i].position[axis][k] != from->position[axis] || put[i].color[axis][k] != from->color[axis] ||
                   put[i].tangent_u[axis][k] != from->tangent_u[axis] ||
                   put[i].tangent_v[axis][k] != (is_turned ? -from->tangent_v[axis] : from->tangent_v[axis]) ||
                   put[i].tangent_v[axis][k] != put[0].tangent_v[axis][k];
    }
  CHECK(n_other == 0);
  CHECK(n_turned > 0 && n_turned < n_kernels * N_PUT / 3);
  for (int i = 0; i < n_kernels; i++)
    conic_splats_release(f.context, &put[i]);
  conic_octree_destroy(octree);
  fixture_close(&f);
}

int main(void) {
  test_choosing();
  test_cover();
  test_reach();
  test_ratio();
  return check_result();
}
