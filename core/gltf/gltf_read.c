#include "core/gltf/gltf_read.h"

static int is_mode(const conic_gltf_primitive *primitive, int least, int most) {
  return primitive->mode >= least && primitive->mode <= most;
}

/* One mesh at a place: triangles, or points where the file has no triangles. */
static conic_status visit_mesh(void *cookie, const conic_gltf_node *node, const double world[3][4]) {
  conic_gltf_reader *reader = cookie;
  const conic_gltf *gltf = &reader->gltf;
  const conic_gltf_mesh *mesh = conic_gltf_at(gltf, CONIC_GLTF_MESHES, node->mesh);
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < mesh->primitives.n; i++) {
    const conic_gltf_primitive *primitive = conic_gltf_item(gltf, CONIC_GLTF_PRIMITIVES, mesh->primitives, i);
    if (!conic_gltf_is_index(primitive->mode, 7))
      return conic_gltf_wrong(gltf, "a primitive of mode %g, which is none", primitive->mode);
    if (reader->is_counting) {
      reader->has_triangles |= is_mode(primitive, 4, 6);
      reader->n_skipped_lines += is_mode(primitive, 1, 3);
    } else if (is_mode(primitive, 4, 6) || (is_mode(primitive, 0, 0) && !reader->has_triangles))
      status = conic_gltf_add_primitive(reader, node, primitive, world);
  }
  return status == CONIC_OK ? conic_progress(gltf->context, "read", 0.5) : status;
}

static conic_status read_scene(conic_gltf_reader *reader) {
  conic_gltf *gltf = &reader->gltf;
  conic_status status = conic_gltf_check_extensions(gltf);
  if (status == CONIC_OK)
    status = conic_gltf_link_nodes(gltf);
  reader->is_counting = 1;
  if (status == CONIC_OK)
    status = conic_gltf_visit_meshes(gltf, visit_mesh, reader);
  reader->is_counting = 0;
  if (status == CONIC_OK)
    status = conic_gltf_visit_meshes(gltf, visit_mesh, reader);
  return status == CONIC_OK ? conic_mesh_parts_end(&reader->parts) : status;
}

/* What of the file is not drawn. */
static conic_status tell_of_scene(const conic_gltf_reader *reader) {
  const conic_gltf *gltf = &reader->gltf;
  size_t n_scenes = gltf->lists[CONIC_GLTF_SCENES].n;
  if (reader->parts.builder.model->points.count == 0)
    return conic_gltf_wrong(gltf, "there are neither faces nor points in its scene (lines are not drawn)");
  if (reader->n_skipped_lines)
    conic_gltf_warn(gltf, "%d primitives of lines are not drawn", reader->n_skipped_lines);
  if (n_scenes > 1)
    conic_gltf_warn(gltf, "of its %zu scenes, number %g is drawn", n_scenes,
                    gltf->scene == CONIC_GLTF_NONE ? 0.0 : gltf->scene);
  return CONIC_OK;
}

static conic_status read_bytes(conic_gltf_reader *reader, conic_input *input, const conic_mapping *file,
                               conic_model *model) {
  conic_gltf *gltf = &reader->gltf;
  const char *path = strcmp(input->name, "-") == 0 || !input->has_size ? NULL : input->name;
  conic_status status = conic_gltf_open(input->context, input->name, path, file->bytes, file->n_bytes, gltf);
  if (status == CONIC_OK)
    status = conic_mesh_parts_begin(input->context, input->name, reader->options, model, &reader->parts);
  size_t n_made = gltf->lists[CONIC_GLTF_MATERIALS].n + 1;
  if (status == CONIC_OK) {
    reader->made = conic_memory_allocate(input->context, n_made, sizeof *reader->made);
    status = reader->made ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  for (size_t i = 0; reader->made && i < n_made; i++)
    reader->made[i] = UINT32_MAX;
  if (status == CONIC_OK)
    status = read_scene(reader);
  if (status == CONIC_OK)
    status = tell_of_scene(reader);
  model->up[1] = 1.0;
  return status;
}

conic_status conic_gltf_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                             conic_model *model) {
  conic_context *context = input->context;
  conic_mapping file = {NULL, 0, 0};
  conic_gltf_reader *reader = conic_memory_allocate_zeroed(context, 1, sizeof *reader);
  (void)delivery;
  if (!reader)
    return CONIC_ERROR_MEMORY;
  reader->options = options;
  reader->gltf.context = reader->parts.context = context;
  conic_status status = conic_mapping_take(input, SIZE_MAX, &file);
  if (status == CONIC_OK)
    status = read_bytes(reader, input, &file, model);
  conic_gltf_close(&reader->gltf);
  conic_mapping_close(context, &file);
  conic_mesh_part_release(context, &reader->part);
  conic_mesh_parts_release(&reader->parts);
  conic_memory_release_these(context, reader->made, reader);
  return status;
}
