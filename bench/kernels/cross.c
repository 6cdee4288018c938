/* Every slot of every kernel table against the plain C one, bit for bit: on friendly and on hostile input, with guard
 * bands around all that a slot may write. With --bench both are timed in the same place.
 *
 *   cross FOLDER [SEED]      compares; the seed is printed, and repeats a run
 *   cross FOLDER --bench     lists slot, method, kernel and instruction set with its time and its ratio to plain C
 *
 * A slot is a line of `slots`: what it is called, what runs it, what has to run before it. */
#include <time.h>

#include "bench/kernels/cross_desk.h"

typedef void run_slot(const conic_tile_kernels *kernels, desk *d);

static double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* --- the slots --- */

static void run_project(const conic_tile_kernels *kernels, desk *d) {
  d->chunk = (conic_chunk){0};
  kernels->project(&d->view, &d->f->splats, 0, d->f->splats.count, &d->projected, &d->chunk);
}

/* Lanes may scribble behind the last record: that is room for the next. */
static void check_projected(desk *d) {
  const size_t record_bytes[] = {sizeof(conic_footprint), sizeof(conic_box), sizeof(conic_projected_surface)};
  for (int i = 0; i < 3; i++)
    d->arenas[FOOTPRINTS + i].compared = d->chunk.n_drawn * record_bytes[i];
  d->arenas[RAYS].compared = d->chunk.n_rays * sizeof(conic_ray);
}

/* What a single pass asks of the records. */
static void run_project_for_nearest(const conic_tile_kernels *kernels, desk *d) {
  d->view.needs_nearness = d->view.needs_slope = 0;
  run_project(kernels, d);
  d->view.needs_nearness = d->view.needs_slope = 1;
}

static void run_keys(const conic_tile_kernels *kernels, desk *d) {
  kernels->keys(d->projected.boxes, d->chunk.n_drawn, 5, (d->view.width + 31) / 32, 0, d->tiles, d->keys, d->beyond);
}

static void run_keys_of_pixels(const conic_tile_kernels *kernels, desk *d) {
  kernels->keys(d->projected.boxes, d->chunk.n_drawn, 5, (d->view.width + 31) / 32, 1, d->tiles, d->keys, d->beyond);
}

/* Into bins of 32 × 32 pixels. */
static void count_tiles(desk *d) {
  d->bins.tile_bits = 5;
  d->bins.tile = 1 << d->bins.tile_bits;
  d->bins.by_pixels = 0;
  d->bins.n_tiles_x = (d->view.width + d->bins.tile - 1) / d->bins.tile;
  d->bins.n_tiles = (size_t)d->bins.n_tiles_x * (size_t)((d->view.height + d->bins.tile - 1) / d->bins.tile);
  CHECK(d->bins.n_tiles < MOST_TILES);
  d->sorter = (conic_sorter){.projected = d->projected,
                             .chunk = d->chunk,
                             .tile = d->tiles,
                             .word = d->keys,
                             .beyond = d->beyond,
                             .order = d->order,
                             .next_record = d->next_record,
                             .next_entry = d->next_entry};
  CHECK(conic_sorter_count(&d->bins, &conic_tile_kernels_scalar, &d->sorter, d->tile_begin) <=
        d->chunk.n_drawn * MOST_TILES + 1);
}

static void run_sort(const conic_tile_kernels *kernels, desk *d) {
  count_tiles(d);
  kernels->sort(&d->bins, &d->sorter, 0, d->entries, d->moved_footprints, d->moved_surfaces);
}

static void run_select(const conic_tile_kernels *kernels, desk *d) {
  uint32_t mask = UINT32_C(0x10000) << 1; /* the tile's second row */
  d->n_answered = kernels->select(d->references, d->band.n, mask, d->selected, d->selected_words);
}

static void check_selected(desk *d) {
  d->arenas[SELECTED].compared = d->arenas[SELECTED_WORDS].compared = d->n_answered * sizeof(uint32_t);
}

static void run_visibility(const conic_tile_kernels *kernels, desk *d) {
  kernels->visibility(&d->band);
}

