#include "lod/layers/format/layers_format.h"

#include "conic/layers.h"
#include "core/base/byte_order.h"
#include "core/files/file.h"
#include "core/files/file_body.h"

static const unsigned char magic[8] = {'C', 'O', 'N', 'I', 'C', 'L', 'P', '\n'};

enum { AT_HEADER_SUM = CONIC_LAYERS_HEADER_BYTES - 8 };

/* No coordinate and no length is larger, so that nothing derived of them overflows. */
static const double farthest = 1e15;

#define IN_HEADER(member) CONIC_FILE_FIELD(conic_layers_header, member)
#define IN_ENTRY(member) CONIC_FILE_FIELD(conic_layers_entry, member)

static const conic_file_field header_fields[] = {
    IN_HEADER(version),      IN_HEADER(flags),        IN_HEADER(n_samples),
    IN_HEADER(n_clouds),     IN_HEADER(n_levels),     IN_HEADER(bits),
    IN_HEADER(cloud_size),   IN_HEADER(origin),       IN_HEADER(quantum),
    IN_HEADER(low),          IN_HEADER(high),         IN_HEADER(spacing),
    IN_HEADER(splat_radius), IN_HEADER(near_z),       IN_HEADER(position_bytes),
    IN_HEADER(normal_bytes), IN_HEADER(color_bytes),  IN_HEADER(file_bytes),
    IN_HEADER(index_sum),    IN_HEADER(most_samples), IN_HEADER(most_bytes),
    IN_HEADER(schema.n),     IN_HEADER(up),           IN_HEADER(epsg)};

static const conic_file_field entry_fields[] = {
    IN_ENTRY(key),       IN_ENTRY(offset),  IN_ENTRY(sum),      IN_ENTRY(n_place), IN_ENTRY(n_bytes),
    IN_ENTRY(n_samples), IN_ENTRY(parent),  IN_ENTRY(child),    IN_ENTRY(n_drawn), IN_ENTRY(level),
    IN_ENTRY(depth),     IN_ENTRY(spacing), IN_ENTRY(covering), IN_ENTRY(radius),  IN_ENTRY(error),
    IN_ENTRY(center),    IN_ENTRY(sphere),  IN_ENTRY(axis),     IN_ENTRY(cone)};

/* What follows, before version 3 and from it on. */
static const conic_file_field growth_fields[] = {IN_ENTRY(growth), IN_ENTRY(reach)};
static const conic_file_field stand_in_fields[] = {IN_ENTRY(stand_in_sum),   IN_ENTRY(stand_in_bytes),
                                                   IN_ENTRY(stand_in_error), IN_ENTRY(stand_in_radius),
                                                   IN_ENTRY(n_stand_ins),    IN_ENTRY(stand_in_cone)};

#define IN_ATTRIBUTE(member) CONIC_FILE_FIELD(conic_layers_attribute, member)

static const conic_file_field attribute_fields[] = {IN_ATTRIBUTE(name),    IN_ATTRIBUTE(kind),  IN_ATTRIBUTE(n_streams),
                                                    IN_ATTRIBUTE(type),    IN_ATTRIBUTE(flags), IN_ATTRIBUTE(scale),
                                                    IN_ATTRIBUTE(offset),  IN_ATTRIBUTE(low),   IN_ATTRIBUTE(high),
                                                    IN_ATTRIBUTE(typical), IN_ATTRIBUTE(error), IN_ATTRIBUTE(n_bytes)};

enum {
  N_HEADER_FIELDS = sizeof header_fields / sizeof *header_fields,
  N_ENTRY_FIELDS = sizeof entry_fields / sizeof *entry_fields,
  N_GROWTH_FIELDS = sizeof growth_fields / sizeof *growth_fields,
  N_STAND_IN_FIELDS = sizeof stand_in_fields / sizeof *stand_in_fields,
  N_ATTRIBUTE_FIELDS = sizeof attribute_fields / sizeof *attribute_fields
};

static size_t entry_bytes(const conic_layers_header *header) {
  return header->version < 3 ? CONIC_LAYERS_OLD_ENTRY_BYTES : CONIC_LAYERS_ENTRY_BYTES;
}

static int is_finite_within(double value, double limit) {
  return value >= -limit && value <= limit; /* false where it is not a number */
}

