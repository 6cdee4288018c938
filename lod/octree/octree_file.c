/* .cot files: docs/reference/format-cot.md. */

#include "core/files/file_body.h"
#include "lod/octree/octree_nodes.h"

enum { VERSION = 1 };

enum { FLAG_QUANTIZED = 1, FLAG_COLOR_CODES = 2, FLAG_COLORS = 4, FLAG_OPACITIES = 8, FLAG_DOTS = 16, ALL_FLAGS = 31 };

/* The records of clip lines are in the file as they are in memory. */
_Static_assert(sizeof(conic_clip) == 32, "clip records of 32 bytes");

#define FIELD(member) CONIC_FILE_FIELD(conic_octree, member)

static const conic_file_field fields[] = {
    FIELD(version),       FIELD(flags),        FIELD(n_points),       FIELD(n_leaves), FIELD(n_nodes),
    FIELD(leaves.origin), FIELD(low),          FIELD(high),           FIELD(cutoff),   FIELD(scale.color),
    FIELD(scale.length),  FIELD(splat_length), FIELD(position_error), FIELD(n_clips),  FIELD(body_sum)};

static const char *fault_of_header(const void *numbers) {
  const conic_octree *h = numbers;
  if (h->flags & ~(uint32_t)ALL_FLAGS || ((h->flags & FLAG_COLOR_CODES) && !(h->flags & FLAG_COLORS)))
    return "unknown flags";
  if (h->n_points > UINT32_MAX / 2 || h->n_leaves < 1 || h->n_leaves > h->n_points || h->n_nodes >= h->n_leaves)
    return "counts that do not go together";
  if (h->n_clips > h->n_points)
    return "more clip lines than points";
  if ((h->flags & FLAG_QUANTIZED) && h->n_points / (CONIC_OCTREE_MOST_LEFT_OUT + 1) > h->n_leaves)
    return "counts that do not go together";
  if (!(h->cutoff >= 0.25f && h->cutoff <= 5.0f) || !(h->scale.color >= 1.0f && h->scale.color <= 1e18f))
    return "a cutoff or colour scale out of range";
  if (!(h->scale.length > 1e-60 && h->scale.length < 1e60) || !(h->splat_length >= 0.0 && h->splat_length < 1e30) ||
      !(h->position_error >= 0.0 && h->position_error < 1e30))
    return "a length out of range";
  for (int axis = 0; axis < 3; axis++)
    if (!conic_is_finite(h->leaves.origin[axis]) || !(h->low[axis] <= h->high[axis]) ||
        !conic_is_finite((double)h->low[axis]) || !conic_is_finite((double)h->high[axis]))
      return "a box that is none";
  return NULL;
}

static const conic_file_kind kind = {{'C', 'O', 'N', 'I', 'C', 'O', 'T', '\n'},
                                     ".cot",
                                     VERSION,
                                     fields,
                                     sizeof fields / sizeof *fields,
                                     fault_of_header};

/* Which array is which. */
enum { ARRAY_CODES = 0, ARRAY_INDEX = 1, ARRAY_LEAVES = 2 };

/* A bit for each leaf in the file. */
static size_t dot_bytes(const conic_octree *h) {
  return ((size_t)(h->flags & FLAG_QUANTIZED ? h->n_leaves : h->n_points) + 7) / 8;
}

