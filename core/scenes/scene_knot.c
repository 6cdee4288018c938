#include "core/base/trigonometry.h"
#include "core/base/vectors.h"
#include "core/scenes/scene_kind.h"

/* The trefoil: a curve that goes twice around the y axis while it goes three times around the ring it lies on. */
#define RING_RADIUS 1.0
#define WINDING_RADIUS 0.45
#define TUBE_RADIUS 0.26

/* The curve's parameter goes from 0 to 2π; after every third of that the curve repeats, rotated. */
enum { NODES = 3 * 1024 };

/* The parameter at even steps of arc length. */
typedef struct knot {
  double parameters[NODES + 1];
} knot;

/* Turquoise, gold, crimson, violet and back. */
static const uint8_t palette[][3] = {
    {0x1f, 0xa5, 0x9f}, {0xf2, 0xc1, 0x4e}, {0xd6, 0x3a, 0x4a}, {0x6b, 0x4f, 0xa3}, {0x1f, 0xa5, 0x9f}};

enum { RIBS = 96 }; /* darker rings along the tube */

/* The curve's speed has two parts at right angles: around the axis, and around the ring. */
static double speed(double parameter) {
  double around_axis = 2.0 * (RING_RADIUS + WINDING_RADIUS * conic_cos(3.0 * parameter));
  return sqrt(around_axis * around_axis + 9.0 * WINDING_RADIUS * WINDING_RADIUS);
}

/* The arc length over a step, by Simpson's rule. */
static double step_length(double from, double to) {
  return (to - from) / 6.0 * (speed(from) + 4.0 * speed(0.5 * (from + to)) + speed(to));
}

static conic_status prepare_knot(conic_scene *scene) {
  const double step = 2.0 * CONIC_PI / NODES;
  knot *made = conic_scene_surface(scene, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  double length = 0.0, walked = 0.0;
  for (int i = 0; i < NODES; i++)
    length += step_length((double)i * step, (double)(i + 1) * step);
  int i_node = 0;
  for (int i = 0; i < NODES; i++) {
    double here = step_length((double)i * step, (double)(i + 1) * step);
    for (; i_node < NODES && length * (double)i_node / NODES < walked + here; i_node++)
      made->parameters[i_node] = ((double)i + (length * (double)i_node / NODES - walked) / here) * step;
    walked += here;
  }
  for (; i_node <= NODES; i_node++)
    made->parameters[i_node] = 2.0 * CONIC_PI;
  scene->area = 2.0 * CONIC_PI * TUBE_RADIUS * length; /* the bends add as much outside as they take inside */
  return CONIC_OK;
}

static double parameter_at(const knot *surface, double part) {
  double place = part * NODES;
  int i = (int)place < NODES ? (int)place : NODES - 1;
  return surface->parameters[i] + (surface->parameters[i + 1] - surface->parameters[i]) * (place - (double)i);
}

/* The curve with the directions of its bend and across, and its curvature. */
typedef struct curve_frame {
  double position[3], bend[3], across[3], curvature;
} curve_frame;

static void frame_at(double parameter, curve_frame *frame) {
  double c2 = conic_cos(2.0 * parameter), s2 = conic_sin(2.0 * parameter);
  double c3 = conic_cos(3.0 * parameter), s3 = conic_sin(3.0 * parameter);
  /* Distance from the axis and height, with their first and second derivatives. */
  double r = RING_RADIUS + WINDING_RADIUS * c3, r1 = -3.0 * WINDING_RADIUS * s3, r2 = -9.0 * WINDING_RADIUS * c3;
  double y = WINDING_RADIUS * s3, y1 = 3.0 * WINDING_RADIUS * c3, y2 = -9.0 * WINDING_RADIUS * s3;
  double first[3] = {r1 * s2 + 2.0 * r * c2, y1, r1 * c2 - 2.0 * r * s2};
  double second[3] = {r2 * s2 + 4.0 * r1 * c2 - 4.0 * r * s2, y2, r2 * c2 - 4.0 * r1 * s2 - 4.0 * r * c2};
  double along[3], binormal[3];
  double pace = conic_length(first);
  conic_cross(first, second, binormal);
  double turning = conic_length(binormal);
  for (int axis = 0; axis < 3; axis++) {
    along[axis] = first[axis] / pace;
    frame->across[axis] = binormal[axis] / turning;
  }
  conic_cross(frame->across, along, frame->bend);
  frame->position[0] = r * s2;
  frame->position[1] = y;
  frame->position[2] = r * c2;
  frame->curvature = turning / (pace * pace * pace);
}

static void place_on_knot(const conic_scene *scene, uint64_t i, conic_scene_point *point) {
  double along, around;
  curve_frame frame;
  conic_scene_golden(i, scene->options.count, &along, &around);
  frame_at(parameter_at(scene->surface, along), &frame);
  double angle = conic_scene_equal_area_angle(around, frame.curvature * TUBE_RADIUS);
  double to_bend = conic_cos(angle), to_across = conic_sin(angle);
  for (int axis = 0; axis < 3; axis++) {
    point->normal[axis] = frame.bend[axis] * to_bend + frame.across[axis] * to_across;
    point->position[axis] = frame.position[axis] + TUBE_RADIUS * point->normal[axis];
  }
  conic_scene_blend(palette, (int)(sizeof palette / sizeof *palette), along, point->color);
  double rib = along * RIBS - (double)(int)(along * RIBS);
  for (int c = 0; c < 3 && rib < 0.22; c++)
    point->color[c] = (uint8_t)(point->color[c] / 2);
}

const conic_scene_kind conic_scene_knot = {.name = "knot",
                                           .summary = "a (2, 3) torus knot as a tube, colours along it",
                                           .prepare = prepare_knot,
                                           .place = place_on_knot};
