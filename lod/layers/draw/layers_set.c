/* What is gathered to be drawn: splats, their numbers in the file, and the pieces of clouds that they come from. */
#include "lod/layers/draw/layers_gather.h"

#include "core/splats/point_values.h"

void conic_layers_set_release(conic_context *context, conic_layers_set *set) {
  conic_memory_release_these(context, set->arrays, set->ids, set->lines, set->splats.clips, set->pieces);
  conic_point_values_destroy(context, set->named);
  memset(set, 0, sizeof *set);
}

/* Which optional arrays the splats have. */
static int splats_have(const conic_layers *layers, conic_layers_kind kind) {
  return conic_layers_schema_find(&layers->header.schema, kind) >= 0;
}

static int splats_have_colors(const conic_layers *layers) {
  return splats_have(layers, CONIC_LAYERS_COLOR) || layers->choice.colored_by >= 0;
}

size_t conic_layers_set_arrays(const conic_layers *layers) {
  return 9u + (splats_have_colors(layers) ? 3u : 0u) + (splats_have(layers, CONIC_LAYERS_OPACITY) ? 1u : 0u) +
         (splats_have(layers, CONIC_LAYERS_DOT) ? 1u : 0u);
}

/* Points the splats' arrays into the block. */
static void place_arrays(const conic_layers *layers, conic_layers_set *set) {
  float *next = set->arrays;
  float **all[] = {set->splats.position, set->splats.tangent_u, set->splats.tangent_v, set->splats.color};
  for (size_t i = 0; i < (splats_have_colors(layers) ? 12 : 9); i++, next += set->room)
    all[i / 3][i % 3] = next;
  if (splats_have(layers, CONIC_LAYERS_OPACITY)) {
    set->splats.opacity = next;
    next += set->room;
  }
  if (splats_have(layers, CONIC_LAYERS_DOT))
    set->splats.dot = next;
}

/* The values that are handed on, as columns of the file's names. */
static conic_status name_values(const conic_layers *layers, conic_layers_set *set) {
  const conic_layers_choice *choice = &layers->choice;
  conic_point_values_destroy(layers->context, set->named);
  set->splats.values = set->named = NULL;
  if (choice->n_kept == 0)
    return CONIC_OK;
  set->named = conic_memory_allocate_zeroed(layers->context, 1, sizeof *set->named);
  if (!set->named)
    return CONIC_ERROR_MEMORY;
  set->named->n = set->named->n_columns = choice->n_kept;
  for (uint32_t k = 0; k < choice->n_kept; k++) {
    const conic_layers_attribute *value = &layers->header.schema.list[choice->kept[k]];
    memcpy(set->named->field[k].name, value->name, sizeof value->name);
    set->named->field[k].type = conic_layers_number_name(value->type);
  }
  set->splats.values = set->named;
  return conic_point_values_reserve(layers->context, set->named, set->room);
}

conic_status conic_layers_set_begin(const conic_layers *layers, conic_layers_set *set) {
  set->splats.count = set->splats.n_clips = 0;
  set->n_pieces = 0;
  set->n_chosen = set->n_turned = 0;
  set->is_cut_short = 0;
  memcpy(set->splats.origin, layers->header.origin, sizeof set->splats.origin);
  return (set->named ? set->named->n : 0) != layers->choice.n_kept ? name_values(layers, set) : CONIC_OK;
}

conic_status conic_layers_set_reserve(const conic_layers *layers, conic_layers_set *set, size_t used, size_t count) {
  conic_context *context = layers->context;
  if (count <= set->room)
    return CONIC_OK;
  size_t room = (count + 15) / 16 * 16;
  if (!used) { /* so that there are never both */
    conic_memory_release(context, set->arrays);
    set->arrays = NULL;
    set->room = 0;
  }
  float *arrays = conic_memory_allocate(context, room * conic_layers_set_arrays(layers), sizeof *arrays);
  if (!arrays)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < conic_layers_set_arrays(layers) && used; i++)
    memcpy(arrays + i * room, set->arrays + i * set->room, used * sizeof *arrays);
  conic_memory_release(context, set->arrays);
  set->arrays = arrays;
  conic_status status = conic_memory_grow(context, &set->ids, used, room, sizeof *set->ids);
  if (status == CONIC_OK && splats_have(layers, CONIC_LAYERS_CLIP))
    status = conic_memory_grow(context, &set->lines, used, room, sizeof *set->lines);
  if (status == CONIC_OK && set->named)
    status = conic_point_values_reserve(context, set->named, room);
  if (status != CONIC_OK)
    set->room = 0; /* nothing is kept of it */
  else
    set->room = room;
  place_arrays(layers, set);
  return status;
}

conic_status conic_layers_set_list_lines(const conic_layers *layers, conic_layers_set *set) {
  conic_splats *splats = &set->splats;
  size_t n = 0;
  splats->n_clips = 0;
  for (size_t i = 0; i < splats->count && set->lines; i++)
    n += set->lines[i].kind > 0;
  if (n > set->clips_room) {
    set->clips_room = 0;
    if (conic_memory_grow(layers->context, &splats->clips, 0, n, sizeof *splats->clips) != CONIC_OK)
      return CONIC_ERROR_MEMORY;
    set->clips_room = n;
  }
  for (size_t i = 0; i < splats->count && n; i++) {
    conic_clip *clip = &splats->clips[splats->n_clips];
    if (set->lines[i].kind == 0)
      continue;
    conic_layers_lines_of(&set->lines[i], clip);
    clip->splat = (uint32_t)i;
    splats->n_clips++;
  }
  return CONIC_OK;
}
