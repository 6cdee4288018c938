/* What compares the loops' families with plain C, and times them: memory between guard bands, desks that have some,
 * slots that run on a desk. */
#pragma once

#include "bench/loops/cross_all.h"
#include "core/estimate/neighbour_loops.h"
#include "lod/octree/octree_loops.h"
#include "raster/loops/raster_loops.h"
#include "surface/loops/surface_loops.h"
#include "tests/support/fixture.h"

/* The tables of all families for one instruction set. */
typedef struct cross_tables {
  conic_isa isa;
  int n_timed; /* the least of so many times is taken */
  conic_raster_loops raster;
  conic_surface_loops surface;
  conic_octree_loops octree;
  conic_neighbour_loops neighbours;
} cross_tables;

/* One run: compares, or, with is_bench, compares a little and times. */
typedef struct cross {
  uint64_t seed;
  int is_bench;
  int n_tables;
  cross_tables tables[CONIC_N_ISAS]; /* of what this machine has, plain C first */
  int n_failures;                    /* nothing is timed once there are some */
} cross;

/* A family's slots; each returns how much failed. */
int cli_cross_splats(cross *c);
int cli_cross_triangles(cross *c);
int cli_cross_texture(cross *c);
int cli_cross_surface(cross *c);
int cli_cross_octree(cross *c);
int cli_cross_neighbours(cross *c);

enum { CROSS_GUARD = 256, CROSS_PATTERN = 0xa5, CROSS_MOST_ARENAS = 32 };

/* Memory between two guard bands. */
typedef struct cross_arena {
  const char *name;
  unsigned char *memory, *inside; /* of 64 bytes each */
  void *held;                     /* what free takes */
  size_t bytes;
  size_t compared; /* what of it has to be the same */
} cross_arena;

/* All that a family's slots read and write; the first member of a family's own desk. */
typedef struct cross_desk {
  int n_arenas;
  cross_arena arenas[CROSS_MOST_ARENAS];
} cross_desk;

typedef void cross_run(const cross_tables *tables, cross_desk *desk);

/* What runs a slot by one call; `d` is the desk there. */
/* NOLINTBEGIN(bugprone-macro-parentheses): a type and a statement, which stand bare */
#define CROSS_RUN(name, of_desk, call)                                                                                 \
  static void name(const cross_tables *tables, cross_desk *desk) {                                                     \
    of_desk *d = (of_desk *)(void *)desk;                                                                              \
    call;                                                                                                              \
  }
/* NOLINTEND(bugprone-macro-parentheses) */

/* A slot: its name and what comes before it in a line, what runs it, and what a time is divided by. */
typedef struct cross_slot {
  const char *name, *variant;
  cross_run *run;
  const char *unit;
  double n_units;
} cross_slot;

static inline void *cross_calloc(size_t bytes) {
  void *made = calloc(1, bytes);
  if (!made)
    exit(1);
  return made;
}

/* Zeroed, of the desk's from now on. */
static inline void *cross_room(cross_desk *desk, const char *name, size_t bytes) {
  cross_arena *a = &desk->arenas[desk->n_arenas++];
  size_t whole = conic_memory_rounded(bytes + (size_t)2 * CROSS_GUARD);
  *a = (cross_arena){.name = name, .held = cross_calloc(whole + 64), .bytes = bytes, .compared = bytes};
  a->memory = (unsigned char *)a->held + (64 - (uintptr_t)a->held % 64);
  a->inside = a->memory + CROSS_GUARD;
  memset(a->memory, CROSS_PATTERN, whole);
  memset(a->inside, 0, bytes);
  return a->inside;
}

/* Looks after the guard bands. */
static inline void cross_close(cross_desk *desk) {
  for (int i = 0; i < desk->n_arenas; i++) {
    const cross_arena *a = &desk->arenas[i];
    int n_written = 0;
    for (size_t k = 0; k < CROSS_GUARD; k++)
      n_written += (a->memory[k] != CROSS_PATTERN) + (a->inside[a->bytes + k] != CROSS_PATTERN);
    CHECK(n_written == 0);
    free(a->held);
  }
  free(desk);
}

/* The arenas first … last - 1: says where one differs first, and how. */
static inline void cross_compare(const cross_desk *a, const cross_desk *b, int first, int last) {
  for (int i = first; i < last; i++) {
    const unsigned char *of_a = a->arenas[i].inside, *of_b = b->arenas[i].inside;
    size_t n = a->arenas[i].compared, at = 0;
    CHECK(n == b->arenas[i].compared);
    if (n != b->arenas[i].compared || memcmp(of_a, of_b, n) == 0)
      continue;
    while (of_a[at] == of_b[at])
      at++;
    fprintf(stderr, "%s differ from byte %zu of %zu on: %02x and %02x\n", a->arenas[i].name, at, n, of_a[at], of_b[at]);
    check_failures++;
  }
}

static inline double cross_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Seconds of one run: the shortest of a few times a few, since every run does the same again. */
static inline double cross_time(cross_run *run, const cross_tables *tables, cross_desk *desk) {
  enum { RUNS = 4 };
  double least = 1e30;
  for (int i = 0; i < tables->n_timed; i++) {
    double begin = cross_seconds();
    for (int k = 0; k < RUNS; k++)
      run(tables, desk);
    double seconds = (cross_seconds() - begin) / RUNS;
    least = seconds < least ? seconds : least;
  }
  return least;
}

/* A line of times; `plain` is plain C's. */
static inline void cross_print(const cross_slot *slot, conic_isa isa, double ns, double plain) {
  printf("%-15s  %-15s  %-6s  %9.2f ns/%-9s  %6.2f x\n", slot->name, slot->variant ? slot->variant : "-",
         conic_isa_name(isa), ns, slot->unit, plain / ns);
}

/* Runs the slot on each table's desk, which are alike, and compares them with plain C's, the first; then times it. */
static inline void cross_try(cross *c, const cross_slot *slot, cross_desk *const *desks) {
  int failures = check_failures;
  double plain = 0.0;
  for (int i = 0; i < c->n_tables; i++) {
    slot->run(&c->tables[i], desks[i]);
    cross_compare(desks[0], desks[i], 0, desks[0]->n_arenas);
    if (check_failures == failures)
      continue;
    fprintf(stderr, "  that was %s, %s, by %s\n", slot->name, slot->variant ? slot->variant : "-",
            conic_isa_name(c->tables[i].isa));
    return;
  }
  for (int i = 0; i < c->n_tables && c->is_bench && !check_failures && !c->n_failures; i++) {
    double ns = 1e9 * cross_time(slot->run, &c->tables[i], desks[i]) / slot->n_units;
    plain = i == 0 ? ns : plain;
    cross_print(slot, c->tables[i].isa, ns, plain);
  }
}
