/* The desk of splats: all that the slots of set-up, sorting, passes and resolving read and write; and the splats that
 * are set out. */
#pragma once

#include "bench/loops/cross.h"
#include "raster/tiles/lights.h"

enum { N_SPLATS = 2501, GREATEST_LIST = 1 << 15, MOST_TILES = 16 };

/* The desk's arenas, in this order; the image's planes follow. */
enum {
  FOOTPRINTS,
  BOXES,
  SURFACES,
  RAYS,
  LIST,
  WORDS,
  REFERENCES,
  SELECTED,
  SELECTED_WORDS,
  KEPT,
  NEAREST,
  SUMS,
  TILES,
  KEYS,
  BEYOND,
  ORDER,
  MOVED_FOOTPRINTS,
  MOVED_SURFACES,
  NEXT_RECORD,
  NEXT_ENTRY,
  TILE_BEGIN,
  ENTRIES,
  IMAGE
};

/* All that the slots read and write: a chunk of splats and its records, a band of blocks, an image. */
typedef struct splat_desk {
  cross_desk memory;
  const fixture *f;
  conic_view view;
  conic_finish finish;
  conic_finish_lights lights;
  conic_chunk chunk;
  conic_projected projected;
  uint32_t *list, *words, *selected, *selected_words;
  uint32_t *tiles, *keys, *beyond, *order; /* of records */
  conic_footprint *moved_footprints;
  conic_projected_surface *moved_surfaces;
  conic_bins bins;
  conic_sorter sorter;
  uint32_t *next_record, *next_entry, *tile_begin;
  conic_tile_entry *entries; /* of up to MOST_TILES tiles a splat */
  size_t n_entry_room;
  conic_tile_entry *references;
  conic_band band;
  conic_tile_rays rays;
  conic_image image;
  size_t n_answered; /* what the slot returned */
} splat_desk;

static inline float any_value(uint64_t *state, double scale, double share_of_specials) {
  static const float specials[] = {NAN,     INFINITY, -INFINITY, 0.0f,   -0.0f, 1e-42f,
                                   -1e-42f, 1e30f,    -1e30f,    1e-20f, 3e38f};
  if (fixture_random(state) < share_of_specials)
    return specials[(int)(fixture_random(state) * 11.0)];
  return (float)(scale * (fixture_random(state) - 0.5));
}

/* Sizes down to 10^-decades: with less than one, most splats cover most blocks. */
static inline void fill(fixture *f, uint64_t *state, double decades, double share_of_specials) {
  unsigned fields = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES;
  conic_splats_release(f->context, &f->splats);
  CHECK_OK(conic_splats_allocate(f->context, N_SPLATS, fields, &f->splats));
  for (size_t i = 0; i < N_SPLATS; i++) {
    f->splats.opacity[i] = any_value(state, 2.0, share_of_specials) + 0.5f;
    double size = pow(10.0, -decades * fixture_random(state)), thin = i % 7 ? 1.0 : 1e-5;
    for (int axis = 0; axis < 3; axis++) {
      float center = any_value(state, decades < 1.0 ? 0.7 : 3.0, share_of_specials);
      f->splats.position[axis][i] = axis == 2 ? center + 1.6f : center;
      f->splats.tangent_u[axis][i] = any_value(state, size, share_of_specials);
      f->splats.tangent_v[axis][i] = any_value(state, size * thin, share_of_specials);
      f->splats.color[axis][i] = any_value(state, 2.0, share_of_specials);
    }
    if (share_of_specials > 0.0 && i % 50 == 0) { /* frontal giants: the determinant of their variance overflows */
      for (int axis = 0; axis < 3; axis++)
        f->splats.tangent_u[axis][i] = f->splats.tangent_v[axis][i] = 0.0f;
      f->splats.tangent_u[0][i] = f->splats.tangent_v[1][i] = (float)pow(10.0, 4.0 + (double)(i % 9));
    }
  }
}

/* A light of each frame in several colours, under a sky. */
static inline conic_lighting colored_lights(int number) {
  conic_lighting lighting = {.is_given = 1, .n_lights = 1 + number % CONIC_MAX_LIGHTS, .up = {0.1, -1.0, 0.2}};
  for (int i = 0; i < lighting.n_lights; i++) {
    lighting.lights[i].frame = (conic_light_frame)((number + i) % 3);
    for (int axis = 0; axis < 3; axis++) {
      lighting.lights[i].color[axis] = (float)(1 + (i * 5 + axis * 3) % 7) / 9.0f;
      lighting.lights[i].direction[axis] = (double)((i * 3 + axis * 5 + number) % 11) - 4.6;
    }
  }
  for (int axis = 0; axis < 3 && number % 2; axis++) {
    lighting.sky[axis] = 0.07f * (float)(axis + 1);
    lighting.ground[axis] = 0.05f / (float)(axis + 1);
  }
  return lighting;
}

/* Options for each way through the loops: every method with every kernel, the rest as it comes. */
static inline void choose(fixture *f, int number) {
  conic_render_options_init(&f->options);
  f->options.method = (conic_method)(number % CONIC_N_METHODS);
  f->options.kernel.type = (conic_kernel_type)(number / CONIC_N_METHODS % CONIC_N_KERNELS);
  f->options.shading = (conic_shading)(number % 2 ? CONIC_SHADE_PHONG : number % 3);
  f->options.has_light = number % 4 == 1;
  f->options.light[2] = 1.0;
  if (number % 3 == 1)
    f->options.lighting = colored_lights(number);
  f->options.has_background = number % 8 == 6;
  f->options.cull_back = number % 5 == 2;
  f->options.prefilter = number % 7 == 3 ? 0.0f : 1.0f;
  f->options.epsilon = number % 11 == 4 ? 0.0 : -1.0;
}

