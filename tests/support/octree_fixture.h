/* What the octree's tests share: sets of splats, octrees of them. */
#pragma once

#include "lod/octree/octree_nodes.h"
#include "tests/support/fixture.h"

/* A copy, as building takes the splats over. */
static inline conic_splats octree_copy(conic_context *context, const conic_splats *splats) {
  conic_splats copy = {0};
  memcpy(copy.origin, splats->origin, sizeof copy.origin);
  if (conic_splats_append(context, &copy, splats) != CONIC_OK)
    exit(1);
  return copy;
}

static inline conic_octree *octree_build(conic_context *context, const conic_splats *splats, int quantize) {
  conic_splats copy = octree_copy(context, splats);
  conic_octree_options options;
  conic_octree *octree;
  conic_octree_options_init(&options);
  options.quantize = quantize;
  CHECK_OK(conic_octree_build(context, &copy, &options, &octree));
  CHECK(copy.count == 0 && !copy.position[0]);
  if (!octree || conic_octree_decode(octree) != CONIC_OK)
    exit(1);
  return octree;
}

static inline void octree_check_sound(conic_octree *octree) {
  conic_octree_defects found;
  CHECK_OK(conic_octree_check(octree, &found));
  CHECK(found.ellipses == 0 && found.spheres == 0 && found.cones == 0 && found.errors == 0 && found.splats == 0);
}

/* A scan of the shared data as splats; 0 where it is not there. */
static inline int octree_read_scan(fixture *f, const char *source_folder, const char *name) {
  const char *path = check_data(source_folder, name);
  conic_estimate_options estimate;
  conic_model model;
  if (!path)
    return 0;
  conic_estimate_options_init(&estimate);
  CHECK_OK(conic_model_read(f->context, path, NULL, &model));
  CHECK_OK(conic_model_to_splats(f->context, &estimate, &model, NULL));
  conic_splats_release(f->context, &f->splats);
  f->splats = model.points;
  memset(&model.points, 0, sizeof model.points);
  conic_model_release(f->context, &model);
  return 1;
}

/* A camera around the splats. */
static inline void octree_frame(fixture *f, int size, double azimuth, double elevation, double zoom) {
  double low[3], high[3];
  conic_framing framing;
  conic_framing_init(&framing);
  framing.width = framing.height = size;
  framing.azimuth_deg = azimuth;
  framing.elevation_deg = elevation;
  framing.zoom = zoom;
  conic_splats_bounds(&f->splats, low, high);
  CHECK_OK(conic_camera_frame(f->context, &framing, low, high, &f->camera));
}

static inline void octree_select(conic_octree *octree, const fixture *f, double error_px, uint64_t budget,
                                 conic_selection *selection) {
  conic_selection_options options;
  conic_selection_options_init(&options);
  options.error_px = error_px;
  options.budget = budget;
  CHECK_OK(conic_octree_select(octree, &f->camera, &f->options, &options, selection));
}

/* Draws a selection into the fixture's image. */
static inline void octree_draw(fixture *f, const conic_octree *octree, const conic_selection *selection) {
  conic_render_options options = f->options;
  conic_octree_info info;
  CHECK_OK(conic_octree_describe(octree, &info));
  options.splat_length = info.splat_length;
  options.near_z = options.near_z > 0.0 ? options.near_z : info.near_z;
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &f->image));
  CHECK_OK(conic_render(f->renderer, &selection->splats, &f->camera, &options, &f->image, &f->statistics));
  conic_selection_name(selection, &f->image);
}
