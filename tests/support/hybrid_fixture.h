/* What the tests of hybrid models share: meshes, models of them, and pictures from all around. */
#pragma once

#include "lod/hybrid/model/hybrid_model.h"
#include "tests/support/check.h"

/* A height field of side × side squares, two triangles each: smooth, with hills of several sizes. */
static inline void hybrid_terrain(conic_context *context, size_t side, conic_triangles *mesh) {
  CHECK_OK(conic_triangles_allocate(context, 2 * side * side, (side + 1) * (side + 1), 0, mesh));
  for (size_t y = 0; y <= side; y++)
    for (size_t x = 0; x <= side; x++) {
      size_t i = y * (side + 1) + x;
      double u = (double)x / (double)side, v = (double)y / (double)side, height = 0.0, size = 0.12;
      for (int octave = 0; octave < 6; octave++, size *= 0.45) {
        double f = 5.0 * (double)(1 << octave);
        height += size * sin(f * u + 1.3 * octave) * sin(f * v + 0.7 * octave * octave);
      }
      mesh->position[0][i] = (float)u;
      mesh->position[1][i] = (float)(u > 0.7 ? 0.2 * height : height); /* partly flat */
      mesh->position[2][i] = (float)v;
    }
  for (size_t y = 0; y < side; y++)
    for (size_t x = 0; x < side; x++) {
      uint32_t i = (uint32_t)(y * (side + 1) + x), below = i + (uint32_t)side + 1;
      uint32_t(*corners)[3] = mesh->corners + 2 * (y * side + x);
      const uint32_t both[2][3] = {{i, below, i + 1}, {i + 1, below, below + 1}};
      memcpy(corners, both, sizeof both);
    }
}

/* A mesh of the shared data, or where there is no path a terrain. */
static inline void hybrid_mesh(conic_context *context, const char *path, size_t side, conic_triangles *mesh) {
  if (path)
    CHECK_OK(conic_triangles_read(context, path, mesh));
  else
    hybrid_terrain(context, side, mesh);
}

/* The 26 directions to the corners, edges and sides of a cube. */
enum { HYBRID_DIRECTIONS = 26 };

static inline void hybrid_look(conic_context *context, int direction, int size, double zoom, const double low[3],
                               const double high[3], conic_camera *camera) {
  static const double elevations[3] = {-35.26, 0.0, 35.26};
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = framing.height = size;
  framing.zoom = zoom;
  framing.azimuth_deg = 45.0 * (direction % 8) + 0.37; /* no edge of the model lies along a row by chance */
  framing.elevation_deg = direction < 24 ? elevations[direction / 8] : direction == 24 ? -90.0 : 90.0;
  CHECK_OK(conic_camera_frame(context, &framing, low, high, camera));
}
