#include "cli/top/top_tiff.h"

#include "core/pictures/image_samples.h"

enum { BLOCK = CONIC_TOP_BLOCK, TILE = CONIC_TIFF_TILE };

conic_status cli_top_tiff_open(conic_context *context, const char *path, const conic_tiff_layout *layout,
                               uint64_t most_bytes, cli_top_tiff *file) {
  size_t pixel_bytes = conic_tiff_pixel_bytes(layout), edge = BLOCK > TILE ? BLOCK : TILE;
  *file = (cli_top_tiff){.context = context, .layout = *layout, .store = {.scratch = {.descriptor = -1}}};
  file->pixels = conic_memory_allocate(context, edge * edge, pixel_bytes);
  conic_status status = file->pixels ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = cli_top_store_open(context, path, layout->width, pixel_bytes, BLOCK + TILE, most_bytes, &file->store);
  if (status == CONIC_OK)
    status = conic_tiff_open(context, path, layout, &file->tiff);
  return status == CONIC_OK ? CONIC_OK : cli_top_tiff_end(file, status);
}

/* Encodes the block's pixels as the file has them. */
static void encode_block(cli_top_tiff *file, const conic_image *block) {
  const conic_samples_layout bytes = {.n_channels = 4, .sample_bytes = 1, .is_straight = 1};
  const float *z = block->planes[CONIC_PLANE_Z];
  float nodata = (float)file->layout.nodata;
  if (!file->layout.is_elevation)
    conic_samples_from_rgba(file->context, block->planes[CONIC_PLANE_RGBA], BLOCK, BLOCK, bytes, file->pixels);
  for (size_t i = 0; i < (size_t)BLOCK * BLOCK && file->layout.is_elevation; i++)
    memcpy(file->pixels + sizeof *z * i, isnan(z[i]) ? &nodata : &z[i], sizeof *z);
}

conic_status cli_top_tiff_put(cli_top_tiff *file, const conic_image *block, const cli_top_cut *cut) {
  size_t pixel_bytes = conic_tiff_pixel_bytes(&file->layout);
  conic_status status = CONIC_OK;
  encode_block(file, block);
  for (size_t row = 0; row < cut->height && status == CONIC_OK; row++)
    status = cli_top_store_put(&file->store, cut->x, cut->y + row,
                               file->pixels + ((cut->block_y + row) * BLOCK + cut->block_x) * pixel_bytes, cut->width);
  return status;
}

/* Writes a tile of the row of tiles that begins at row y. Pixels outside of the picture are zero. */
static conic_status write_tile(cli_top_tiff *file, size_t x, size_t y) {
  const conic_tiff_layout *layout = &file->layout;
  size_t pixel_bytes = conic_tiff_pixel_bytes(layout);
  size_t width = layout->width - x < TILE ? (size_t)layout->width - x : TILE;
  size_t height = layout->height - y < TILE ? (size_t)layout->height - y : TILE;
  conic_status status = CONIC_OK;
  memset(file->pixels, 0, (size_t)TILE * TILE * pixel_bytes);
  for (size_t row = 0; row < height && status == CONIC_OK; row++)
    status = cli_top_store_get(&file->store, x, y + row, file->pixels + row * TILE * pixel_bytes, width);
  return status == CONIC_OK ? conic_tiff_append(file->tiff, file->pixels) : status;
}

conic_status cli_top_tiff_advance(cli_top_tiff *file, size_t n_rows) {
  conic_status status = CONIC_OK;
  size_t height = (size_t)file->layout.height;
  while (status == CONIC_OK && file->n_rows_done < height && (file->n_rows_done + TILE <= n_rows || n_rows == height)) {
    for (size_t x = 0; x < file->layout.width && status == CONIC_OK; x += TILE)
      status = write_tile(file, x, file->n_rows_done);
    file->n_rows_done += TILE;
  }
  return status;
}

conic_status cli_top_tiff_end(cli_top_tiff *file, conic_status status) {
  status = conic_tiff_end(file->tiff, status);
  conic_memory_release(file->context, file->pixels);
  cli_top_store_close(&file->store);
  memset(file, 0, sizeof *file);
  return status;
}
