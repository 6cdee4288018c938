#include "opencl/queue.h"

#include "core/base/base.h"

conic_status conic_queue_open(conic_context *context, cl_platform_id platform, cl_device_id id, conic_queue *queue) {
  const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM, (cl_context_properties)platform, 0};
  cl_int answer;
  memset(queue, 0, sizeof *queue);
  cl_device_type type = 0;
  queue->context = context;
  clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof type, &type, NULL);
  queue->is_cpu = (type & CL_DEVICE_TYPE_CPU) != 0;
  queue->cl = clCreateContext(properties, 1, &id, NULL, NULL, &answer);
  conic_status status = conic_opencl_check(context, answer, "clCreateContext");
  if (status != CONIC_OK)
    return status;
  queue->queue = clCreateCommandQueue(queue->cl, id, CL_QUEUE_PROFILING_ENABLE, &answer);
  return conic_opencl_check(context, answer, "clCreateCommandQueue");
}

void conic_queue_close(conic_queue *queue) {
  for (int i = 0; i < queue->n_events; i++)
    clReleaseEvent(queue->events[i]);
  if (queue->queue)
    clReleaseCommandQueue(queue->queue);
  if (queue->cl)
    clReleaseContext(queue->cl);
  memset(queue, 0, sizeof *queue);
}

conic_status conic_queue_room(conic_queue *queue, conic_buffer *buffer, size_t bytes) {
  cl_int answer;
  bytes = bytes ? bytes : 1;
  if (buffer->memory && bytes <= buffer->bytes)
    return CONIC_OK;
  conic_queue_release(queue, buffer);
  if (queue->is_cpu) {
    buffer->own = conic_memory_allocate(queue->context, bytes, 1);
    if (!buffer->own)
      return CONIC_ERROR_MEMORY;
    conic_memory_prefer_large_pages(queue->context, buffer->own, bytes);
  }
  buffer->memory = clCreateBuffer(queue->cl, CL_MEM_READ_WRITE | (buffer->own ? CL_MEM_USE_HOST_PTR : 0), bytes,
                                  buffer->own, &answer);
  buffer->bytes = answer == CL_SUCCESS ? bytes : 0;
  return conic_opencl_check(queue->context, answer, "clCreateBuffer");
}

conic_status conic_queue_wrap(conic_queue *queue, conic_buffer *buffer, cl_mem_flags access, const void *memory,
                              size_t bytes) {
  cl_int answer;
  conic_queue_release(queue, buffer);
  buffer->memory = clCreateBuffer(queue->cl, access | CL_MEM_USE_HOST_PTR, bytes, (void *)memory, &answer);
  return conic_opencl_check(queue->context, answer, "clCreateBuffer");
}

void conic_queue_release(conic_queue *queue, conic_buffer *buffer) {
  if (buffer->own) /* it is not OpenCL that frees it when all is done */
    clFinish(queue->queue);
  if (buffer->memory)
    clReleaseMemObject(buffer->memory);
  conic_memory_release(queue->context, buffer->own);
  *buffer = (conic_buffer){NULL, 0, NULL};
}

conic_status conic_queue_write_at(conic_queue *queue, const conic_buffer *buffer, size_t at, const void *from,
                                  size_t bytes) {
  if (bytes == 0)
    return CONIC_OK;
  queue->n_bytes_written += bytes;
  cl_int answer = clEnqueueWriteBuffer(queue->queue, buffer->memory, CL_TRUE, at, bytes, from, 0, NULL, NULL);
  return conic_opencl_check(queue->context, answer, "clEnqueueWriteBuffer");
}

conic_status conic_queue_write(conic_queue *queue, const conic_buffer *buffer, const void *from, size_t bytes) {
  return conic_queue_write_at(queue, buffer, 0, from, bytes);
}

conic_status conic_queue_read(conic_queue *queue, const conic_buffer *buffer, size_t at, void *to, size_t bytes) {
  if (bytes == 0)
    return CONIC_OK;
  cl_int answer = clEnqueueReadBuffer(queue->queue, buffer->memory, CL_TRUE, at, bytes, to, 0, NULL, NULL);
  return conic_opencl_check(queue->context, answer, "clEnqueueReadBuffer");
}

conic_status conic_queue_fill_zero(conic_queue *queue, const conic_buffer *buffer, size_t bytes) {
  const cl_uint zero = 0;
  cl_int answer =
      clEnqueueFillBuffer(queue->queue, buffer->memory, &zero, sizeof zero, 0, bytes / 4 * 4, 0, NULL, NULL);
  return conic_opencl_check(queue->context, answer, "clEnqueueFillBuffer");
}

/* Counts the times of the commands so far, which must be done. */
static void count_times(conic_queue *queue) {
  for (int i = 0; i < queue->n_events; i++) {
    cl_ulong begin = 0, end = 0;
    clGetEventProfilingInfo(queue->events[i], CL_PROFILING_COMMAND_START, sizeof begin, &begin, NULL);
    clGetEventProfilingInfo(queue->events[i], CL_PROFILING_COMMAND_END, sizeof end, &end, NULL);
    queue->ms[queue->stages[i]] += end > begin ? 1e-6 * (double)(end - begin) : 0.0;
    clReleaseEvent(queue->events[i]);
  }
  queue->n_events = 0;
}

conic_status conic_queue_finish(conic_queue *queue) {
  cl_int answer = clFinish(queue->queue);
  count_times(queue);
  return conic_opencl_check(queue->context, answer, "clFinish");
}

conic_status conic_queue_run(conic_queue *queue, conic_stage stage, cl_kernel entry, const conic_argument *arguments,
                             int n_arguments, const size_t items[2], const size_t group[2]) {
  size_t whole[2];
  cl_int answer = CL_SUCCESS;
  for (int i = 0; i < n_arguments && answer == CL_SUCCESS; i++)
    answer = clSetKernelArg(entry, (cl_uint)i, arguments[i].bytes, arguments[i].value);
  conic_status status = conic_opencl_check(queue->context, answer, "clSetKernelArg");
  if (status == CONIC_OK && queue->n_events == CONIC_QUEUE_EVENTS)
    status = conic_queue_finish(queue);
  if (status != CONIC_OK)
    return status;
  for (int i = 0; i < 2; i++)
    whole[i] = (items[i] + group[i] - 1) / group[i] * group[i];
  if (whole[0] == 0 || whole[1] == 0)
    return CONIC_OK;
  answer = clEnqueueNDRangeKernel(queue->queue, entry, 2, NULL, whole, group, 0, NULL, &queue->events[queue->n_events]);
  if (answer == CL_SUCCESS)
    queue->stages[queue->n_events++] = stage;
  return conic_opencl_check(queue->context, answer, "clEnqueueNDRangeKernel");
}
