/* How pixels are finished: their rays, their light, and the pass that normalises, shades and writes them. */
#pragma once

#include "raster/tiles/band.h"

/* Of the light that falls on a surface: from everywhere, from the light, and reflected like a gloss. Chosen by eye on
 * the scans and meshes: the darkest side stays readable and white does not burn out. */
#define CONIC_AMBIENT 0.05f
#define CONIC_DIFFUSE 0.75f
#define CONIC_SPECULAR 0.15f

/* A light as pixels take it: at the viewer's eye, or in one direction (unit, in the world). */
typedef struct conic_finish_light {
  int32_t is_head;
  float towards[3], diffuse[3], specular[3];
} conic_finish_light;

/* A frame's lights (raster/tiles/lights.h). From all around comes ambient, and slope × how far the normal points up
 * where they have a sky. */
typedef struct conic_finish_lights {
  int32_t n_lights, has_sky;
  int32_t is_grey; /* all colours are */
  float ambient[3], slope[3], up[3];
  conic_finish_light lights[CONIC_MAX_LIGHTS];
} conic_finish_lights;

/* How a frame's pixels are finished. */
typedef struct conic_finish {
  const conic_render_options *options;
  const conic_finish_lights *lights;
  float world_from_cam[3][3]; /* for the direction to the viewer */
  float exposure;             /* factor */
  float background[4];        /* of an uncovered pixel: rgba, exposed */
} conic_finish;

void conic_tile_rays_init(const conic_view *view, int x_begin, int y_begin, conic_tile_rays *rays);

/* Colour of a surface with this albedo and normal (unit), seen from the unit direction `viewer`. mean_normal is the
 * weighted mean of the splats' unit normals, whose length says how far they agree. */
void conic_shade(const conic_finish *finish, const float albedo[3], const float normal[3], const float mean_normal[3],
                 const float viewer[3], float shaded[3]);

/* A finished pixel, before it is written to the planes that the image has. */
typedef struct conic_finished_pixel {
  float rgba[4], normal[3], albedo[3];
} conic_finished_pixel;

/* Of a covered pixel's sums, which looks along (dx, dy, 1). Where the normals cancel, that of the heaviest splat. */
void conic_finish_covered(const conic_finish *finish, float weight, const float color_sum[3], const float normal_sum[3],
                          const float heaviest_normal[3], float dx, float dy, conic_finished_pixel *pixel);
void conic_finish_uncovered(const conic_finish *finish, conic_finished_pixel *pixel);
