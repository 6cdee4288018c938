/* The splats' slots, from set-up to resolving, by every method and kernel, on friendly and on hostile input. */
#include "bench/loops/cross_desk.h"

/* --- the slots --- */

static void run_project(const cross_tables *tables, cross_desk *desk) {
  splat_desk *d = (splat_desk *)(void *)desk;
  d->chunk = (conic_chunk){0};
  tables->raster.project.project(&d->view, &d->f->splats, 0, d->f->splats.count, &d->projected, &d->chunk);
}

/* Lanes may scribble behind the last record: that is room for the next. */
static void check_projected(splat_desk *d) {
  const size_t record_bytes[] = {sizeof(conic_footprint), sizeof(conic_box), sizeof(conic_projected_surface)};
  for (int i = 0; i < 3; i++)
    d->memory.arenas[FOOTPRINTS + i].compared = d->chunk.n_drawn * record_bytes[i];
  d->memory.arenas[RAYS].compared = d->chunk.n_rays * sizeof(conic_ray);
}

/* What a single pass asks of the records. */
static void run_project_for_nearest(const cross_tables *tables, cross_desk *desk) {
  splat_desk *d = (splat_desk *)(void *)desk;
  d->view.needs_nearness = d->view.needs_slope = 0;
  run_project(tables, desk);
  d->view.needs_nearness = d->view.needs_slope = 1;
}

CROSS_RUN(run_keys, splat_desk,
          tables->raster.bins.keys(d->projected.boxes, d->chunk.n_drawn, 5, (d->view.width + 31) / 32, 0, d->tiles,
                                   d->keys, d->beyond))
CROSS_RUN(run_keys_of_pixels, splat_desk,
          tables->raster.bins.keys(d->projected.boxes, d->chunk.n_drawn, 5, (d->view.width + 31) / 32, 1, d->tiles,
                                   d->keys, d->beyond))

/* Into bins of 32 × 32 pixels. */
static void count_tiles(const conic_bin_loops *plain, splat_desk *d) {
  d->sorter = (conic_sorter){.projected = d->projected,
                             .chunk = d->chunk,
                             .tile = d->tiles,
                             .word = d->keys,
                             .beyond = d->beyond,
                             .order = d->order,
                             .next_record = d->next_record,
                             .next_entry = d->next_entry};
  CHECK(conic_sorter_count(&d->bins, plain, &d->sorter, d->tile_begin) <= d->n_entry_room);
}

static void run_sort(const cross_tables *tables, cross_desk *desk) {
  splat_desk *d = (splat_desk *)(void *)desk;
  conic_raster_loops plain;
  conic_raster_loops_init(&plain, CONIC_ISA_SCALAR);
  count_tiles(&plain.bins, d);
  tables->raster.bins.sort(&d->bins, &d->sorter, 0, d->entries, d->moved_footprints, d->moved_surfaces);
}

static void run_select(const cross_tables *tables, cross_desk *desk) {
  splat_desk *d = (splat_desk *)(void *)desk;
  uint32_t mask = UINT32_C(0x10000) << 1; /* the tile's second row */
  d->n_answered = tables->raster.bins.select(d->references, d->band.n, mask, d->selected, d->selected_words);
}

static void check_selected(splat_desk *d) {
  d->memory.arenas[SELECTED].compared = d->memory.arenas[SELECTED_WORDS].compared = d->n_answered * sizeof(uint32_t);
}

CROSS_RUN(run_visibility, splat_desk, tables->raster.passes.visibility(&d->band))

/* What is kept of pixels that the splat does not cover may be anything. */
static void check_kept(splat_desk *d) {
  for (int block = 0; block < d->band.n_blocks; block++) {
    conic_kept *kept = &d->band.kept[block];
    for (size_t i = 0; i < d->band.n_kept[block]; i++)
      for (int l = 0; l < CONIC_BLOCK_PIXELS; l++) {
        int is_covered = kept->fragments[i].seen_iz[l] != -1.0f;
        if (!is_covered)
          kept->fragments[i].q[l] = 0.0f;
        if (!is_covered || d->projected.footprints[kept->footprint[i]].s3 != 0.0f)
          kept->scale[i][l] = 1.0f;
      }
  }
}

