/* The machine beneath: how fast its cores read, write and copy memory, and compute in the widest vectors. */

#include "bench/bench.h"
#include "cli/shell.h"

/* Far beyond the last cache of any machine that we know; a thread's share is cut in slices. */
static const size_t buffer_bytes = (size_t)256 << 20;

enum { N_SLICES = 64, N_CHAINS = 12, N_ROUNDS = 5 };

typedef struct load {
  unsigned char *from, *to;
  size_t slice_bytes;
  long n_steps;
  const struct vector_loops *loops; /* of the machine */
  uint32_t *indices;
  float results[N_SLICES];
  uint64_t sums[N_SLICES];
} load;

/* --- memory --- */

typedef uint64_t words __attribute__((vector_size(64)));

static void read_slice(void *data, size_t i) {
  load *l = data;
  const unsigned char *from = l->from + i * l->slice_bytes;
  words sums[4] = {{0}};
  for (size_t at = 0; at + sizeof sums <= l->slice_bytes; at += sizeof sums)
    for (size_t k = 0; k < 4; k++) {
      words next;
      memcpy(&next, from + at + k * sizeof next, sizeof next);
      sums[k] += next;
    }
  for (size_t k = 0; k < 4; k++)
    for (size_t lane = 0; lane < 8; lane++)
      l->sums[i] += sums[k][lane];
}

static void write_slice(void *data, size_t i) {
  load *l = data;
  memset(l->to + i * l->slice_bytes, (int)(i & 0xff), l->slice_bytes);
}

static void copy_slice(void *data, size_t i) {
  load *l = data;
  memcpy(l->to + i * l->slice_bytes, l->from + i * l->slice_bytes, l->slice_bytes);
}

/* Lines to as many places by turns as a picture has tiles, in each from its beginning on. */
static void move_slice(void *data, size_t i) {
  enum { N_TILES = 256 };
  load *l = data;
  size_t n_lines = l->slice_bytes / 64, n_a_tile = n_lines / N_TILES;
  unsigned char *to = l->to + i * l->slice_bytes;
  words line = {i};
  for (size_t k = 0; k < n_lines; k++) {
    line += 1;
    memcpy(to + 64 * (k * 85 % N_TILES * n_a_tile + k / N_TILES), &line, sizeof line);
  }
}

/* --- vectors --- */

enum { GATHERED_FROM = 1 << 15 }; /* numbers */

typedef struct vector_loops {
  int lanes;
  void (*compute)(long n_steps, float factor, float term, float *result);
  void (*divide)(long n_steps, float factor, float term, float *result);
  void (*gather)(long n_steps, const float *from, const uint32_t *indices, float *result);
} vector_loops;

/* Chains of a product and a sum each, as many as hide their latency: the engine never fuses the two. */
#define DEFINE_COMPUTE(NAME_OF_COMPUTE, BYTES)                                                                         \
  typedef float NAME_OF_COMPUTE##_lanes __attribute__((vector_size(BYTES)));                                           \
  static void NAME_OF_COMPUTE(long n_steps, float factor, float term, float *result) {                                 \
    NAME_OF_COMPUTE##_lanes chains[N_CHAINS];                                                                          \
    NAME_OF_COMPUTE##_lanes factors = factor - (NAME_OF_COMPUTE##_lanes){0};                                           \
    NAME_OF_COMPUTE##_lanes terms = term - (NAME_OF_COMPUTE##_lanes){0};                                               \
    for (int k = 0; k < N_CHAINS; k++)                                                                                 \
      chains[k] = terms * (float)(k + 1);                                                                              \
    for (long i = 0; i < n_steps; i++)                                                                                 \
      for (int k = 0; k < N_CHAINS; k++)                                                                               \
        chains[k] = chains[k] * factors + terms;                                                                       \
    for (int k = 1; k < N_CHAINS; k++)                                                                                 \
      chains[0] += chains[k];                                                                                          \
    *result = chains[0][0];                                                                                            \
  }

