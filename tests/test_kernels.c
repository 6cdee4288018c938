/* Every slot of every kernel table against the plain C one, bit for bit: on friendly and on hostile splats, with guard
 * bands around what a slot may write. The seed is printed and may be given: test_kernels FOLDER SEED. */
#include "raster/tile_kernels.h"
#include "tests/fixture.h"

enum { N_SPLATS = 1501, GUARD = 256, EDGE = 32, PATTERN = 0xa5 };

/* What one table makes of the same splats. */
typedef struct projection {
  conic_chunk chunk;
  conic_projected projected;
} projection;

static float any_value(uint64_t *state, double scale, double share_of_specials) {
  static const float specials[] = {NAN,     INFINITY, -INFINITY, 0.0f,   -0.0f, 1e-42f,
                                   -1e-42f, 1e30f,    -1e30f,    1e-20f, 3e38f};
  if (fixture_random(state) < share_of_specials)
    return specials[(int)(fixture_random(state) * 11.0)];
  return (float)(scale * (fixture_random(state) - 0.5));
}

static void fill(fixture *f, uint64_t *state, double share_of_specials) {
  unsigned fields = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES;
  conic_splats_release(f->context, &f->splats);
  CHECK_OK(conic_splats_allocate(f->context, N_SPLATS, fields, &f->splats));
  for (size_t i = 0; i < N_SPLATS; i++) {
    f->splats.opacity[i] = any_value(state, 2.0, share_of_specials) + 0.5f;
    double size = pow(10.0, -4.0 * fixture_random(state)), thin = i % 7 ? 1.0 : 1e-5;
    for (int axis = 0; axis < 3; axis++) {
      float center = any_value(state, 3.0, share_of_specials);
      f->splats.position[axis][i] = axis == 2 ? center + 1.6f : center;
      f->splats.tangent_u[axis][i] = any_value(state, size, share_of_specials);
      f->splats.tangent_v[axis][i] = any_value(state, size * thin, share_of_specials);
      f->splats.color[axis][i] = any_value(state, 2.0, share_of_specials);
    }
    if (share_of_specials > 0.0 && i % 50 == 0) { /* frontal giants: the determinant of their variance overflows */
      for (int axis = 0; axis < 3; axis++)
        f->splats.tangent_u[axis][i] = f->splats.tangent_v[axis][i] = 0.0f;
      f->splats.tangent_u[0][i] = f->splats.tangent_v[1][i] = (float)pow(10.0, 4.0 + (double)(i % 9));
    }
  }
}

static projection project_with(const conic_tile_kernels *kernels, const conic_view *view, const conic_splats *splats) {
  projection p;
  memset(&p, 0, sizeof p);
  p.projected.n_chunks = 1;
  p.projected.chunk_size = splats->count;
  p.projected.footprints = calloc(splats->count, sizeof *p.projected.footprints);
  p.projected.boxes = calloc(splats->count, sizeof *p.projected.boxes);
  p.projected.surfaces = calloc(splats->count, sizeof *p.projected.surfaces);
  p.projected.rays = calloc(splats->count, sizeof *p.projected.rays);
  p.projected.chunks = &p.chunk;
  kernels->project(view, splats, 0, &p.projected);
  return p;
}

static void release(projection *p) {
  free(p->projected.footprints);
  free(p->projected.boxes);
  free(p->projected.surfaces);
  free(p->projected.rays);
}

static void compare_projections(const projection *a, const projection *b) {
  CHECK(memcmp(&a->chunk, &b->chunk, sizeof a->chunk) == 0);
  if (a->chunk.n_drawn != b->chunk.n_drawn || a->chunk.n_rays != b->chunk.n_rays)
    return;
  size_t n = a->chunk.n_drawn;
  CHECK(memcmp(a->projected.footprints, b->projected.footprints, n * sizeof(conic_footprint)) == 0);
  CHECK(memcmp(a->projected.boxes, b->projected.boxes, n * sizeof(conic_box)) == 0);
  CHECK(memcmp(a->projected.surfaces, b->projected.surfaces, n * sizeof(conic_surface)) == 0);
  CHECK(memcmp(a->projected.rays, b->projected.rays, a->chunk.n_rays * sizeof(conic_ray)) == 0);
}

/* One tile's planes between two guard bands, and the image it is resolved to. */
typedef struct canvas {
  conic_tile tile;
  char *memory;
  size_t bytes;
  conic_image image;
} canvas;

static canvas open_canvas(const fixture *f, const conic_view *view, const conic_projected *projected,
                          const uint32_t *references, size_t n_references, int x, int y) {
  canvas c;
  memset(&c, 0, sizeof c);
  c.bytes = conic_tile_bytes(EDGE) + 2 * GUARD;
  c.memory = malloc(c.bytes);
  memset(c.memory, PATTERN, c.bytes);
  c.tile.view = view;
  c.tile.projected = projected;
  c.tile.references = references;
  c.tile.n_references = n_references;
  c.tile.keeps_indices = 1;
  c.tile.x_begin = x;
  c.tile.y_begin = y;
  c.tile.x_end = x + EDGE < view->width ? x + EDGE : view->width;
  c.tile.y_end = y + EDGE < view->height ? y + EDGE : view->height;
  conic_tile_clear(&c.tile, EDGE, c.memory + GUARD);
  CHECK_OK(conic_image_allocate(f->context, view->width, view->height, ALL_PLANES, &c.image));
  return c;
}