CROSS_RUN(run_accumulate, splat_desk, tables->raster.passes.accumulate(&d->band))
CROSS_RUN(run_nearest, splat_desk, tables->raster.passes.nearest(&d->band))
CROSS_RUN(run_take_nearest, splat_desk, tables->raster.passes.take_nearest(&d->band))

/* Where the image has neither counts nor ids, a table may leave alone what only they need. */
static void check_sums(splat_desk *d) {
  for (int block = 0; block < d->band.n_blocks && !d->band.keeps_indices; block++) {
    memset(d->band.sums[block].nearest, 0, sizeof d->band.sums[block].nearest);
    memset(d->band.sums[block].count, 0, sizeof d->band.sums[block].count);
  }
}

/* The fragments of pixels that nothing covers may be anything, and scales but those of special splats. */
static void check_nearest(splat_desk *d) {
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

CROSS_RUN(run_resolve, splat_desk, tables->raster.resolve.resolve(&d->band, &d->finish, &d->rays, &d->image))

/* Sums that blending seldom leaves: zeros of either sign, denormal, tiny and huge ones, in a third of the pixels. */
static void spoil_sums(const cross_tables *tables, cross_desk *desk) {
  splat_desk *d = (splat_desk *)(void *)desk;
  static const float values[] = {0.0f, -0.0f, 1e-42f, -1e-42f, 1e-20f, -1e-30f, 1e18f, -1e18f, 3e-39f};
  uint64_t state = (uint64_t)d->band.x * 1000 + (uint64_t)d->band.y;
  (void)tables;
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
  cross_run *run;
  cross_run *before[3];         /* by the plain C table */
  void (*check)(splat_desk *d); /* after the run: empties what need not be the same; may be null */
  unit unit;                    /* A_SPLAT: it makes the records; A_RECORD: it takes them; the others take a band */
  int has_methods;              /* differs by the method */
  int has_kernels;              /* differs by the splats' kernel */
  int is_not_timed;             /* a line for the comparison alone */
  int goes_on; /* the comparison begins where the slot above ended, which is what `before` would make */
} slot;

static const slot slots[] = {
    {"project", run_project, {NULL}, check_projected, A_SPLAT, 1, 0, 0, 0},
    {"project for nearest", run_project_for_nearest, {NULL}, check_projected, A_SPLAT, 1, 0, 1, 0},
    {"keys", run_keys, {NULL}, NULL, A_RECORD, 0, 0, 0, 0},
    {"keys of pixels", run_keys_of_pixels, {NULL}, NULL, A_RECORD, 0, 0, 0, 0},
    {"sort", run_sort, {NULL}, NULL, A_RECORD, 0, 0, 0, 0},
    {"select", run_select, {NULL}, check_selected, AN_INDEX, 0, 0, 0, 0},
    {"visibility", run_visibility, {NULL}, check_kept, A_FRAGMENT, 1, 0, 0, 0},
    {"accumulate", run_accumulate, {run_visibility}, check_sums, A_FRAGMENT, 1, 1, 0, 1},
    {"nearest", run_nearest, {NULL}, check_nearest, A_FRAGMENT, 1, 0, 0, 0},
    {"take nearest", run_take_nearest, {run_nearest}, check_sums, A_PIXEL, 0, 1, 0, 1},
    {"resolve nearest", run_resolve, {run_nearest, run_take_nearest}, NULL, A_PIXEL, 0, 0, 1, 1},
    {"resolve", run_resolve, {run_visibility, run_accumulate}, NULL, A_PIXEL, 0, 0, 0, 0},
    {"resolve spoiled", run_resolve, {run_visibility, run_accumulate, spoil_sums}, NULL, A_PIXEL, 0, 0, 1, 0},
};

enum { N_SLOTS = sizeof slots / sizeof slots[0] };

/* Where the tile is that is timed. */
enum { TIMED_BEGIN = 192, TIMED_END = 256 };

/* --- bands --- */

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
static void list_splats(splat_desk *d, int by_pixels) {
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
static void prepare(const slot *s, const cross_tables *plain, splat_desk *d, int x, int y) {
  int width = d->view.width - x < CONIC_GREATEST_TILE ? d->view.width - x : CONIC_GREATEST_TILE;
  d->band.x = x;
  d->band.y = y;
  d->band.n_blocks = (width + CONIC_BLOCK_EDGE - 1) / CONIC_BLOCK_EDGE;
  d->band.n_rows = (d->view.height - y + CONIC_BLOCK_EDGE - 1) / CONIC_BLOCK_EDGE;
  d->band.n_rows = d->band.n_rows < CONIC_BAND_BLOCKS ? d->band.n_rows : CONIC_BAND_BLOCKS;
  d->band.n_fragments = d->band.n_covered = 0;
  memset(d->band.sums, CROSS_PATTERN, CONIC_BAND_BLOCKS * sizeof *d->band.sums);
  d->band.strip_rows = y / CONIC_BLOCK_EDGE % 2 ? 2 : 4;
  conic_tile_rays_init(&d->view, x, y / CONIC_GREATEST_TILE * CONIC_GREATEST_TILE, &d->rays);
  d->band.rays = &d->rays;
  list_splats(d, is_single_pass(s));
  for (int i = 0; i < 3 && s->before[i]; i++)
    s->before[i](plain, &d->memory);
}

static int takes_kept(const slot *s) {
  return s->run == run_visibility || s->run == run_accumulate;
}

static void copy_arenas(splat_desk *to, const splat_desk *from, int first, int last) {
  for (int i = first; i <= last; i++)
    memcpy(to->memory.arenas[i].inside, from->memory.arenas[i].inside, from->memory.arenas[i].bytes);
}

static void copy_kept(splat_desk *to, const splat_desk *from) {
  for (int block = 0; block < from->band.n_blocks; block++) {
    const conic_kept *kept = &from->band.kept[block];
    conic_kept *copy = &to->band.kept[block];
    size_t n = from->band.n_kept[block];
    memcpy(copy->threshold, kept->threshold, sizeof kept->threshold);
    memcpy(copy->footprint, kept->footprint, n * sizeof *kept->footprint);
    memcpy(copy->fragments, kept->fragments, n * sizeof *kept->fragments);
    memcpy(copy->scale, kept->scale, n * sizeof *kept->scale);
  }
}

/* What a band's slots work on, into another desk of the same setting. */
static void copy_band(const slot *s, splat_desk *to, const splat_desk *from) {
  conic_band band = from->band;
  band.projected = &to->projected;
  band.view = &to->view;
  band.rays = &to->rays;
  band.indices = to->list;
  band.words = to->words;
  band.kept = to->band.kept;
  band.nearest = to->band.nearest;
  band.entries = to->references;
  band.sums = to->band.sums;
  to->band = band;
  to->rays = from->rays;
  to->n_answered = from->n_answered;
  copy_arenas(to, from, LIST, SELECTED_WORDS);
  copy_arenas(to, from, SUMS, SUMS);
  if (is_single_pass(s))
    copy_arenas(to, from, NEAREST, NEAREST);
  if (takes_kept(s))
    copy_kept(to, from);
}

/* What a pixel shows of a splat; of what is hidden there, a table may leave what it has not looked at. */
static int shows_the_same(const conic_kept *a, const conic_kept *b, size_t i) {
  if (memcmp(a->fragments[i].seen_iz, b->fragments[i].seen_iz, sizeof a->fragments[i].seen_iz) != 0)
    return 0;
  for (size_t at = 0; at < CONIC_BLOCK_PIXELS; at++)
    if (a->fragments[i].seen_iz[at] >= a->threshold[at] &&
        memcmp(&a->fragments[i].q[at], &b->fragments[i].q[at], sizeof(float)) != 0)
      return 0;
  return 1;
}

/* Past the last kept splat there may be anything. */
static void compare_kept(const splat_desk *a, const splat_desk *b) {
  for (int block = 0; block < a->band.n_blocks; block++) {
    const conic_kept *of_a = &a->band.kept[block], *of_b = &b->band.kept[block];
    size_t n = a->band.n_kept[block];
    CHECK(memcmp(of_a->threshold, of_b->threshold, sizeof of_a->threshold) == 0);
    CHECK(memcmp(of_a->footprint, of_b->footprint, n * sizeof *of_a->footprint) == 0);
    for (size_t i = 0; i < n; i++)
      CHECK(shows_the_same(of_a, of_b, i));
    CHECK(memcmp(of_a->scale, of_b->scale, n * sizeof *of_a->scale) == 0);
  }
}

static void compare_bands(const slot *s, const splat_desk *a, const splat_desk *b) {
  size_t bytes = (size_t)a->band.n_blocks * sizeof a->band.n_kept[0];
  int failures = check_failures;
  CHECK(a->band.n == b->band.n && a->band.n_fragments == b->band.n_fragments);
  CHECK(a->band.n_covered == b->band.n_covered);
  CHECK(memcmp(a->band.n_kept, b->band.n_kept, bytes) == 0 && memcmp(a->band.not_kept, b->band.not_kept, bytes) == 0);
  CHECK(a->n_answered == b->n_answered);
  cross_compare(&a->memory, &b->memory, LIST, KEPT);
  cross_compare(&a->memory, &b->memory, SUMS, TILES);
  if (is_single_pass(s))
    cross_compare(&a->memory, &b->memory, NEAREST, SUMS);
  if (takes_kept(s) && check_failures == failures)
    compare_kept(a, b);
}

/* --- comparing --- */

static int n_long_lists, n_short_lists; /* of blocks: that do not fit into what is kept, and that do */

static void count_lists(const conic_band *band) {
  for (int block = 0; block < band->n_blocks; block++) {
    n_long_lists += band->n_kept[block] == CONIC_KEPT_SPLATS;
    n_short_lists += band->n_kept[block] > 0 && band->n_kept[block] < CONIC_KEPT_SPLATS;
  }
}

static void compare_band(const cross *c, const slot *at, splat_desk **desks, splat_desk *next, int x, int y) {
  int failures = check_failures;
  for (int i = 1; i < c->n_tables; i++)
    copy_band(at, desks[i], desks[0]);
  for (int i = 0; i < c->n_tables; i++) {
    at->run(&c->tables[i], &desks[i]->memory);
    if (i == 0 && next)
      copy_band(at, next, desks[0]);
    if (at->check)
      at->check(desks[i]);
    compare_bands(at, desks[0], desks[i]);
  }
  if (at->run == run_visibility)
    count_lists(&desks[0]->band);
  if (check_failures != failures)
    fprintf(stderr, "  that was %s on the band at %d,%d\n", at->name, x, y);
}

/* The slot, and what goes on from it: `next` holds what plain C has left. */
static void compare_from(const cross *c, const slot *at, splat_desk **desks, splat_desk *next, int x, int y) {
  const slot *end = slots + N_SLOTS;
  prepare(at, &c->tables[0], desks[0], x, y);
  compare_band(c, at, desks, next, x, y);
  for (at++; next && at != end && at->goes_on; at++) {
    copy_band(at - 1, desks[0], next);
    compare_band(c, at, desks, next, x, y);
  }
}

/* The bands of the tile that is timed, or every fifth, which takes in some that the picture's edge cuts. */
static void compare_all_bands(const cross *c, const slot *at, splat_desk **desks) {
  const int height = desks[0]->view.height, width = desks[0]->view.width;
  int n = 0;
  CHECK(desks[0]->chunk.n_drawn > 100);
  for (int y = c->is_bench ? TIMED_BEGIN : 0; y < (c->is_bench ? TIMED_END : height); y += CONIC_BLOCK_EDGE)
    for (int x = c->is_bench ? TIMED_BEGIN : 0; x < (c->is_bench ? TIMED_END : width); x += CONIC_GREATEST_TILE)
      if (c->is_bench || n++ % 5 == 0)
        compare_from(c, at, desks, c->is_bench ? NULL : desks[c->n_tables], x, y);
}

static void clear_arenas(splat_desk *d, int first, int last) {
  for (int i = first; i < last; i++) {
    memset(d->memory.arenas[i].inside, 0, d->memory.arenas[i].bytes);
    d->memory.arenas[i].compared = d->memory.arenas[i].bytes;
  }
}

static void compare_records(const cross *c, const slot *at, splat_desk **desks) {
  for (int i = 0; i < c->n_tables; i++) {
    clear_arenas(desks[i], FOOTPRINTS, LIST);
    at->run(&c->tables[i], &desks[i]->memory);
    at->check(desks[i]);
    CHECK(memcmp(&desks[0]->chunk, &desks[i]->chunk, sizeof desks[0]->chunk) == 0);
    cross_compare(&desks[0]->memory, &desks[i]->memory, FOOTPRINTS, LIST);
  }
}

/* Plain C makes the records; each instruction set turns them into keys, entries and an order. */
static void compare_turned(const cross *c, const slot *at, splat_desk **desks) {
  for (int i = 0; i < c->n_tables; i++) {
    clear_arenas(desks[i], TILES, IMAGE);
    at->run(&c->tables[i], &desks[i]->memory);
    cross_compare(&desks[0]->memory, &desks[i]->memory, TILES, IMAGE);
  }
}

static void compare_slot(const cross *c, int number, const slot *at, splat_desk **desks) {
  int failures = check_failures;
  if (at->unit == A_SPLAT)
    compare_records(c, at, desks);
  else {
    clear_arenas(desks[0], FOOTPRINTS, LIST);
    run_project(&c->tables[0], &desks[0]->memory);
    for (int i = 0; i < c->n_tables; i++) {
      clear_arenas(desks[i], IMAGE, desks[i]->memory.n_arenas);
      desks[i]->chunk = desks[0]->chunk;
      if (i > 0)
        copy_arenas(desks[i], desks[0], FOOTPRINTS, RAYS);
      for (int k = FOOTPRINTS; k < LIST; k++)
        desks[i]->memory.arenas[k].compared = desks[i]->memory.arenas[k].bytes;
    }
    (at->unit == A_RECORD ? compare_turned : compare_all_bands)(c, at, desks);
    for (int i = 1; i < c->n_tables; i++) {
      cross_compare(&desks[0]->memory, &desks[i]->memory, FOOTPRINTS, LIST);
      cross_compare(&desks[0]->memory, &desks[i]->memory, IMAGE, desks[0]->memory.n_arenas);
    }
  }
  if (check_failures != failures)
    fprintf(stderr, "  that was %s, setting %d\n", at->name, number);
}

/* A sanitizer takes ten times as long, and looks for something else: every fifth way will do. */
#ifdef __SANITIZE_ADDRESS__
enum { STEP = 5 };
#else
enum { STEP = 1 };
#endif

/* One a table, and one more. */
static void open_desks(const cross *c, const fixture *f, unsigned planes, splat_desk **desks) {
  for (int i = 0; i <= c->n_tables; i++)
    desks[i] = open_desk(f, planes);
}

static void close_desks(const cross *c, splat_desk **desks) {
  for (int i = 0; i <= c->n_tables; i++)
    cross_close(&desks[i]->memory);
}

static void compare_all(const cross *c, fixture *f) {
  static const unsigned some_planes[] = {ALL_PLANES, 1u << CONIC_PLANE_RGBA,
                                         1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_WEIGHT,
                                         1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_ALBEDO};
  splat_desk *desks[CONIC_N_ISAS + 1];
  uint64_t state = c->seed;
  fixture_camera(f, 58, 54, 45.0); /* no multiple of a block */
  for (int i = 0; i < 4 * CONIC_N_METHODS * CONIC_N_KERNELS; i += STEP) {
    int number = i / 2;
    choose(f, number);
    fill(f, &state, number % 4 == 3 ? 0.1 : 4.0, i % 2 ? 0.02 : 0.0);
    open_desks(c, f, some_planes[number % 2 ? number / 2 % 4 : 0], desks);
    for (int i_slot = 0; i_slot < N_SLOTS; i_slot++)
      if (!slots[i_slot].goes_on)
        compare_slot(c, number, &slots[i_slot], desks);
    close_desks(c, desks);
  }
  printf("%d blocks with all kept that fits, %d with less\n", n_long_lists, n_short_lists);
  CHECK(n_long_lists > 100 / STEP && n_short_lists > 100 / STEP);
}

/* --- timing --- */

/* How many units a band's run has done. */
static double units_of(const slot *at, const cross_tables *plain, splat_desk *d) {
  if (at->unit == A_PIXEL)
    return CONIC_BLOCK_PIXELS * (double)d->band.n_blocks;
  if (at->unit == AN_INDEX)
    return (double)d->band.n;
  d->band.n_fragments = 0;
  run_visibility(plain, &d->memory);
  return (double)d->band.n_fragments;
}

/* Nanoseconds a unit; of bands, over those of a tile in the picture's middle. */
static double time_slot(const slot *at, const cross_tables *plain, const cross_tables *tables, splat_desk *d) {
  double seconds = 0.0, units = 0.0;
  if (at->unit == A_SPLAT)
    return 1e9 * cross_time(at->run, tables, &d->memory) / (double)d->f->splats.count;
  run_project(plain, &d->memory);
  if (at->unit == A_RECORD)
    return 1e9 * cross_time(at->run, tables, &d->memory) / (double)d->chunk.n_drawn;
  for (int y = TIMED_BEGIN; y < TIMED_END; y += CONIC_BLOCK_EDGE) {
    prepare(at, plain, d, TIMED_BEGIN, y);
    seconds += cross_time(at->run, tables, &d->memory);
    units += units_of(at, plain, d);
  }
  return 1e9 * seconds / units;
}

static void bench_slot(cross *c, const fixture *f, const slot *at) {
  static const char *const unit_names[] = {"splat", "record", "index", "fragment", "pixel"};
  splat_desk *desks[CONIC_N_ISAS + 1];
  char variant[32];
  double plain = 0.0;
  snprintf(variant, sizeof variant, "%s %s", at->has_methods ? conic_method_name(f->options.method) : "-",
           at->has_kernels ? conic_kernel_type_name(f->options.kernel.type) : "-");
  const cross_slot line = {.name = at->name, .variant = variant, .unit = unit_names[at->unit]};
  open_desks(c, f, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_NORMAL | 1u << CONIC_PLANE_WEIGHT, desks);
  compare_slot(c, 0, at, desks);
  for (int i = 0; i < c->n_tables && !check_failures && !c->n_failures; i++) {
    double ns = time_slot(at, &c->tables[0], &c->tables[i], desks[0]);
    plain = i == 0 ? ns : plain;
    cross_print(&line, c->tables[i].isa, ns, plain);
  }
  close_desks(c, desks);
}

/* A tile of a surface whose splats are some six pixels across, from the front. */
static void bench_all(cross *c, fixture *f) {
  fixture_camera(f, 512, 512, 700.0);
  f->camera.cam_from_world[2][3] = 3.2;
  fixture_scene(f, CONIC_SCENE_SPHERE, 40000);
  for (int i = 0; i < N_SLOTS; i++)
    for (int number = 0; number < CONIC_N_METHODS * CONIC_N_KERNELS && !slots[i].is_not_timed; number++) {
      int method = number % CONIC_N_METHODS, kernel = number / CONIC_N_METHODS;
      if ((method && !slots[i].has_methods) || (kernel && !slots[i].has_kernels))
        continue;
      conic_render_options_init(&f->options);
      f->options.method = (conic_method)method;
      f->options.kernel.type = (conic_kernel_type)kernel;
      bench_slot(c, f, &slots[i]);
    }
}

int cli_cross_splats(cross *c) {
  fixture f = fixture_open(1);
  if (c->is_bench)
    bench_all(c, &f);
  else
    compare_all(c, &f);
  fixture_close(&f);
  return check_failures;
}