/* What is wrong with the counts, or null. Each is bounded so that no sum or product of them overflows. */
static const char *check_counts(const conic_layers_header *header) {
  uint64_t index_bytes = conic_layers_index_bytes(header);
  if (header->version == 1 ? header->schema.n != 0 : header->schema.n < 2)
    return "the number of attributes is out of range";
  if (header->schema.n > CONIC_LAYERS_MOST_ATTRIBUTES)
    return "more attributes than can be read";
  if (header->flags & ~(uint32_t)CONIC_LAYERS_ALL_FLAGS)
    return "unknown flags";
  if (header->n_clouds > UINT32_MAX / 2)
    return "more clouds than can be read";
  if (header->n_clouds == 0 || header->n_samples == 0)
    return "it holds no sample";
  if (header->n_levels == 0 || header->n_levels > CONIC_LAYERS_MOST_LEVELS)
    return "the number of levels is out of range";
  if (header->bits == 0 || header->bits > CONIC_LAYERS_MOST_BITS)
    return "the grid's bits are out of range";
  if (header->most_samples == 0 || header->most_samples > CONIC_LAYERS_MOST_SAMPLES)
    return "the largest cloud is too large";
  if (header->n_samples > (uint64_t)header->n_clouds * header->most_samples)
    return "so many samples are not in so many clouds";
  if (header->file_bytes < CONIC_LAYERS_HEADER_BYTES + index_bytes || header->file_bytes > (uint64_t)1 << 60)
    return "the size of the file is out of range";
  if (header->position_bytes > header->file_bytes || header->normal_bytes > header->file_bytes ||
      header->color_bytes > header->file_bytes)
    return "more compressed bytes than the file has";
  return NULL;
}

static const char *check_lengths(const conic_layers_header *header) {
  double edge = header->quantum * (double)(UINT64_C(1) << header->bits);
  for (int axis = 0; axis < 3; axis++)
    if (!is_finite_within(header->origin[axis], farthest) || !is_finite_within(header->low[axis], farthest) ||
        !is_finite_within(header->high[axis], farthest) || header->low[axis] > header->high[axis])
      return "the box is out of range";
  if (!(header->quantum > 0.0 && edge <= 4.0 * farthest))
    return "the quantum is out of range";
  if (header->epsg > UINT16_MAX)
    return "the code of its coordinate system is out of range";
  for (int axis = 0; axis < 3; axis++)
    if (!is_finite_within((double)header->up[axis], 1.001))
      return "what points up is no direction";
  if (!(header->spacing >= 0.0 && header->spacing <= farthest) ||
      !(header->splat_radius > 0.0 && header->splat_radius <= farthest) ||
      !(header->near_z > 0.0 && header->near_z <= farthest))
    return "a length is out of range";
  return NULL;
}

static int is_zero(const unsigned char *bytes, size_t n) {
  for (size_t i = 0; i < n; i++)
    if (bytes[i])
      return 0;
  return 1;
}

int conic_layers_header_is_whole(const unsigned char *bytes) {
  return conic_load_64(bytes + AT_HEADER_SUM) == conic_checksum(bytes, AT_HEADER_SUM);
}

conic_status conic_layers_read_header(conic_context *context, const char *name, const unsigned char *bytes,
                                      size_t n_bytes, conic_layers_header *header) {
  size_t used = sizeof magic + conic_file_fields_bytes(header_fields, N_HEADER_FIELDS);
  if (n_bytes < sizeof magic || memcmp(bytes, magic, sizeof magic) != 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: no layered point cloud (at byte 0)", name);
  if (n_bytes < CONIC_LAYERS_HEADER_BYTES)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the file ends within the header (at byte %zu)", name, n_bytes);
  memset(header, 0, sizeof *header);
  conic_file_fields_read(header_fields, N_HEADER_FIELDS, bytes + sizeof magic, header);
  if (header->version == CONIC_LAYERS_VERSION + 1 || header->version == CONIC_LAYERS_VERSION + 2)
    return conic_fail(
        context, CONIC_ERROR_INPUT,
        "%s: a .lpc of Gaussians: conic render draws it by any --profile but surface, and conic info tells "
        "of it (at byte 8)",
        name);
  if (header->version == 0 || header->version > CONIC_LAYERS_VERSION)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: version %u of .lpc; this program reads 1 to %d (at byte 8)",
                      name, header->version, CONIC_LAYERS_VERSION);
  if (!conic_layers_header_is_whole(bytes))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the header is damaged: its sum is another (at byte %d)", name,
                      AT_HEADER_SUM);
  const char *wrong = check_counts(header);
  if (!wrong)
    wrong = check_lengths(header);
  if (!wrong && !is_zero(bytes + used, AT_HEADER_SUM - used))
    wrong = "bytes that should be zero are not";
  return wrong ? conic_fail(context, CONIC_ERROR_INPUT, "%s: the header is wrong: %s (at byte 0)", name, wrong)
               : CONIC_OK;
}

