/* The machine beneath: how fast its cores read, write and copy memory, and compute in the widest vectors. */

#include "bench/bench.h"

/* Far beyond the last cache of any machine that we know; a thread's share is cut in slices. */
static const size_t buffer_bytes = (size_t)256 << 20;

enum { N_SLICES = 64, N_CHAINS = 12, N_ROUNDS = 5 };

typedef struct load {
  unsigned char *from, *to;
  size_t slice_bytes;
  long n_steps;
  void (*compute)(long n_steps, float factor, float term, float *result);
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

/* --- vectors --- */

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

DEFINE_COMPUTE(compute_16, 16)
#if defined(__x86_64__)
__attribute__((target("avx2"))) static void compute_32(long n_steps, float factor, float term, float *result);
DEFINE_COMPUTE(compute_32, 32)
__attribute__((target("avx512f"))) static void compute_64(long n_steps, float factor, float term, float *result);
DEFINE_COMPUTE(compute_64, 64)
#endif

static int lanes_of_machine(load *l) {
  l->compute = compute_16;
#if defined(__x86_64__)
  if (conic_isa_best() == CONIC_ISA_AVX512) {
    l->compute = compute_64;
    return 16;
  }
  if (conic_isa_best() == CONIC_ISA_AVX2) {
    l->compute = compute_32;
    return 8;
  }
#endif
  return 4;
}

static void compute_slice(void *data, size_t i) {
  load *l = data;
  l->compute(l->n_steps, 0.999f, 0.001f + (float)i, &l->results[i]);
}

/* --- measuring --- */

/* The best of a few rounds, after one that is not counted: what the machine can, not what it mostly does. */
static double least_seconds(cli_session *worker, conic_task task, load *l) {
  double least = 1e30;
  for (int i = 0; i <= N_ROUNDS; i++) {
    double start = cli_seconds();
    conic_parallel_for(worker->context, N_SLICES, task, l);
    double seconds = cli_seconds() - start;
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
    l->slice_bytes = buffer_bytes / N_SLICES;
    l->n_steps = 200000;
  }
  if (l && l->from && l->to) {
    double lanes = lanes_of_machine(l);
    memset(l->from, 1, buffer_bytes); /* pages that were never written are all the same one */
    machine->threads = conic_context_threads(worker->context);
    machine->read_bytes_per_s = (double)buffer_bytes / least_seconds(worker, CONIC_TASK(read_slice), l);
    machine->write_bytes_per_s = (double)buffer_bytes / least_seconds(worker, CONIC_TASK(write_slice), l);
    machine->copy_bytes_per_s = (double)buffer_bytes / least_seconds(worker, CONIC_TASK(copy_slice), l);
    machine->operations_per_s =
        2.0 * N_CHAINS * N_SLICES * lanes * (double)l->n_steps / least_seconds(worker, CONIC_TASK(compute_slice), l);
  } else
    status = CONIC_ERROR_MEMORY;
  conic_memory_release(worker->context, l ? l->from : NULL);
  conic_memory_release(worker->context, l ? l->to : NULL);
  free(l);
  return status;
}