static void close_canvas(const fixture *f, canvas *c) {
  for (size_t i = 0; i < GUARD; i++)
    CHECK((unsigned char)c->memory[i] == PATTERN && (unsigned char)c->memory[c->bytes - 1 - i] == PATTERN);
  conic_image_release(f->context, &c->image);
  free(c->memory);
}

static void compare_canvases(const canvas *a, const canvas *b) {
  CHECK(memcmp(a->memory, b->memory, a->bytes) == 0);
  CHECK(a->tile.n_fragments == b->tile.n_fragments && a->tile.n_covered == b->tile.n_covered);
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    CHECK(conic_image_hash(&a->image, (conic_plane)plane) == conic_image_hash(&b->image, (conic_plane)plane));
}

static conic_finish finish_of(const fixture *f) {
  conic_finish finish = {.options = &f->options, .light = {0.6f, 0.64f, 0.48f}, .exposure = 1.25f};
  for (int i = 0; i < 3; i++)
    finish.world_from_cam[i][i] = 1.0f;
  return finish;
}

/* Both ways through a tile: blending, and the nearest alone. */
static void run_tile(const conic_tile_kernels *kernels, const conic_finish *finish, canvas *blended, canvas *nearest) {
  kernels->visibility(&blended->tile);
  kernels->accumulate(&blended->tile);
  kernels->resolve(&blended->tile, finish, &blended->image);
  kernels->nearest(&nearest->tile);
  conic_tile_take_nearest(&nearest->tile);
  kernels->resolve(&nearest->tile, finish, &nearest->image);
}

static void compare_tiles(const fixture *f, const conic_view *view, const conic_projected *projected, size_t n_drawn,
                          const conic_tile_kernels *kernels) {
  static const int places[][2] = {
      {0, 0}, {32, 32}, {64, 64}, {0, 64}}; /* the last ones are cut by the picture's edge */
  conic_finish finish = finish_of(f);
  uint32_t *references = malloc((n_drawn + 1) * sizeof *references);
  for (int i = 0; i < 4; i++) {
    size_t n = 0;
    int x = places[i][0], y = places[i][1];
    for (size_t k = 0; k < n_drawn; k++) {
      const conic_box *box = &projected->boxes[k];
      if (box->x_begin < x + EDGE && box->x_end > x && box->y_begin < y + EDGE && box->y_end > y)
        references[n++] = (uint32_t)k;
    }
    canvas c[4];
    for (int k = 0; k < 4; k++)
      c[k] = open_canvas(f, view, projected, references, n, x, y);
    run_tile(&conic_tile_kernels_scalar, &finish, &c[0], &c[1]);
    run_tile(kernels, &finish, &c[2], &c[3]);
    compare_canvases(&c[0], &c[2]);
    compare_canvases(&c[1], &c[3]);
    for (int k = 0; k < 4; k++)
      close_canvas(f, &c[k]);
  }
  free(references);
}

static void compare_table(fixture *f, const conic_tile_kernels *kernels) {
  conic_view view;
  CHECK_OK(conic_view_init(f->context, &f->splats, &f->camera, &f->options, 1e-3, 0.01, &view));
  projection reference = project_with(&conic_tile_kernels_scalar, &view, &f->splats);
  projection other = project_with(kernels, &view, &f->splats);
  CHECK(reference.chunk.n_drawn > 100);
  compare_projections(&reference, &other);
  compare_tiles(f, &view, &reference.projected, reference.chunk.n_drawn, kernels);
  release(&reference);
  release(&other);
}

/* A setting of the options for each way through the kernels. */
static void choose(fixture *f, int setting) {
  conic_render_options_init(&f->options);
  f->options.method = (conic_method)(setting % CONIC_N_METHODS);
  f->options.kernel.type = (conic_kernel_type)(setting / CONIC_N_METHODS % 4);
  f->options.shading = (conic_shading)(setting % 2 ? CONIC_SHADE_PHONG : setting % 3);
  f->options.has_light = setting % 4 == 1;
  f->options.cull_back = setting % 5 == 2;
  f->options.prefilter = setting % 6 == 3 ? 0.0f : 1.0f;
  f->options.epsilon = setting % 7 == 4 ? 0.0 : -1.0;
}

int main(int argc, char **argv) {
  fixture f = fixture_open(1);
  uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 20260718, state = seed;
  printf("seed %llu\n", (unsigned long long)seed);
  fixture_camera(&f, 90, 86, 70.0); /* neither a multiple of a tile nor of a block */
  for (int isa = CONIC_ISA_SSE2; isa < CONIC_N_ISAS; isa++) {
    const conic_tile_kernels *kernels = conic_tile_kernels_of((conic_isa)isa);
    if (!kernels) {
      printf("%s: not here\n", conic_isa_name((conic_isa)isa));
      continue;
    }
    for (int setting = 0; setting < 24; setting++) {
      int failures = check_failures;
      choose(&f, setting);
      fill(&f, &state, setting % 3 == 0 ? 0.02 : 0.0);
      compare_table(&f, kernels);
      if (check_failures != failures)
        fprintf(stderr, "  that was %s, setting %d\n", kernels->name, setting);
    }
    printf("%s: compared\n", kernels->name);
  }
  fixture_close(&f);
  return check_result();
}