void conic_layers_write_header(const conic_layers_header *header, unsigned char bytes[CONIC_LAYERS_HEADER_BYTES]) {
  memset(bytes, 0, CONIC_LAYERS_HEADER_BYTES);
  memcpy(bytes, magic, sizeof magic);
  conic_file_fields_write(header_fields, N_HEADER_FIELDS, header, bytes + sizeof magic);
  conic_store_64(bytes + AT_HEADER_SUM, conic_checksum(bytes, AT_HEADER_SUM));
}

uint64_t conic_layers_index_bytes(const conic_layers_header *header) {
  return (uint64_t)header->schema.n * CONIC_LAYERS_ATTRIBUTE_BYTES + (uint64_t)header->n_clouds * entry_bytes(header);
}

int conic_layers_is_file(const char *path) {
  return conic_file_begins_with(path, magic, sizeof magic);
}

/* The numbers that one entry states, each by itself. */
static const char *check_entry(const conic_layers_header *header, const conic_layers_entry *entry) {
  const float lengths[] = {entry->spacing, entry->covering, entry->radius,         entry->error,          entry->sphere,
                           entry->growth,  entry->reach,    entry->stand_in_error, entry->stand_in_radius};
  uint64_t n_keys_bits = 3 * (uint64_t)header->bits;
  if (entry->depth > n_keys_bits || entry->level >= header->n_levels)
    return "its depth or level is out of range";
  uint64_t below = (UINT64_C(1) << (n_keys_bits - entry->depth)) - 1;
  if (entry->key >> n_keys_bits || (entry->key & below))
    return "its key has bits below its depth";
  if (entry->n_samples > header->most_samples || entry->n_bytes > header->most_bytes)
    return "it is larger than the largest";
  if (entry->n_place == 0 || entry->n_samples > entry->n_place || entry->n_drawn > entry->n_place ||
      entry->n_samples > entry->n_drawn)
    return "its counts contradict each other";
  if (entry->n_stand_ins > entry->n_place || entry->n_stand_ins > header->most_samples ||
      entry->stand_in_bytes > header->most_bytes || !entry->n_stand_ins != !entry->stand_in_bytes)
    return "its stand-ins contradict each other";
  for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
    if (!(lengths[i] >= 0.0f && (double)lengths[i] <= 8.0 * farthest))
      return "a length is out of range";
  for (int axis = 0; axis < 3; axis++)
    if (!is_finite_within((double)entry->center[axis], 8.0 * farthest) ||
        !is_finite_within((double)entry->axis[axis], 1.001))
      return "its sphere or cone is out of range";
  if (!is_finite_within((double)entry->cone, 1.0) || entry->stand_in_cone > 2 * 32767)
    return "its cone is out of range";
  return NULL;
}

/* A node and its two children. */
static const char *check_children(const conic_layers_header *header, const conic_layers_entry *entries, uint32_t i) {
  const conic_layers_entry *entry = &entries[i];
  uint64_t n_place = 0, n_key_bits = 3 * (uint64_t)header->bits;
  if (entry->child == 0)
    return entry->n_drawn == entry->n_place ? NULL : "a leaf does not draw all of its place";
  if (entry->child <= i || entry->child >= header->n_clouds - 1)
    return "its children are not behind it";
  for (uint32_t k = entry->child; k <= entry->child + 1; k++) {
    const conic_layers_entry *child = &entries[k];
    int is_same_place = entry->depth == n_key_bits && child->depth == n_key_bits;
    if (child->parent != i || child->level != entry->level + 1)
      return "a child is not its own";
    if ((child->depth <= entry->depth && !is_same_place) ||
        (n_key_bits > entry->depth && (child->key ^ entry->key) >> (n_key_bits - entry->depth)))
      return "a child's place is not in its own";
    n_place += child->n_place;
  }
  return n_place == entry->n_place ? NULL : "its children hold other samples";
}