/* What is kept of pixels that the splat does not cover, and past the last kept splat, may be anything. */
static void check_kept(desk *d) {
  memset(&d->band.kept[CONIC_NO_BLOCK], 0, sizeof *d->band.kept);
  for (int block = 0; block < d->band.n_blocks; block++) {
    conic_kept *kept = &d->band.kept[block];
    size_t n = d->band.n_kept[block], rest = CONIC_KEPT_SPLATS + 1 - n;
    for (size_t i = 0; i < n; i++)
      for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
        int is_covered = kept->fragments[i].seen_iz[l] != -1.0f;
        if (!is_covered)
          kept->fragments[i].q[l] = 0.0f;
        if (!is_covered || d->projected.footprints[kept->footprint[i]].s3 != 0.0f)
          kept->scale[i][l] = 1.0f;
      }
    memset(&kept->fragments[n], 0, rest * sizeof kept->fragments[0]);
    memset(&kept->scale[n], 0, rest * sizeof kept->scale[0]);
    memset(&kept->footprint[n], 0, rest * sizeof kept->footprint[0]);
  }
}

static void run_accumulate(const conic_tile_kernels *kernels, desk *d) {
  kernels->accumulate(&d->band);
}

static void run_nearest(const conic_tile_kernels *kernels, desk *d) {
  kernels->nearest(&d->band);
}

static void run_take_nearest(const conic_tile_kernels *kernels, desk *d) {
  kernels->take_nearest(&d->band);
}

/* Where the image has neither counts nor ids, a table may leave alone what only they need. */
static void check_sums(desk *d) {
  for (int block = 0; block < d->band.n_blocks && !d->band.keeps_indices; block++) {
    memset(d->band.sums[block].nearest, 0, sizeof d->band.sums[block].nearest);
    memset(d->band.sums[block].count, 0, sizeof d->band.sums[block].count);
  }
}

/* The fragments of pixels that nothing covers may be anything, and scales but those of special splats. */
static void check_nearest(desk *d) {
  conic_nearest *kept = d->band.nearest;
  for (int l = 0; l < CONIC_NEAREST_PIXELS; l++) {
    if (kept->iz[l] == 0.0f || d->projected.footprints[kept->footprint[l]].s3 > 0.0f)
      kept->scale[l] = 0.0f;
    if (kept->iz[l] == 0.0f) {
      kept->q[l] = 0.0f;
      kept->footprint[l] = 0;
    }
  }
}

static void run_resolve(const conic_tile_kernels *kernels, desk *d) {
  kernels->resolve(&d->band, &d->finish, &d->rays, &d->image);
}

/* Sums that blending seldom leaves: zeros of either sign, denormal, tiny and huge ones, in a third of the pixels. */
static void spoil_sums(const conic_tile_kernels *kernels, desk *d) {
  static const float values[] = {0.0f, -0.0f, 1e-42f, -1e-42f, 1e-20f, -1e-30f, 1e18f, -1e18f, 3e-39f};
  uint64_t state = (uint64_t)d->band.x * 1000 + (uint64_t)d->band.y;
  (void)kernels;
  for (int i = 0; i < d->band.n_blocks * CONIC_BLOCK_PIXELS; i++) {
    conic_block_sums *sums = &d->band.sums[i / CONIC_BLOCK_PIXELS];
    int l = i % CONIC_BLOCK_PIXELS;
    if (conic_block_is_empty(&d->band, i / CONIC_BLOCK_PIXELS) || !(sums->weight[l] > 0.0f) ||
        fixture_random(&state) > 0.33)
      continue;
    for (int axis = 0; axis < 3; axis++) {
      sums->color[axis][l] = values[(int)(fixture_random(&state) * 9.0)];
      sums->normal[axis][l] = values[(int)(fixture_random(&state) * 9.0)];
    }
    if (fixture_random(&state) < 0.3)
      sums->weight[l] = fixture_random(&state) < 0.5 ? CONIC_LEAST_WEIGHT : 1e15f;
  }
}

/* What a time is divided by. */
typedef enum unit { A_SPLAT, A_RECORD, AN_INDEX, A_FRAGMENT, A_PIXEL } unit;