/* Roots of quotients, which stay near 1. */
#define DEFINE_DIVIDE(NAME_OF_DIVIDE, BYTES)                                                                           \
  typedef float NAME_OF_DIVIDE##_lanes __attribute__((vector_size(BYTES)));                                            \
  static void NAME_OF_DIVIDE(long n_steps, float factor, float term, float *result) {                                  \
    NAME_OF_DIVIDE##_lanes chains[N_CHAINS];                                                                           \
    for (int k = 0; k < N_CHAINS; k++)                                                                                 \
      chains[k] = term + (float)(k + 1) - (NAME_OF_DIVIDE##_lanes){0};                                                 \
    for (long i = 0; i < n_steps; i++)                                                                                 \
      for (int k = 0; k < N_CHAINS; k++) {                                                                             \
        chains[k] = factor / chains[k];                                                                                \
        for (size_t lane = 0; lane < (size_t)(BYTES) / sizeof(float); lane++)                                          \
          chains[k][lane] = sqrtf(chains[k][lane]);                                                                    \
      }                                                                                                                \
    for (int k = 1; k < N_CHAINS; k++)                                                                                 \
      chains[0] += chains[k];                                                                                          \
    *result = chains[0][0];                                                                                            \
  }

/* Sums of what lies at the indices, of which there are GATHERED_FROM; compilers make it gathers where there are some.
 */
#define DEFINE_GATHER(NAME_OF_GATHER, LANES)                                                                           \
  static void NAME_OF_GATHER(long n_steps, const float *from, const uint32_t *indices, float *result) {                \
    float sums[4 * (LANES)] = {0.0f};                                                                                  \
    for (long i = 0; i < n_steps; i++) {                                                                               \
      const uint32_t *at = indices + (size_t)i * 4 * (LANES) % GATHERED_FROM;                                          \
      for (int k = 0; k < 4 * (LANES); k++)                                                                            \
        sums[k] += from[at[k]];                                                                                        \
    }                                                                                                                  \
    for (int k = 1; k < 4 * (LANES); k++)                                                                              \
      sums[0] += sums[k];                                                                                              \
    *result = sums[0];                                                                                                 \
  }

/* NOLINTBEGIN(bugprone-macro-parentheses): an attribute stands bare */
#define DEFINE_LOOPS(SET, TARGET, LANES)                                                                               \
  TARGET static void compute_##SET(long n_steps, float factor, float term, float *result);                             \
  TARGET static void divide_##SET(long n_steps, float factor, float term, float *result);                              \
  TARGET static void gather_##SET(long n_steps, const float *from, const uint32_t *indices, float *result);            \
  DEFINE_COMPUTE(compute_##SET, 4 * (LANES))                                                                           \
  DEFINE_DIVIDE(divide_##SET, 4 * (LANES))                                                                             \
  DEFINE_GATHER(gather_##SET, LANES)                                                                                   \
  static const vector_loops loops_##SET = {LANES, compute_##SET, divide_##SET, gather_##SET};
/* NOLINTEND(bugprone-macro-parentheses) */

DEFINE_LOOPS(plain, , 4)
#if defined(__x86_64__)
DEFINE_LOOPS(avx2, __attribute__((target("avx2"))), 8)
DEFINE_LOOPS(avx512, __attribute__((target("avx512f,avx512vl,prefer-vector-width=512"))), 16)
#endif

static const vector_loops *loops_of_machine(void) {
#if defined(__x86_64__)
  if (conic_isa_best() == CONIC_ISA_AVX512)
    return &loops_avx512;
  if (conic_isa_best() == CONIC_ISA_AVX2)
    return &loops_avx2;
#endif
  return &loops_plain;
}

static void divide_slice(void *data, size_t i) {
  load *l = data;
  l->loops->divide(l->n_steps / 16, 1.25f, 0.5f + (float)i, &l->results[i]);
}

static void gather_slice(void *data, size_t i) {
  load *l = data;
  l->loops->gather(l->n_steps / 16, (const float *)l->from, l->indices, &l->results[i]);
}

static void compute_slice(void *data, size_t i) {
  load *l = data;
  l->loops->compute(l->n_steps, 0.999f, 0.001f + (float)i, &l->results[i]);
}

/* --- measuring --- */

/* The best of a few rounds, after one that is not counted: what the machine can, not what it mostly does. */
static double least_seconds(cli_session *worker, conic_task task, load *l) {
  double least = 1e30;
  for (int i = 0; i <= N_ROUNDS; i++) {
    double start = cli_seconds(), start_cpu = cli_shell_cpu_seconds();
    conic_parallel_for(worker->context, N_SLICES, task, l);
    double seconds = cli_seconds() - start;
    double cpu = (cli_shell_cpu_seconds() - start_cpu) / (double)conic_context_threads(worker->context);
    seconds = cpu > 0.0 && cpu < seconds ? cpu : seconds; /* others take time from the threads */
    least = i > 0 && seconds < least ? seconds : least;
  }
  return least;
}

conic_status cli_bench_machine_measure(cli_session *worker, cli_bench_machine *machine) {
  load *l = calloc(1, sizeof *l);
  conic_status status = l ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (l) {
    l->from = conic_memory_allocate_zeroed(worker->context, buffer_bytes, 1);
    l->to = conic_memory_allocate_zeroed(worker->context, buffer_bytes, 1);
    l->indices = conic_memory_allocate(worker->context, GATHERED_FROM, sizeof *l->indices);
    l->slice_bytes = buffer_bytes / N_SLICES;
    l->n_steps = 200000;
  }
  if (l && l->from && l->to && l->indices) {
    l->loops = loops_of_machine();
    const double vectors = (double)N_SLICES * l->loops->lanes * (double)l->n_steps;
    memset(l->from, 1, buffer_bytes); /* pages that were never written are all the same one */
    for (uint32_t k = 0; k < GATHERED_FROM; k++)
      l->indices[k] = (k * 2654435761u) % GATHERED_FROM;
    machine->threads = conic_context_threads(worker->context);
    machine->read_bytes_per_s = (double)buffer_bytes / least_seconds(worker, CONIC_TASK(read_slice), l);
    machine->write_bytes_per_s = (double)buffer_bytes / least_seconds(worker, CONIC_TASK(write_slice), l);
    machine->copy_bytes_per_s = (double)buffer_bytes / least_seconds(worker, CONIC_TASK(copy_slice), l);
    machine->moved_bytes_per_s = (double)buffer_bytes / least_seconds(worker, CONIC_TASK(move_slice), l);
    machine->operations_per_s = 2.0 * N_CHAINS * vectors / least_seconds(worker, CONIC_TASK(compute_slice), l);
    machine->divisions_per_s = 2.0 / 16.0 * N_CHAINS * vectors / least_seconds(worker, CONIC_TASK(divide_slice), l);
    machine->gathered_per_s = 4.0 / 16.0 * vectors / least_seconds(worker, CONIC_TASK(gather_slice), l);
  } else
    status = CONIC_ERROR_MEMORY;
  conic_memory_release_these(worker->context, l ? l->from : NULL, l ? l->to : NULL, l ? l->indices : NULL);
  free(l);
  return status;
}