/* Where everything is follows from the header alone; its counts are below 2³¹. */
static conic_file_layout lay_out_file(const conic_octree *h) {
  conic_file_layout l = {.n_bytes = CONIC_FILE_HEADER_BYTES};
  int is_quantized = (h->flags & FLAG_QUANTIZED) != 0, has_codes = (h->flags & FLAG_COLOR_CODES) != 0;
  conic_file_add_array(&l, (size_t)h->n_nodes * CONIC_NODE_BYTES, "1");
  conic_file_add_array(&l, (size_t)(is_quantized ? h->n_leaves : h->n_points) * sizeof(uint32_t), "4");
  if (is_quantized) {
    conic_file_add_array(
        &l,
        conic_leaf_codes_bytes((size_t)h->n_leaves, (h->flags & FLAG_COLORS) != 0, (h->flags & FLAG_OPACITIES) != 0),
        "1");
  } else {
    size_t n_points = (size_t)h->n_points;
    for (int i = 0; i < 9; i++)
      conic_file_add_array(&l, n_points * sizeof(float), "4");
    for (int i = 0; i < 3 && (h->flags & FLAG_COLORS); i++)
      conic_file_add_array(&l, n_points * (has_codes ? 1 : sizeof(float)), has_codes ? "1" : "4");
    if (h->flags & FLAG_OPACITIES)
      conic_file_add_array(&l, n_points * sizeof(float), "4");
  }
  if (h->flags & FLAG_DOTS)
    conic_file_add_array(&l, dot_bytes(h), "1");
  if (h->n_clips)
    conic_file_add_array(&l, (size_t)h->n_clips * sizeof(conic_clip), "422444444");
  return l;
}

/* Fills in what the file says of it beside its own numbers. */
static void describe_octree(conic_octree *octree) {
  const conic_splats *leaves = &octree->leaves;
  octree->version = VERSION;
  octree->flags = (octree->is_quantized ? FLAG_QUANTIZED : 0u) | (octree->has_color_codes ? FLAG_COLOR_CODES : 0u) |
                  (leaves->color[0] ? FLAG_COLORS : 0u) | (leaves->opacity ? FLAG_OPACITIES : 0u) |
                  (leaves->dot ? FLAG_DOTS : 0u);
  octree->cutoff = (float)octree->scale.cutoff;
}

uint64_t conic_octree_file_bytes(const conic_octree *octree) {
  conic_octree described = *octree;
  describe_octree(&described);
  return lay_out_file(&described).n_bytes;
}

/* What is done with the colours a chunk of leaves at a time. */
enum { COLOR_CHUNK = 65536 };
typedef struct color_coding {
  const conic_octree *octree;
  unsigned char **codes;
  uint8_t *are_codes; /* by chunk; null where they are to be written */
} color_coding;

static size_t count_color_chunks(const conic_octree *octree) {
  return (octree->leaves.count + COLOR_CHUNK - 1) / COLOR_CHUNK;
}

static void code_colors(void *data, size_t i_chunk) {
  const color_coding *c = data;
  const conic_code_scale *scale = &c->octree->scale;
  const conic_splats *leaves = &c->octree->leaves;
  size_t begin = i_chunk * COLOR_CHUNK, end = begin + COLOR_CHUNK < leaves->count ? begin + COLOR_CHUNK : leaves->count;
  int are_codes = 1;
  for (int channel = 0; channel < 3; channel++)
    for (size_t i = begin; i < end && are_codes; i++) {
      float value = leaves->color[channel][i];
      uint8_t code = conic_code_srgb(scale, value);
      if (c->are_codes)
        are_codes = scale->colors[code] == value;
      else
        c->codes[channel][i] = code;
    }
  if (c->are_codes)
    c->are_codes[i_chunk] = (uint8_t)are_codes;
}

conic_status conic_octree_check_colors(conic_octree *octree) {
  size_t n_chunks = count_color_chunks(octree);
  octree->has_color_codes = octree->leaves.color[0] != NULL;
  if (!octree->has_color_codes)
    return CONIC_OK;
  color_coding c = {.octree = octree, .are_codes = conic_memory_allocate(octree->context, n_chunks, 1)};
  if (!c.are_codes)
    return CONIC_ERROR_MEMORY;
  conic_parallel_for(octree->context, n_chunks, code_colors, &c);
  for (size_t i = 0; i < n_chunks; i++)
    octree->has_color_codes &= c.are_codes[i];
  conic_memory_release(octree->context, c.are_codes);
  return CONIC_OK;
}