typedef struct slot {
  const char *name;
  run_slot *run;
  run_slot *before[3];    /* by the plain C table */
  void (*check)(desk *d); /* after the run: empties what need not be the same; may be null */
  unit unit;              /* A_SPLAT: it makes the records; A_RECORD: it takes them; the others take a band */
  int has_methods;        /* differs by the method */
  int has_kernels;        /* differs by the splats' kernel */
  int is_not_timed;       /* a line for the comparison alone */
} slot;

static const slot slots[] = {
    {"project", run_project, {NULL}, check_projected, A_SPLAT, 1, 0, 0},
    {"project for nearest", run_project_for_nearest, {NULL}, check_projected, A_SPLAT, 1, 0, 1},
    {"keys", run_keys, {NULL}, NULL, A_RECORD, 0, 0, 0},
    {"keys of pixels", run_keys_of_pixels, {NULL}, NULL, A_RECORD, 0, 0, 0},
    {"sort", run_sort, {NULL}, NULL, A_RECORD, 0, 0, 0},
    {"select", run_select, {NULL}, check_selected, AN_INDEX, 0, 0, 0},
    {"visibility", run_visibility, {NULL}, check_kept, A_FRAGMENT, 1, 0, 0},
    {"accumulate", run_accumulate, {run_visibility}, check_sums, A_FRAGMENT, 1, 1, 0},
    {"nearest", run_nearest, {NULL}, check_nearest, A_FRAGMENT, 1, 0, 0},
    {"take nearest", run_take_nearest, {run_nearest}, check_sums, A_PIXEL, 0, 1, 0},
    {"resolve", run_resolve, {run_visibility, run_accumulate}, NULL, A_PIXEL, 0, 0, 0},
    {"resolve nearest", run_resolve, {run_nearest, run_take_nearest}, NULL, A_PIXEL, 0, 0, 1},
    {"resolve spoiled", run_resolve, {run_visibility, run_accumulate, spoil_sums}, NULL, A_PIXEL, 0, 0, 1},
};

enum { N_SLOTS = sizeof slots / sizeof slots[0] };

/* --- bands --- */

/* What a band's slots work on, into another desk of the same setting. */
static void copy_band(desk *to, const desk *from) {
  conic_band band = from->band;
  band.projected = &to->projected;
  band.view = &to->view;
  band.indices = to->list;
  band.words = to->words;
  band.kept = to->band.kept;
  band.nearest = to->band.nearest;
  band.entries = to->references;
  band.sums = to->band.sums;
  to->band = band;
  to->rays = from->rays;
  to->n_answered = from->n_answered;
  for (int i = LIST; i <= SUMS; i++)
    memcpy(to->arenas[i].inside, from->arenas[i].inside, from->arenas[i].bytes);
}

static void compare_bands(const desk *a, const desk *b) {
  size_t bytes = (size_t)a->band.n_blocks * sizeof a->band.n_kept[0];
  CHECK(a->band.n == b->band.n && a->band.n_fragments == b->band.n_fragments);
  CHECK(a->band.n_covered == b->band.n_covered);
  CHECK(memcmp(a->band.n_kept, b->band.n_kept, bytes) == 0 && memcmp(a->band.not_kept, b->band.not_kept, bytes) == 0);
  CHECK(a->n_answered == b->n_answered);
  compare_arenas(a, b, LIST, IMAGE);
}

static uint32_t between(int value, int last) {
  return value < 0 ? 0 : (uint32_t)(value < last ? value : last);
}

/* The word of a box in the tile from the band on. */
static uint32_t word_of(const conic_band *band, const conic_box *box) {
  int left = box->x_begin - band->x, right = box->x_end - 1 - band->x;
  int top = box->y_begin - band->y, bottom = box->y_end - 1 - band->y;
  int last_column = band->n_blocks - 1, last_row = band->n_rows - 1;
  return conic_word_of(between(left / CONIC_BLOCK_EDGE, last_column), between(right / CONIC_BLOCK_EDGE, last_column),
                       between(top / CONIC_BLOCK_EDGE, last_row), between(bottom / CONIC_BLOCK_EDGE, last_row));
}

