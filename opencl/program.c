#include "opencl/program.h"

#include "core/image/image_common.h"
#include "opencl/cache.h"

static const char exact_options[] = "-cl-std=CL1.2 -w -cl-fp32-correctly-rounded-divide-sqrt";
static const char inexact_options[] = "-cl-std=CL1.2 -w";

static const char *options_of_device(const conic_opencl_device *device) {
  return device->rounds_correctly ? exact_options : inexact_options;
}

/* What memory is called for ahead of its use by, which changes no value; what is put in place of its call; and how
 * masks become bits and a vector's lanes come to the front, where lanes_words.cl has slower words. PoCL leaves
 * prefetch() without effect, but its compiler is clang. Oclgrind cannot run what is always put in place. */
static const char words_of_others[] =
    "#define CONIC_ALWAYS_INLINE\n"
    "#define CONIC_FETCH_AHEAD(pointer) prefetch((const __global float *)(pointer), 1)\n";
static const char words_of_pocl[] =
    "#define CONIC_ALWAYS_INLINE __attribute__((always_inline))\n"
    "#define CONIC_FETCH_AHEAD(pointer) __builtin_prefetch((const void *)(size_t)(pointer))\n"
    "#ifdef __AVX512F__\n"
    "typedef int conic_words __attribute__((vector_size(64)));\n"
    "#define CONIC_WORDS(value) __builtin_astype((value), conic_words)\n"
    "#define CONIC_LANES_BITS(mask) ((uint)(ushort)__builtin_ia32_cmpd512_mask("
    "CONIC_WORDS(mask), CONIC_WORDS((int16)(0)), 4, -1))\n"
    "#define CONIC_LANES_ANY(mask) (CONIC_LANES_BITS(mask) != 0)\n"
    "#define CONIC_LANES_PACK(mask, value) __builtin_astype(__builtin_ia32_compresssi512_mask("
    "CONIC_WORDS(value), CONIC_WORDS((int16)(0)), (ushort)CONIC_LANES_BITS(mask)), uint16)\n"
    "#endif\n";

/* What stands before the text: the tiles' size, and those words. */
static void write_prelude(const conic_opencl_device *device, int tile_bits, char *prelude, size_t room) {
  int is_pocl = strstr(device->platform, "Portable Computing Language") != NULL;
  snprintf(prelude, room,
           "#define CONIC_DEVICE_TILE %d\n#define CONIC_DEVICE_TILE_BITS %d\n%s"
           "#ifndef CONIC_LANES_BITS\n#define CONIC_LANES_BITS(mask) lanes_gather_bits(mask)\n"
           "#define CONIC_LANES_ANY(mask) lanes_find_any(mask)\n"
           "#define CONIC_LANES_PACK(mask, value) lanes_bring_forward(mask, value)\n#endif\n",
           1 << tile_bits, tile_bits, is_pocl ? words_of_pocl : words_of_others);
}

/* What a built program depends on. */
static uint64_t hash_of(const conic_opencl_device *device, const char *prelude, const conic_opencl_text *text) {
  const char *parts[] = {prelude,         text->text,    options_of_device(device), device->name, device->platform,
                         device->version, device->driver};
  uint64_t hashes[sizeof parts / sizeof parts[0]];
  for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
    hashes[i] = conic_hash_bytes(parts[i], strlen(parts[i]));
  return conic_hash_bytes(hashes, sizeof hashes);
}

/* What the compiler says, line by line. */
static void log_build(conic_context *context, cl_device_id id, cl_program program, const char *name) {
  size_t n = 0;
  if (clGetProgramBuildInfo(program, id, CL_PROGRAM_BUILD_LOG, 0, NULL, &n) != CL_SUCCESS || n < 2)
    return;
  char *log = conic_memory_allocate(context, n + 1, 1);
  if (!log)
    return;
  log[0] = 0;
  clGetProgramBuildInfo(program, id, CL_PROGRAM_BUILD_LOG, n, log, NULL);
  log[n] = 0;
  for (char *line = log, *end; *line; line = end) {
    end = line + strcspn(line, "\n");
    int is_last = !*end;
    *end = 0;
    if (*line)
      conic_log(context, CONIC_LOG_WARNING, "%s: %s", name, line);
    if (!is_last)
      end++;
  }
  conic_memory_release(context, log);
}

static conic_status build_program(conic_context *context, cl_device_id id, const conic_opencl_device *device,
                                  const char *name, cl_program program) {
  cl_int answer = clBuildProgram(program, 1, &id, options_of_device(device), NULL, NULL);
  if (answer == CL_SUCCESS)
    return CONIC_OK;
  log_build(context, id, program, name);
  return conic_fail(context, CONIC_ERROR_UNSUPPORTED, "opencl:%d.%d: %s cannot build the program %s (%d)",
                    device->i_platform, device->i_device, device->name, name, answer);
}

/* From a kept binary; null where it will not do. */
static cl_program from_cache(conic_context *context, cl_context cl, cl_device_id id, const conic_opencl_device *device,
                             const char *path) {
  unsigned char *bytes;
  size_t n;
  if (!conic_cache_read(context, path, &bytes, &n))
    return NULL;
  cl_int of_binary = CL_SUCCESS, answer;
  const unsigned char *binary = bytes;
  cl_program program = clCreateProgramWithBinary(cl, 1, &id, &n, &binary, &of_binary, &answer);
  conic_memory_release(context, bytes);
  if (answer == CL_SUCCESS && of_binary == CL_SUCCESS &&
      clBuildProgram(program, 1, &id, options_of_device(device), NULL, NULL) == CL_SUCCESS)
    return program;
  if (program)
    clReleaseProgram(program);
  return NULL;
}

static void to_cache(conic_context *context, cl_program program, const char *path) {
  size_t n = 0;
  if (clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof n, &n, NULL) != CL_SUCCESS || n == 0)
    return;
  unsigned char *bytes = conic_memory_allocate(context, n, 1);
  if (bytes && clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof bytes, &bytes, NULL) == CL_SUCCESS)
    conic_cache_write(context, path, bytes, n);
  conic_memory_release(context, bytes);
}

conic_status conic_opencl_build(conic_context *context, cl_context cl, cl_device_id id,
                                const conic_opencl_device *device, int tile_bits, const conic_opencl_text *text,
                                const char *cache_folder, cl_program *program) {
  char path[4096] = "", prelude[2048];
  cl_int answer;
  write_prelude(device, tile_bits, prelude, sizeof prelude);
  if (cache_folder)
    conic_cache_path(cache_folder, text->name, hash_of(device, prelude, text), path, sizeof path);
  *program = path[0] ? from_cache(context, cl, id, device, path) : NULL;
  if (*program)
    return CONIC_OK;
  const char *sources[] = {prelude, text->text};
  *program = clCreateProgramWithSource(cl, 2, sources, NULL, &answer);
  conic_status status = conic_opencl_check(context, answer, "clCreateProgramWithSource");
  if (status != CONIC_OK)
    return status;
  status = build_program(context, id, device, text->name, *program);
  if (status != CONIC_OK) {
    clReleaseProgram(*program);
    *program = NULL;
  } else if (path[0])
    to_cache(context, *program, path);
  return status;
}