/* What is made into bytes for the file; null where the octree has none of it. */
typedef struct file_codes {
  unsigned char *color[3], *dots;
} file_codes;

/* Fills in the arrays of the leaves of a file that is not quantised. Returns how many there are. */
static int list_leaf_sources(const conic_octree *octree, const file_codes *codes, const void **sources) {
  const conic_splats *leaves = &octree->leaves;
  int n = 9;
  for (int axis = 0; axis < 3; axis++) {
    sources[axis] = leaves->position[axis];
    sources[3 + axis] = leaves->tangent_u[axis];
    sources[6 + axis] = leaves->tangent_v[axis];
  }
  for (int channel = 0; channel < 3 && leaves->color[0]; channel++)
    sources[n++] = octree->has_color_codes ? (const void *)codes->color[channel] : leaves->color[channel];
  if (leaves->opacity)
    sources[n++] = leaves->opacity;
  return n;
}

/* What the arrays are filled from. */
static void list_sources(const conic_octree *octree, const file_codes *codes,
                         const void *sources[CONIC_FILE_MOST_ARRAYS]) {
  int n = 0;
  sources[n++] = octree->codes;
  sources[n++] = octree->index;
  if (octree->is_quantized)
    sources[n++] = octree->leaf_codes;
  else
    n += list_leaf_sources(octree, codes, sources + n);
  if (codes->dots)
    sources[n++] = codes->dots;
  sources[n] = octree->clips;
}