/* The same in pixels. */
static uint32_t pixel_word_of(const conic_band *band, const conic_box *box) {
  int last_column = band->n_blocks * CONIC_BLOCK_EDGE - 1, last_row = band->n_rows * CONIC_BLOCK_EDGE - 1;
  return conic_pixel_word_of(between(box->x_begin - band->x, last_column),
                             between(box->x_end - 1 - band->x, last_column), between(box->y_begin - band->y, last_row),
                             between(box->y_end - 1 - band->y, last_row));
}

/* The band's list, as its tile would make it. */
static void list_splats(desk *d, int by_pixels) {
  conic_band *band = &d->band;
  band->n = 0;
  for (size_t k = 0; k < d->chunk.n_drawn && band->n < GREATEST_LIST; k++) {
    const conic_box *box = &d->projected.boxes[k];
    if (box->x_begin >= band->x + band->n_blocks * CONIC_BLOCK_EDGE || box->x_end <= band->x ||
        box->y_begin >= band->y + CONIC_BLOCK_EDGE || box->y_end <= band->y)
      continue;
    d->words[band->n] = word_of(band, box);
    d->references[band->n] = (conic_tile_entry){(uint32_t)k, by_pixels ? pixel_word_of(band, box) : d->words[band->n]};
    d->list[band->n++] = (uint32_t)k;
  }
  band->entries = d->references;
  band->n_entries = band->n;
}

static int is_single_pass(const slot *s) {
  return s->run == run_nearest || s->before[0] == run_nearest;
}

/* Where the slot begins on a band: what comes before it, done by the plain C table. */
static void prepare(const slot *s, desk *d, int x, int y) {
  int width = d->view.width - x < CONIC_GREATEST_TILE ? d->view.width - x : CONIC_GREATEST_TILE;
  d->band.x = x;
  d->band.y = y;
  d->band.n_blocks = (width + CONIC_BLOCK_EDGE - 1) / CONIC_BLOCK_EDGE;
  d->band.n_rows = (d->view.height - y + CONIC_BLOCK_EDGE - 1) / CONIC_BLOCK_EDGE;
  d->band.n_rows = d->band.n_rows < CONIC_BAND_BLOCKS ? d->band.n_rows : CONIC_BAND_BLOCKS;
  d->band.n_fragments = d->band.n_covered = 0;
  d->band.strip_rows = y / CONIC_BLOCK_EDGE % 2 ? 2 : 4;
  conic_tile_rays_init(&d->view, x, y / CONIC_GREATEST_TILE * CONIC_GREATEST_TILE, &d->rays);
  list_splats(d, is_single_pass(s));
  for (int i = 0; i < 3 && s->before[i]; i++)
    s->before[i](&conic_tile_kernels_scalar, d);
}

/* --- comparing --- */

static int n_long_lists, n_short_lists; /* of blocks: that do not fit into what is kept, and that do */

static void compare_band(const slot *at, const conic_tile_kernels *kernels, desk *reference, desk *other) {
  copy_band(other, reference);
  at->run(&conic_tile_kernels_scalar, reference);
  at->run(kernels, other);
  for (int i = 0; i < 2 && at->check; i++)
    at->check(i ? other : reference);
  compare_bands(reference, other);
  for (int block = 0; block < reference->band.n_blocks && at->run == run_visibility; block++) {
    n_long_lists += reference->band.n_kept[block] == CONIC_KEPT_SPLATS;
    n_short_lists += reference->band.n_kept[block] > 0 && reference->band.n_kept[block] < CONIC_KEPT_SPLATS;
  }
}

/* Every fifth band, which takes in some that the picture's edge cuts. */
static void compare_all_bands(const slot *at, const conic_tile_kernels *kernels, desk *reference, desk *other) {
  int n = 0;
  run_project(&conic_tile_kernels_scalar, reference);
  run_project(&conic_tile_kernels_scalar, other);
  CHECK(reference->chunk.n_drawn > 100);
  for (int y = 0; y < reference->view.height; y += CONIC_BLOCK_EDGE)
    for (int x = 0; x < reference->view.width; x += CONIC_GREATEST_TILE) {
      int failures = check_failures;
      if (n++ % 5)
        continue;
      prepare(at, reference, x, y);
      compare_band(at, kernels, reference, other);
      if (check_failures != failures)
        fprintf(stderr, "  that was the band at %d,%d\n", x, y);
    }
  compare_arenas(reference, other, FOOTPRINTS, reference->n_arenas);
}

