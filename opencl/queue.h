/* A device's queue: its work, memory that grows, and how long each stage took. */
#pragma once

#include "opencl/opencl_device.h"

typedef enum conic_stage {
  CONIC_STAGE_SETUP,
  CONIC_STAGE_BIN,
  CONIC_STAGE_VISIBILITY,
  CONIC_STAGE_ACCUMULATE,
  CONIC_STAGE_RESOLVE,
  CONIC_N_STAGES
} conic_stage;

enum { CONIC_QUEUE_EVENTS = 256 };

typedef struct conic_queue {
  conic_context *context;
  cl_context cl;
  cl_command_queue queue;
  int is_cpu;   /* the device is this machine's processor */
  int n_events; /* of commands whose times are not yet counted */
  cl_event events[CONIC_QUEUE_EVENTS];
  conic_stage stages[CONIC_QUEUE_EVENTS];
  double ms[CONIC_N_STAGES];
  uint64_t n_bytes_written; /* copied to the device since it was opened */
} conic_queue;

/* Memory on the device; only ever grows. */
typedef struct conic_buffer {
  cl_mem memory;
  size_t bytes;
  void *own; /* where a CPU's is, which so has the pages that the context asks for */
} conic_buffer;

/* An entry's argument. */
typedef struct conic_argument {
  size_t bytes;
  const void *value;
} conic_argument;

#define CONIC_ARGUMENT(variable)                                                                                       \
  (conic_argument) {                                                                                                   \
    sizeof(variable), &(variable)                                                                                      \
  }

conic_status conic_queue_open(conic_context *context, cl_platform_id platform, cl_device_id id, conic_queue *queue);
void conic_queue_close(conic_queue *queue);

/* Room for so many bytes; what was in it is gone if it had to grow. Errors: MEMORY. */
conic_status conic_queue_room(conic_queue *queue, conic_buffer *buffer, size_t bytes);
/* Makes it the host's own memory, which a CPU's device reads or writes (`access`) where it is. */
conic_status conic_queue_wrap(conic_queue *queue, conic_buffer *buffer, cl_mem_flags access, const void *memory,
                              size_t bytes);
void conic_queue_release(conic_queue *queue, conic_buffer *buffer);

/* Both return when it is done. */
conic_status conic_queue_write(conic_queue *queue, const conic_buffer *buffer, const void *from, size_t bytes);
/* Likewise from byte `at` of the buffer on. */
conic_status conic_queue_write_at(conic_queue *queue, const conic_buffer *buffer, size_t at, const void *from,
                                  size_t bytes);
conic_status conic_queue_read(conic_queue *queue, const conic_buffer *buffer, size_t at, void *to, size_t bytes);
conic_status conic_queue_fill_zero(conic_queue *queue, const conic_buffer *buffer, size_t bytes);

/* Enqueues an entry over items[0] × items[1] work-items, in groups of group[0] × group[1]; the items are rounded up to
 * whole groups. */
conic_status conic_queue_run(conic_queue *queue, conic_stage stage, cl_kernel entry, const conic_argument *arguments,
                             int n_arguments, const size_t items[2], const size_t group[2]);

/* Waits for all, and adds the commands' times to ms. */
conic_status conic_queue_finish(conic_queue *queue);