static conic_status encode_dots(const conic_octree *octree, unsigned char **bits) {
  const float *dot = octree->leaves.dot;
  if (!dot)
    return CONIC_OK;
  *bits = conic_memory_allocate_zeroed(octree->context, dot_bytes(octree), 1);
  for (size_t i = 0; *bits && i < octree->leaves.count; i++)
    (*bits)[i / 8] |= (unsigned char)((dot[i] != 0.0f) << i % 8);
  return *bits ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status encode_colors(const conic_octree *octree, unsigned char *codes[3]) {
  for (int channel = 0; channel < 3 && octree->has_color_codes && !octree->is_quantized; channel++) {
    codes[channel] = conic_memory_allocate(octree->context, octree->n_points, 1);
    if (!codes[channel])
      return CONIC_ERROR_MEMORY;
  }
  color_coding c = {.octree = octree, .codes = codes};
  if (codes[0])
    conic_parallel_for(octree->context, count_color_chunks(octree), code_colors, &c);
  return CONIC_OK;
}

conic_status conic_octree_write(conic_octree *octree, const char *path) {
  const void *sources[CONIC_FILE_MOST_ARRAYS];
  file_codes codes = {.dots = NULL};
  describe_octree(octree);
  conic_status status = encode_colors(octree, codes.color);
  if (status == CONIC_OK)
    status = encode_dots(octree, &codes.dots);
  if (status == CONIC_OK) {
    conic_file_layout l = lay_out_file(octree);
    list_sources(octree, &codes, sources);
    octree->body_sum = conic_file_sum_arrays(octree->context, &l, sources);
    status = conic_file_write_arrays(octree->context, path, &kind, octree, &l, sources);
  }
  conic_memory_release_these(octree->context, codes.color[0], codes.color[1], codes.color[2], codes.dots);
  return status;
}

void conic_octree_mend(unsigned char *bytes, size_t n_bytes) {
  conic_octree h;
  conic_file_layout l = {0};
  memset(&h, 0, sizeof h);
  conic_file_fields_read(fields, kind.n_fields, bytes + sizeof kind.magic, &h);
  if (h.n_points <= UINT32_MAX / 2 && h.n_leaves <= h.n_points && h.n_nodes <= h.n_leaves && h.n_clips <= h.n_points)
    l = lay_out_file(&h);
  int is_whole = l.n > 0 && l.n_bytes == n_bytes;
  if (is_whole)
    h.body_sum = conic_file_sum_bytes(NULL, &l, bytes);
  conic_file_mend_header(&kind, is_whole ? &h : NULL, bytes);
}

static void *array_in_file(const conic_octree *octree, const conic_file_layout *l, int i) {
  return octree->mapping.bytes + l->arrays[i].offset;
}

/* Colours that are kept as codes become floats. */
static conic_status decode_colors(conic_octree *octree, const conic_file_layout *l) {
  for (int channel = 0; channel < 3; channel++) {
    const unsigned char *codes = array_in_file(octree, l, ARRAY_LEAVES + 9 + channel);
    float *color = conic_memory_allocate(octree->context, octree->n_points, sizeof *color);
    if (!color)
      return CONIC_ERROR_MEMORY;
    octree->owned.color[channel] = octree->leaves.color[channel] = color;
    for (size_t i = 0; i < octree->n_points; i++)
      color[i] = octree->scale.colors[codes[i]];
  }
  return CONIC_OK;
}

static conic_status read_quantized(conic_octree *octree, const conic_file_layout *l) {
  unsigned optional = (octree->flags & FLAG_COLORS ? (unsigned)CONIC_SPLATS_COLORS : 0u) |
                      (octree->flags & FLAG_OPACITIES ? (unsigned)CONIC_SPLATS_OPACITIES : 0u);
  conic_status status =
      conic_splats_allocate(octree->context, octree->n_leaves, CONIC_SPLATS_TANGENTS | optional, &octree->owned);
  if (status != CONIC_OK)
    return status;
  memcpy(octree->owned.origin, octree->leaves.origin, sizeof octree->owned.origin);
  octree->leaves = octree->owned;
  octree->leaf_codes = array_in_file(octree, l, ARRAY_LEAVES);
  conic_leaf_decode(octree->context, &octree->scale, octree->leaf_codes, &octree->leaves);
  return CONIC_OK;
}

static conic_status read_leaves(conic_octree *octree, const conic_file_layout *l) {
  conic_splats *leaves = &octree->leaves;
  int next = ARRAY_LEAVES + 9;
  if (octree->n_clips) /* the last of all */
    octree->clips = array_in_file(octree, l, l->n - 1);
  if (octree->is_quantized)
    return read_quantized(octree, l);
  leaves->count = octree->n_points;
  for (int axis = 0; axis < 3; axis++) {
    leaves->position[axis] = array_in_file(octree, l, ARRAY_LEAVES + axis);
    leaves->tangent_u[axis] = array_in_file(octree, l, ARRAY_LEAVES + 3 + axis);
    leaves->tangent_v[axis] = array_in_file(octree, l, ARRAY_LEAVES + 6 + axis);
  }
  if (octree->flags & FLAG_COLORS) {
    conic_status status = octree->has_color_codes ? decode_colors(octree, l) : CONIC_OK;
    for (int channel = 0; channel < 3 && !octree->has_color_codes; channel++)
      leaves->color[channel] = array_in_file(octree, l, next + channel);
    if (status != CONIC_OK)
      return status;
    next += 3;
  }
  if (octree->flags & FLAG_OPACITIES)
    leaves->opacity = array_in_file(octree, l, next++);
  return CONIC_OK;
}

/* Which leaves are dots, where any is. */
static conic_status read_dots(conic_octree *octree, const char *path, const conic_file_layout *l) {
  conic_splats *leaves = &octree->leaves;
  if (!(octree->flags & FLAG_DOTS))
    return CONIC_OK;
  const int at = l->n - (octree->n_clips ? 2 : 1);
  const unsigned char *bits = array_in_file(octree, l, at);
  size_t n = leaves->count;
  leaves->dot = octree->owned.dot = conic_memory_allocate(octree->context, n, sizeof *leaves->dot);
  if (!leaves->dot)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    leaves->dot[i] = bits[i / 8] >> i % 8 & 1 ? 1.0f : 0.0f;
  return n % 8 && bits[n / 8] >> n % 8
             ? conic_fail(octree->context, CONIC_ERROR_INPUT, "%s: more dots than leaves (at byte %zu)", path,
                          l->arrays[at].offset)
             : CONIC_OK;
}

/* Every leaf is a splat of its own in the input. */
static conic_status check_index(const conic_octree *octree, const char *path, const conic_file_layout *l) {
  conic_status status = CONIC_OK;
  unsigned char *is_taken = conic_memory_allocate_zeroed(octree->context, octree->n_points, 1);
  if (!is_taken)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < octree->leaves.count && status == CONIC_OK; i++) {
    size_t index = octree->index[i];
    if (index >= octree->n_points || is_taken[index])
      status = conic_fail(octree->context, CONIC_ERROR_INPUT, "%s: an index out of range, or twice (at byte %zu)", path,
                          l->arrays[ARRAY_INDEX].offset + 4 * i);
    else
      is_taken[index] = 1;
  }
  conic_memory_release(octree->context, is_taken);
  return status;
}