static void compare_records(const slot *at, const conic_tile_kernels *kernels, desk *reference, desk *other) {
  at->run(&conic_tile_kernels_scalar, reference);
  at->run(kernels, other);
  at->check(reference);
  at->check(other);
  CHECK(memcmp(&reference->chunk, &other->chunk, sizeof other->chunk) == 0);
  compare_arenas(reference, other, FOOTPRINTS, LIST);
}

/* What records are turned into, of those that the plain C table made. */
static void compare_turned(const slot *at, const conic_tile_kernels *kernels, desk *reference, desk *other) {
  run_project(&conic_tile_kernels_scalar, reference);
  run_project(&conic_tile_kernels_scalar, other);
  at->run(&conic_tile_kernels_scalar, reference);
  at->run(kernels, other);
  compare_arenas(reference, other, FOOTPRINTS, IMAGE);
}

static void compare_slot(const fixture *f, const setting *s, const slot *at, const conic_tile_kernels *kernels) {
  desk *reference = open_desk(f, s), *other = open_desk(f, s);
  int failures = check_failures;
  if (at->unit == A_SPLAT)
    compare_records(at, kernels, reference, other);
  else if (at->unit == A_RECORD)
    compare_turned(at, kernels, reference, other);
  else
    compare_all_bands(at, kernels, reference, other);
  close_desk(reference);
  close_desk(other);
  if (check_failures != failures)
    fprintf(stderr, "  that was %s of %s, setting %d\n", at->name, kernels->name, s->number);
}

/* A sanitizer takes ten times as long, and looks for something else: every fifth way will do. */
#ifdef __SANITIZE_ADDRESS__
enum { STEP = 5 };
#else
enum { STEP = 1 };
#endif

static void compare_table(fixture *f, uint64_t *state, const conic_tile_kernels *kernels) {
  static const unsigned some_planes[] = {ALL_PLANES, 1u << CONIC_PLANE_RGBA,
                                         1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_WEIGHT,
                                         1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_ALBEDO};
  for (int i = 0; i < 4 * CONIC_N_METHODS * N_KERNELS; i += STEP) {
    int number = i / 2;
    setting s = {.number = number, .planes = some_planes[number % 2 ? number / 2 % 4 : 0]};
    s.share_of_specials = i % 2 ? 0.02 : 0.0;
    choose(f, number);
    fill(f, state, number % 4 == 3 ? 0.1 : 4.0, s.share_of_specials);
    for (int i_slot = 0; i_slot < N_SLOTS; i_slot++)
      compare_slot(f, &s, &slots[i_slot], kernels);
  }
}

static void compare_all(fixture *f, uint64_t seed) {
  uint64_t state = seed;
  printf("seed %llu\n", (unsigned long long)seed);
  fixture_camera(f, 90, 86, 70.0); /* no multiple of a block */
  for (int isa = CONIC_ISA_SSE2; isa < CONIC_N_ISAS; isa++) {
    const conic_tile_kernels *kernels = conic_tile_kernels_of((conic_isa)isa);
    if (kernels)
      compare_table(f, &state, kernels);
    printf("%s: %s\n", conic_isa_name((conic_isa)isa), kernels ? "compared" : "not here");
  }
  printf("%d blocks with all kept that fits, %d with less\n", n_long_lists, n_short_lists);
  CHECK(n_long_lists > 100 && n_short_lists > 100);
}

/* --- timing --- */

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Seconds of one run: the median of many. */
static double time_records(const slot *at, const conic_tile_kernels *kernels, desk *d) {
  double times[21];
  for (int i = 0; i < 21; i++) {
    double begin = seconds_now();
    at->run(kernels, d);
    times[i] = seconds_now() - begin;
  }
  qsort(times, 21, sizeof *times, compare_doubles);
  return times[10];
}

