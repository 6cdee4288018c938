/* EXT_meshopt_compression, through libmeshoptimizer where it is there. */
#include "core/gltf/gltf.h"

#if CONIC_HAVE_MESHOPTIMIZER

#include <meshoptimizer.h>

/* No byte that is packed stands for more: a spoiled file cannot ask for memory that its size does not bear out. */
enum { MOST_TIMES = 64, SOME_MORE = 1 << 16 };

int conic_gltf_can_unpack(void) {
  return 1;
}

/* Undoes a filter; 0 for one that is not known, or of another stride than it has. */
static int undo_filter(const char *filter, unsigned char *bytes, size_t count, size_t stride) {
  if (!filter[0] || strcmp(filter, "NONE") == 0)
    return 1;
  if (strcmp(filter, "OCTAHEDRAL") == 0 && (stride == 4 || stride == 8))
    meshopt_decodeFilterOct(bytes, count, stride);
  else if (strcmp(filter, "QUATERNION") == 0 && stride == 8)
    meshopt_decodeFilterQuat(bytes, count, stride);
  else if (strcmp(filter, "EXPONENTIAL") == 0 && stride % 4 == 0)
    meshopt_decodeFilterExp(bytes, count, stride);
  else
    return 0;
  return 1;
}

/* Whether the view was unpacked: the library asserts what is checked here first. */
static int unpack_view(const conic_gltf_packed *packed, const conic_gltf_bytes *from, size_t count, size_t stride,
                       unsigned char *to) {
  if (strcmp(packed->mode, "ATTRIBUTES") == 0)
    return stride >= 4 && stride % 4 == 0 &&
           meshopt_decodeVertexBuffer(to, count, stride, from->bytes, from->n_bytes) == 0 &&
           undo_filter(packed->filter, to, count, stride);
  if (stride != 2 && stride != 4)
    return 0;
  if (strcmp(packed->mode, "TRIANGLES") == 0)
    return count % 3 == 0 && meshopt_decodeIndexBuffer(to, count, stride, from->bytes, from->n_bytes) == 0;
  return strcmp(packed->mode, "INDICES") == 0 &&
         meshopt_decodeIndexSequence(to, count, stride, from->bytes, from->n_bytes) == 0;
}

conic_status conic_gltf_unpack(conic_gltf *gltf, conic_gltf_view *view, size_t n_bytes) {
  const conic_gltf_packed *packed = &view->packed;
  conic_gltf_bytes from;
  conic_status status = conic_gltf_open_part(gltf, packed->buffer, packed->offset, packed->length, &from);
  if (status != CONIC_OK)
    return status;
  if (!conic_gltf_is_index(packed->stride, 257) || packed->count * packed->stride != (double)n_bytes ||
      n_bytes / MOST_TIMES > from.n_bytes + SOME_MORE / MOST_TIMES)
    return conic_gltf_wrong(gltf, "a view of EXT_meshopt_compression has another length than its items");
  unsigned char *bytes = conic_memory_allocate_zeroed(gltf->context, n_bytes, 1);
  if (!bytes)
    return CONIC_ERROR_MEMORY;
  if (unpack_view(packed, &from, (size_t)packed->count, (size_t)packed->stride, bytes)) {
    view->own = bytes;
    return CONIC_OK;
  }
  conic_memory_release(gltf->context, bytes);
  return conic_gltf_wrong(gltf, "a view of EXT_meshopt_compression is spoiled");
}

#else

int conic_gltf_can_unpack(void) {
  return 0;
}

conic_status conic_gltf_unpack(conic_gltf *gltf, conic_gltf_view *view, size_t n_bytes) {
  (void)view;
  (void)n_bytes;
  return conic_fail(gltf->context, CONIC_ERROR_UNSUPPORTED,
                    "%s: the file is packed by EXT_meshopt_compression; libmeshoptimizer, which this build is without, "
                    "would read it",
                    gltf->name);
}

#endif