/* Records in order, each of a point, with lines. */
static conic_status check_clips(const conic_octree *octree, const char *path) {
  for (size_t i = 0; i < octree->n_clips; i++) {
    const conic_clip *clip = &octree->clips[i];
    if (clip->splat >= octree->n_points || (i > 0 && clip->splat <= clip[-1].splat) || clip->n_lines < 1 ||
        clip->n_lines > 2 || clip->operation > CONIC_CLIP_OR)
      return conic_fail(octree->context, CONIC_ERROR_INPUT, "%s: clip lines out of order or range (at byte %zu)", path,
                        (size_t)((const unsigned char *)clip - octree->mapping.bytes));
  }
  return CONIC_OK;
}

static conic_status read_structure(conic_octree *octree, const char *path, const conic_file_layout *l) {
  const char *wrong;
  conic_status status = conic_octree_lay_out(octree, &wrong);
  if (wrong)
    return conic_fail(octree->context, CONIC_ERROR_INPUT, "%s: the tree has %s (at byte %zu)", path, wrong,
                      l->arrays[ARRAY_CODES].offset);
  if (status == CONIC_OK)
    status = check_index(octree, path, l);
  if (status == CONIC_OK)
    status = check_clips(octree, path);
  return status == CONIC_OK ? conic_octree_index_clips(octree) : status;
}

static conic_status read_octree_file(conic_octree *octree, const char *path) {
  conic_status status = conic_file_open_kind(octree->context, path, &kind, &octree->mapping, octree);
  if (status != CONIC_OK)
    return status;
  conic_file_layout l = lay_out_file(octree);
  status = conic_file_take_arrays(octree->context, path, &octree->mapping, &l, octree->body_sum);
  if (status != CONIC_OK)
    return status;
  octree->is_quantized = (octree->flags & FLAG_QUANTIZED) != 0;
  octree->has_color_codes = (octree->flags & FLAG_COLOR_CODES) != 0;
  conic_code_scale_init(octree->scale.length, (double)octree->cutoff, octree->scale.color, &octree->scale);
  octree->codes = array_in_file(octree, &l, ARRAY_CODES);
  octree->index = array_in_file(octree, &l, ARRAY_INDEX);
  status = read_leaves(octree, &l);
  if (status == CONIC_OK)
    status = read_dots(octree, path, &l);
  return status == CONIC_OK ? read_structure(octree, path, &l) : status;
}

conic_status conic_octree_read(conic_context *context, const char *path, conic_octree **octree) {
  *octree = NULL;
  conic_octree *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  conic_status status = read_octree_file(made, path);
  if (status == CONIC_OK)
    *octree = made;
  else
    conic_octree_destroy(made);
  return status;
}

int conic_octree_is_file(const char *path) {
  return conic_file_is_of_kind(&kind, path);
}