/* Seconds of one run on a band: the shortest of a few times a few, since every run does the same again. */
static double time_band(const slot *at, const conic_tile_kernels *kernels, desk *d) {
  enum { RUNS = 4, TIMES = 7 };
  double least = 1e30;
  for (int i = 0; i < TIMES; i++) {
    double begin = seconds_now();
    for (int k = 0; k < RUNS; k++)
      at->run(kernels, d);
    double seconds = (seconds_now() - begin) / RUNS;
    least = seconds < least ? seconds : least;
  }
  return least;
}

/* How many units a band's run has done. */
static double units_of(const slot *at, desk *d) {
  if (at->unit == A_PIXEL)
    return CONIC_BLOCK_PIXELS * (double)d->band.n_blocks;
  if (at->unit == AN_INDEX)
    return (double)d->band.n;
  d->band.n_fragments = 0;
  run_visibility(&conic_tile_kernels_scalar, d);
  return (double)d->band.n_fragments;
}

/* Nanoseconds a unit over the bands of a tile in the picture's middle. */
static double time_slot(const slot *at, const conic_tile_kernels *kernels, desk *d) {
  const int begin = 192, end = 256;
  double seconds = 0.0, units = 0.0;
  if (at->unit == A_SPLAT)
    return 1e9 * time_records(at, kernels, d) / (double)d->f->splats.count;
  run_project(&conic_tile_kernels_scalar, d);
  if (at->unit == A_RECORD)
    return 1e9 * time_records(at, kernels, d) / (double)d->chunk.n_drawn;
  for (int y = begin; y < end; y += CONIC_BLOCK_EDGE) {
    prepare(at, d, begin, y);
    seconds += time_band(at, kernels, d);
    units += units_of(at, d);
  }
  return 1e9 * seconds / units;
}

static void bench_slot(const fixture *f, const setting *s, const slot *at) {
  static const char *const unit_names[] = {"splat", "record", "index", "fragment", "pixel"};
  static const char *const kernel_names[] = {"gauss", "confetti", "hat", "box"};
  desk *d = open_desk(f, s);
  double plain = 0.0;
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    const conic_tile_kernels *kernels = conic_tile_kernels_of((conic_isa)isa);
    if (!kernels)
      continue;
    double ns = time_slot(at, kernels, d);
    plain = isa == CONIC_ISA_SCALAR ? ns : plain;
    printf("%-10s  %-6s  %-8s  %-6s  %9.2f ns/%-8s  %6.2f x\n", at->name,
           at->has_methods ? conic_method_name(f->options.method) : "-",
           at->has_kernels ? kernel_names[f->options.kernel.type] : "-", kernels->name, ns, unit_names[at->unit],
           plain / ns);
  }
  close_desk(d);
}

/* A tile of a surface whose splats are some six pixels across, from the front. */
static void bench_all(fixture *f) {
  setting s = {.planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_WEIGHT};
  fixture_camera(f, 512, 512, 700.0);
  f->camera.cam_from_world[2][3] = 3.2;
  fixture_scene(f, CONIC_SCENE_SPHERE, 40000);
  printf("%-10s  %-6s  %-8s  %-6s  %21s  %8s\n", "slot", "method", "kernel", "isa", "time", "scalar");
  for (int i = 0; i < N_SLOTS; i++)
    for (int number = 0; number < CONIC_N_METHODS * N_KERNELS && !slots[i].is_not_timed; number++) {
      int method = number % CONIC_N_METHODS, kernel = number / CONIC_N_METHODS;
      if ((method && !slots[i].has_methods) || (kernel && !slots[i].has_kernels))
        continue;
      conic_render_options_init(&f->options);
      f->options.method = (conic_method)method;
      f->options.kernel.type = (conic_kernel_type)kernel;
      bench_slot(f, &s, &slots[i]);
    }
}

int main(int argc, char **argv) {
  fixture f = fixture_open(1);
  if (argc > 2 && strcmp(argv[2], "--bench") == 0)
    bench_all(&f);
  else
    compare_all(&f, argc > 2 ? strtoull(argv[2], NULL, 10) : 20260718);
  fixture_close(&f);
  return check_result();
}