/* How entry i follows the one before it. */
static const char *check_order(const conic_layers_entry *entries, uint32_t i, uint64_t offset) {
  const conic_layers_entry *entry = &entries[i];
  if (entry->offset != offset)
    return "its bytes do not follow those of the cloud before";
  if (i == 0)
    return entry->level || entry->parent ? "the first is not the root" : NULL;
  const conic_layers_entry *before = entry - 1;
  if (entry->level < before->level || (entry->level == before->level && entry->key < before->key))
    return "it is out of order";
  const conic_layers_entry *parent = &entries[entry->parent < i ? entry->parent : 0];
  if (entry->parent >= i || parent->child == 0 || i - parent->child > 1)
    return "it is no child of its parent";
  return NULL;
}

static const char *check_tree(const conic_layers_header *header, const conic_layers_entry *entries, uint32_t *i) {
  uint64_t offset = CONIC_LAYERS_HEADER_BYTES + conic_layers_index_bytes(header), n_samples = 0;
  for (uint32_t k = 0; k < header->n_clouds; k++)
    offset += entries[k].stand_in_bytes;
  for (*i = 0; *i < header->n_clouds; ++*i) {
    const conic_layers_entry *entry = &entries[*i];
    const char *wrong = check_entry(header, entry);
    if (!wrong)
      wrong = check_order(entries, *i, offset);
    if (!wrong)
      wrong = check_children(header, entries, *i);
    if (wrong)
      return wrong;
    offset += entry->n_bytes;
    n_samples += entry->n_samples;
  }
  *i = header->n_clouds - 1;
  if (entries[*i].level + 1u != header->n_levels)
    return "the levels are not those of the header";
  if (n_samples != header->n_samples || entries[0].n_place != n_samples)
    return "the samples are not as many as the header says";
  return offset == header->file_bytes ? NULL : "the file should end elsewhere";
}

static conic_status read_attribute_table(conic_context *context, const char *name, conic_layers_header *header,
                                         const unsigned char *bytes) {
  conic_layers_schema *schema = &header->schema;
  for (uint32_t i = 0; i < schema->n; i++)
    conic_file_fields_read(attribute_fields, N_ATTRIBUTE_FIELDS, bytes + (size_t)i * CONIC_LAYERS_ATTRIBUTE_BYTES,
                           &schema->list[i]);
  if (header->version == 1) { /* positions, normals, and colours where there are some */
    conic_layers_schema_add(schema, CONIC_LAYERS_POSITION, "position", 0)->n_bytes = header->position_bytes;
    conic_layers_schema_add(schema, CONIC_LAYERS_NORMAL, "normal", 0)->n_bytes = header->normal_bytes;
    if (header->flags & CONIC_LAYERS_COLORS)
      conic_layers_schema_add(schema, CONIC_LAYERS_COLOR, "color", 0)->n_bytes = header->color_bytes;
  }
  const char *wrong = conic_layers_schema_lay_out(schema);
  int has_colors = conic_layers_schema_find(schema, CONIC_LAYERS_COLOR) >= 0;
  if (!wrong && has_colors != ((header->flags & CONIC_LAYERS_COLORS) != 0))
    wrong = "it has colours, or has none, other than the header says";
  return wrong ? conic_fail(context, CONIC_ERROR_INPUT, "%s: the table of attributes is wrong: %s (at byte %d)", name,
                            wrong, CONIC_LAYERS_HEADER_BYTES)
               : CONIC_OK;
}

/* An entry of version 1 has one outline for all samples, and of version 2 it states how they grow. */
static int read_entry(const conic_layers_header *header, const unsigned char *bytes, conic_layers_entry *entry) {
  size_t used = conic_file_fields_bytes(entry_fields, N_ENTRY_FIELDS);
  memset(entry, 0, sizeof *entry);
  conic_file_fields_read(entry_fields, N_ENTRY_FIELDS, bytes, entry);
  if (header->version == 2)
    conic_file_fields_read(growth_fields, N_GROWTH_FIELDS, bytes + used, entry);
  if (header->version >= 3) {
    conic_file_fields_read(stand_in_fields, N_STAND_IN_FIELDS, bytes + used, entry);
    entry->growth = entry->child ? 0.0f : 1.0f;
    entry->reach = entry->child ? entry->covering : 0.0f;
  }
  if (header->version > 1)
    return 1;
  entry->reach = entry->radius;
  return is_zero(bytes + used, CONIC_LAYERS_OLD_ENTRY_BYTES - used);
}