static inline void open_finish(splat_desk *d) {
  const conic_render_options *options = &d->f->options;
  d->finish = (conic_finish){.options = options, .lights = &d->lights, .exposure = 1.25f};
  for (int i = 0; i < 3; i++)
    d->finish.world_from_cam[i][i] = 1.0f;
  for (int i = 0; options->has_background && i < 4; i++)
    d->finish.background[i] = i < 3 ? 0.25f : 1.0f;
  CHECK_OK(conic_finish_lights_init(d->f->context, &d->f->camera, options, &d->lights));
}

static inline void open_records(splat_desk *d, size_t n) {
  d->projected.n_chunks = 1;
  d->projected.chunk_size = n;
  d->projected.chunks = &d->chunk;
  size_t with_slack = n + CONIC_PROJECT_SLACK;
  d->projected.footprints = cross_room(&d->memory, "footprints", with_slack * sizeof *d->projected.footprints);
  d->projected.boxes = cross_room(&d->memory, "boxes", with_slack * sizeof *d->projected.boxes);
  d->projected.surfaces = cross_room(&d->memory, "surfaces", with_slack * sizeof *d->projected.surfaces);
  d->projected.rays = cross_room(&d->memory, "rays", n * sizeof *d->projected.rays);
}

static inline void open_band(splat_desk *d, size_t n, unsigned planes) {
  n = n < GREATEST_LIST ? n : GREATEST_LIST;
  d->list = cross_room(&d->memory, "list", n * sizeof *d->list);
  d->words = cross_room(&d->memory, "words", n * sizeof *d->words);
  d->references = cross_room(&d->memory, "references", n * sizeof *d->references);
  d->selected = cross_room(&d->memory, "selected", (n + CONIC_SELECT_SLACK) * sizeof *d->selected);
  d->selected_words = cross_room(&d->memory, "selected words", (n + CONIC_SELECT_SLACK) * sizeof *d->selected_words);
  d->band.kept = cross_room(&d->memory, "kept", (CONIC_BAND_BLOCKS + 1) * sizeof *d->band.kept);
  d->band.nearest = cross_room(&d->memory, "nearest", sizeof *d->band.nearest);
  d->band.sums = cross_room(&d->memory, "sums", CONIC_BAND_BLOCKS * sizeof *d->band.sums);
  d->band.view = &d->view;
  d->band.projected = &d->projected;
  d->band.indices = d->list;
  d->band.words = d->words;
  d->band.keeps_indices = (planes & (1u << CONIC_PLANE_COUNT | 1u << CONIC_PLANE_ID)) != 0;
}

/* What records are turned into. */
static inline void open_turned(splat_desk *d, size_t n) {
  d->bins = (conic_bins){.tile = 32, .tile_bits = 5, .n_tiles_x = (d->view.width + 31) / 32};
  d->bins.n_tiles = (size_t)d->bins.n_tiles_x * (size_t)((d->view.height + 31) / 32);
  d->n_entry_room = n * (d->bins.n_tiles < MOST_TILES ? d->bins.n_tiles : MOST_TILES) + 1;
  d->tiles = cross_room(&d->memory, "tiles", n * sizeof *d->tiles);
  d->keys = cross_room(&d->memory, "keys", n * sizeof *d->keys);
  d->beyond = cross_room(&d->memory, "beyond", n * sizeof *d->beyond);
  d->order = cross_room(&d->memory, "order", n * sizeof *d->order);
  d->moved_footprints = cross_room(&d->memory, "moved footprints", n * sizeof *d->moved_footprints);
  d->moved_surfaces = cross_room(&d->memory, "moved surfaces", n * sizeof *d->moved_surfaces);
  d->next_record = cross_room(&d->memory, "next record", (d->bins.n_tiles + 1) * sizeof *d->next_record);
  d->next_entry = cross_room(&d->memory, "next entry", (d->bins.n_tiles + 1) * sizeof *d->next_entry);
  d->tile_begin = cross_room(&d->memory, "tile begin", (d->bins.n_tiles + 1) * sizeof *d->tile_begin);
  d->entries = cross_room(&d->memory, "entries", d->n_entry_room * sizeof *d->entries);
}

static inline void open_image(splat_desk *d, unsigned planes) {
  d->image.width = d->view.width;
  d->image.height = d->view.height;
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    if (planes & 1u << plane)
      d->image.planes[plane] = cross_room(&d->memory, "an image's plane",
                                          (size_t)d->view.width * (size_t)d->view.height * sizeof(float) *
                                              (size_t)conic_plane_describe((conic_plane)plane)->n_channels);
}

static inline splat_desk *open_desk(const fixture *f, unsigned planes) {
  splat_desk *d = cross_calloc(sizeof *d);
  d->f = f;
  CHECK_OK(conic_view_init(f->context, &f->splats, &f->camera, &f->options, 1e-3, 0.01, &d->view));
  open_finish(d);
  open_records(d, f->splats.count);
  open_band(d, f->splats.count, planes);
  open_turned(d, f->splats.count);
  open_image(d, planes);
  return d;
}
