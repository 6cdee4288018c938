#include "cli/top/top_store.h"

conic_status cli_top_store_open(conic_context *context, const char *path, size_t width, size_t pixel_bytes,
                                size_t n_rows, uint64_t most_bytes, cli_top_store *store) {
  *store = (cli_top_store){
      .context = context, .width = width, .pixel_bytes = pixel_bytes, .n_rows = n_rows, .scratch = {.descriptor = -1}};
  if ((uint64_t)width * pixel_bytes * n_rows > most_bytes)
    return conic_scratch_open(context, path, &store->scratch);
  store->rows = conic_memory_allocate(context, width * n_rows, pixel_bytes);
  return store->rows ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void cli_top_store_close(cli_top_store *store) {
  if (!store->context)
    return;
  conic_memory_release(store->context, store->rows);
  if (store->scratch.descriptor >= 0)
    conic_scratch_close(&store->scratch);
}

static size_t place_of(const cli_top_store *store, size_t x, size_t y) {
  return (y % store->n_rows * store->width + x) * store->pixel_bytes;
}

conic_status cli_top_store_put(cli_top_store *store, size_t x, size_t y, const void *pixels, size_t count) {
  size_t at = place_of(store, x, y), n_bytes = count * store->pixel_bytes;
  if (!store->rows)
    return conic_scratch_write(&store->scratch, at, pixels, n_bytes);
  memcpy(store->rows + at, pixels, n_bytes);
  return CONIC_OK;
}

conic_status cli_top_store_get(const cli_top_store *store, size_t x, size_t y, void *pixels, size_t count) {
  size_t at = place_of(store, x, y), n_bytes = count * store->pixel_bytes;
  if (!store->rows)
    return conic_scratch_read(&store->scratch, at, pixels, n_bytes);
  memcpy(pixels, store->rows + at, n_bytes);
  return CONIC_OK;
}