/* Makes the entries of stand-ins, whose bytes come before the clouds'. Their places were moved by less than a step. */
static void list_stand_ins(const conic_layers_header *header, conic_layers_entry *entries) {
  uint64_t offset = CONIC_LAYERS_HEADER_BYTES + conic_layers_index_bytes(header);
  for (uint32_t i = 0; i < header->n_clouds; i++) {
    const conic_layers_entry *entry = &entries[i];
    conic_layers_entry *to = &entries[header->n_clouds + i];
    float wider = entry->stand_in_radius > entry->radius ? entry->stand_in_radius - entry->radius : 0.0f;
    *to = *entry;
    to->offset = offset;
    to->sum = entry->stand_in_sum;
    to->n_bytes = entry->stand_in_bytes;
    to->n_samples = to->n_drawn = entry->n_stand_ins;
    to->child = to->n_stand_ins = 0;
    to->growth = 1.0f;
    to->reach = 0.0f;
    to->error = entry->stand_in_error;
    to->radius = entry->stand_in_radius;
    to->cone = (float)entry->stand_in_cone / 32767.0f - 1.0f;
    to->sphere = (entry->sphere + wider) * 1.000001f + (float)header->quantum;
    offset += to->n_bytes;
  }
}

conic_status conic_layers_read_index(conic_context *context, const char *name, conic_layers_header *header,
                                     const unsigned char *bytes, conic_layers_entry *entries) {
  size_t n_bytes = (size_t)conic_layers_index_bytes(header);
  size_t first = conic_layers_table_bytes(header);
  uint32_t at = 0;
  if (conic_checksum(bytes, n_bytes) != header->index_sum)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the index is damaged: its sum is another (at byte %d)", name,
                      CONIC_LAYERS_HEADER_BYTES);
  for (uint32_t i = 0; i < header->n_clouds; i++) {
    const unsigned char *from = bytes + first + i * entry_bytes(header);
    if (!read_entry(header, from, &entries[i]))
      return conic_fail(context, CONIC_ERROR_INPUT, "%s: cloud %u: bytes that should be zero are not (at byte %llu)",
                        name, i, (unsigned long long)(from - bytes) + CONIC_LAYERS_HEADER_BYTES);
  }
  const char *wrong = check_tree(header, entries, &at);
  if (wrong)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cloud %u: %s (at byte %llu)", name, at, wrong,
                      (unsigned long long)at * entry_bytes(header) + CONIC_LAYERS_HEADER_BYTES + first);
  if (header->version >= 3)
    list_stand_ins(header, entries);
  return read_attribute_table(context, name, header, bytes);
}

size_t conic_layers_table_bytes(const conic_layers_header *header) {
  return (size_t)header->schema.n * CONIC_LAYERS_ATTRIBUTE_BYTES;
}

void conic_layers_write_table(const conic_layers_header *header, unsigned char *bytes) {
  for (uint32_t i = 0; i < header->schema.n; i++)
    conic_file_fields_write(attribute_fields, N_ATTRIBUTE_FIELDS, &header->schema.list[i],
                            bytes + (size_t)i * CONIC_LAYERS_ATTRIBUTE_BYTES);
}

void conic_layers_write_entries(const conic_layers_entry *entries, size_t n, unsigned char *bytes) {
  const size_t used = conic_file_fields_bytes(entry_fields, N_ENTRY_FIELDS);
  for (size_t i = 0; i < n; i++, bytes += CONIC_LAYERS_ENTRY_BYTES) {
    conic_file_fields_write(entry_fields, N_ENTRY_FIELDS, &entries[i], bytes);
    conic_file_fields_write(stand_in_fields, N_STAND_IN_FIELDS, &entries[i], bytes + used);
  }
}

double conic_layers_position_error(const conic_layers_header *header) {
  return header->quantum * 0.8660254037844387 + header->quantum * (double)(UINT64_C(1) << header->bits) * 0x1p-22;
}
