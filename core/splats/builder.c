#include "core/splats/builder.h"

#include "core/splats/splats_gather.h"

/* From here on a point is far out. */
static const double far_out = 65536.0;

conic_status conic_builder_begin(conic_context *context, conic_model *model, unsigned fields,
                                 const conic_delivery *delivery, conic_builder *builder) {
  memset(builder, 0, sizeof *builder);
  memset(model, 0, sizeof *model);
  builder->context = context;
  builder->delivery = delivery;
  builder->model = model;
  return conic_splats_allocate(context, 0, fields, &model->points);
}

/* Of points that stay, what was read only to choose and to colour them goes. */
static void settle_values(conic_builder *builder) {
  conic_splats *points = &builder->model->points;
  conic_point_values_settle(points);
  if (points->values->n > 0)
    return;
  conic_point_values_destroy(builder->context, points->values);
  points->values = NULL;
}

conic_status conic_builder_deliver(conic_builder *builder, int is_last) {
  conic_splats *points = &builder->model->points;
  const conic_delivery *delivery = builder->delivery;
  if (!delivery && is_last && points->values)
    settle_values(builder);
  if (!delivery || points->count < (is_last ? 1 : delivery->batch))
    return CONIC_OK;
  builder->n_delivered += points->count;
  if (points->values && !delivery->is_survey)
    conic_point_values_settle(points);
  conic_status status = points->count > 0 ? delivery->receive(delivery->cookie, points) : CONIC_OK;
  if (delivery->n_wanted && points->values && delivery->is_survey)
    conic_point_values_settle(points);
  if (delivery->n_wanted)
    *delivery->n_wanted += points->count;
  points->count = points->n_clips = 0;
  return status;
}

static conic_status move_points(conic_builder *builder, size_t capacity, unsigned fields) {
  conic_status status = conic_splats_resize(builder->context, &builder->model->points, capacity, fields);
  if (status == CONIC_OK && builder->model->points.values)
    status = conic_point_values_reserve(builder->context, builder->model->points.values, capacity);
  if (status == CONIC_OK)
    builder->point_capacity = capacity;
  return status;
}

conic_status conic_builder_reserve_points_exactly(conic_builder *builder, size_t count) {
  if (count <= builder->point_capacity)
    return CONIC_OK;
  return move_points(builder, count, conic_splats_fields(&builder->model->points));
}

conic_status conic_builder_reserve_points(conic_builder *builder, size_t count) {
  size_t capacity = builder->point_capacity + builder->point_capacity / 2 + 1024;
  if (count <= builder->point_capacity)
    return CONIC_OK;
  return conic_builder_reserve_points_exactly(builder, count > capacity ? count : capacity);
}

void conic_builder_store_position(conic_builder *builder, const double position[3]) {
  conic_splats *points = &builder->model->points;
  double x = position[0], y = position[1], z = position[2];
  if (!builder->is_origin_set && x - x == 0.0 && y - y == 0.0 && z - z == 0.0) {
    if (fabs(x) > far_out || fabs(y) > far_out || fabs(z) > far_out)
      memcpy(points->origin, position, sizeof points->origin);
    builder->is_origin_set = 1;
  }
  for (int axis = 0; axis < 3; axis++)
    points->position[axis][points->count] = (float)(position[axis] - points->origin[axis]);
}

conic_status conic_builder_add_field(conic_builder *builder, conic_splats_field field) {
  unsigned fields = conic_splats_fields(&builder->model->points);
  if (fields & (unsigned)field)
    return CONIC_OK;
  return move_points(builder, builder->point_capacity, fields | (unsigned)field);
}

conic_status conic_builder_add_clip(conic_builder *builder, const conic_clip *clip) {
  conic_splats *points = &builder->model->points;
  return conic_memory_append(builder->context, &points->clips, &points->n_clips, &builder->clip_capacity, clip,
                             sizeof *clip);
}

conic_status conic_builder_add_triangle(conic_builder *builder, uint32_t a, uint32_t b, uint32_t c) {
  conic_model *model = builder->model;
  const uint32_t triangle[3] = {a, b, c};
  return conic_memory_append(builder->context, &model->triangles, &model->n_triangles, &builder->triangle_capacity,
                             triangle, sizeof triangle);
}
