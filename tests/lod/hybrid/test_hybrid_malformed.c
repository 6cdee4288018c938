/* .chy files that are wrong in one place, their sums made right again: each is refused with the one message that says
 * what is wrong; what only contradicts itself is read, and found by the check. */
#include <stddef.h>

#include "core/base/byte_order.h"
#include "lod/hybrid/model/hybrid_chunks.h"
#include "lod/hybrid/model/hybrid_layout.h"
#include "tests/support/files.h"
#include "tests/support/hybrid_fixture.h"
#include "tests/support/mend.h"

/* A sound file, and where its arrays lie. */
typedef struct sound_file {
  unsigned char *bytes;
  size_t n_bytes;
  size_t nodes, clusters, levels, material_list;
  size_t corners, materials, corners_at; /* of the first level, and where its chunk lies */
  size_t frame, frame_at, ends, n_slots; /* of the first cluster with borders; which is: */
  size_t framed;
  size_t n_triangles, n_surfels, n_levels, n_clusters, n_nodes, n_materials, n_texels;
} sound_file;

enum { SIDE = 24 };

/* A small terrain of two materials, one with a picture, as OBJ, MTL and PFM. */
static void write_mesh(conic_context *context, const char *path) {
  conic_triangles mesh;
  conic_image image;
  FILE *file = fopen(path, "w");
  if (!file)
    exit(1);
  hybrid_terrain(context, SIDE, &mesh);
  fputs("mtllib mesh.mtl\n", file);
  for (size_t i = 0; i < mesh.n_vertices; i++) {
    double x = (double)mesh.position[0][i], y = (double)mesh.position[1][i], z = (double)mesh.position[2][i];
    fprintf(file, "v %.6f %.6f %.6f\nvt %.6f %.6f\n", x, y, z, x, z);
  }
  for (size_t i = 0; i < mesh.count; i++) {
    const uint32_t *c = mesh.corners[i];
    if (i == 0 || i == mesh.count / 2)
      fprintf(file, "usemtl %s\n", i ? "plain" : "picture");
    fprintf(file, "f %u/%u %u/%u %u/%u\n", c[0] + 1, c[0] + 1, c[1] + 1, c[1] + 1, c[2] + 1, c[2] + 1);
  }
  CHECK(fclose(file) == 0);
  conic_triangles_release(context, &mesh);
  files_write("mesh.mtl", "newmtl picture\nmap_Kd mesh.pfm\nnewmtl plain\nKd 0.5 0.5 1\n");
  CHECK_OK(conic_image_allocate(context, 4, 3, 1u << CONIC_PLANE_RGBA, &image));
  for (int i = 0; i < 48; i++)
    ((float *)image.planes[CONIC_PLANE_RGBA])[i] = i % 4 == 3 ? 1.0f : 0.02f * (float)i;
  CHECK_OK(conic_image_write(context, files_path("mesh.pfm"), &image));
  conic_image_release(context, &image);
}

static size_t offset_of(const conic_hybrid *hybrid, const void *array) {
  return (size_t)((const unsigned char *)array - (const unsigned char *)hybrid->mapping.bytes);
}

static void find_arrays(const conic_hybrid *h, const char *path, sound_file *sound) {
  *sound = (sound_file){.n_bytes = (size_t)conic_hybrid_file_bytes(h),
                        .nodes = offset_of(h, h->nodes),
                        .clusters = offset_of(h, h->clusters),
                        .levels = offset_of(h, h->levels),
                        .corners_at = offset_of(h, conic_hybrid_chunk(h, 0)),
                        .material_list = offset_of(h, h->material_list),
                        .n_triangles = h->n_triangles,
                        .n_surfels = h->n_surfels,
                        .n_levels = h->n_levels,
                        .n_clusters = h->n_clusters,
                        .n_nodes = h->n_nodes,
                        .n_materials = h->n_materials,
                        .n_texels = h->n_texels};
  conic_hybrid_piece piece = conic_hybrid_piece_of(h, 0);
  sound->corners = offset_of(h, piece.narrow);
  sound->materials = offset_of(h, piece.material);
  while (sound->framed < h->n_clusters && (h->clusters[sound->framed].n_levels < 2 ||
                                           h->levels[h->clusters[sound->framed].first_level + 1].n_borders < 2))
    sound->framed++; /* two borders of a level, so that they can run over each other */
  CHECK(piece.narrow && piece.material && sound->framed < h->n_clusters);
  uint32_t framed = (uint32_t)sound->framed;
  sound->n_slots = h->clusters[framed].n_slots;
  sound->frame_at = offset_of(h, conic_hybrid_chunk(h, conic_hybrid_frame_chunk(h, framed)));
  sound->frame = offset_of(h, conic_hybrid_frame_of(h, framed).borders);
  sound->ends = offset_of(h, conic_hybrid_ends_of(h, framed).position[0]);
  sound->bytes = malloc(sound->n_bytes);
  if (!sound->bytes)
    exit(1);
  FILE *file = fopen(path, "rb");
  CHECK(file && fread(sound->bytes, 1, sound->n_bytes, file) == sound->n_bytes);
  if (file)
    fclose(file);
}

static sound_file make_sound(conic_context *context) {
  const char *path = files_path("mesh.obj"), *made = files_path("mesh.chy");
  sound_file sound;
  conic_triangles mesh;
  conic_hybrid_options options;
  conic_hybrid *hybrid;
  write_mesh(context, path);
  conic_hybrid_options_init(&options);
  options.most_area = 0.02;
  CHECK_OK(conic_triangles_read(context, path, &mesh));
  CHECK_OK(conic_hybrid_build(context, &mesh, &options, &hybrid, NULL));
  CHECK_OK(conic_hybrid_write(hybrid, made));
  conic_hybrid_destroy(hybrid);
  CHECK_OK(conic_hybrid_read(context, made, &hybrid));
  CHECK(hybrid->n_nodes >= 3 && hybrid->n_materials == 3 && hybrid->n_texels == 12);
  CHECK(hybrid->clusters[0].n_levels >= 2 && hybrid->n_surfels > 0);
  find_arrays(hybrid, made, &sound);
  conic_hybrid_destroy(hybrid);
  CHECK(unlink(made) == 0 && unlink(path) == 0);
  CHECK(unlink(files_path("mesh.mtl")) == 0 && unlink(files_path("mesh.pfm")) == 0);
  return sound;
}

/* Reads what is in `bytes`, which must be refused with just this message after the file's name. */
static void check_message(conic_context *context, const void *bytes, size_t n_bytes, const char *wanted) {
  char whole[512];
  conic_hybrid *hybrid;
  const char *path = files_write_bytes("bad.chy", bytes, n_bytes);
  snprintf(whole, sizeof whole, "%s: %s", path, wanted);
  files_message[0] = 0;
  conic_status status = conic_hybrid_read(context, path, &hybrid);
  if (status != CONIC_ERROR_INPUT || hybrid || strcmp(files_message, whole) != 0) {
    fprintf(stderr, "status %d, '%s' in place of '%s'\n", (int)status, files_message, whole);
    check_failures++;
  }
  conic_hybrid_destroy(hybrid);
  CHECK(unlink(path) == 0);
}

/* The sound file with other bytes in one place. */
static void check_edit(conic_context *context, const sound_file *sound, size_t at, const void *value, size_t n,
                       int mends, const char *wanted) {
  unsigned char *bytes = malloc(sound->n_bytes);
  if (!bytes)
    exit(1);
  memcpy(bytes, sound->bytes, sound->n_bytes);
  CHECK(at + n <= sound->n_bytes && memcmp(bytes + at, value, n) != 0);
  memcpy(bytes + at, value, n);
  if (mends)
    mend_hybrid(bytes, sound->n_bytes);
  check_message(context, bytes, sound->n_bytes, wanted);
  free(bytes);
}

static void check_u32(conic_context *context, const sound_file *sound, size_t at, size_t value, const char *wrong) {
  char wanted[200];
  unsigned char bits[4];
  conic_store_32(bits, (uint32_t)value);
  snprintf(wanted, sizeof wanted, "has %s (at byte %d)", wrong, CONIC_FILE_HEADER_BYTES);
  check_edit(context, sound, at, bits, sizeof bits, 1, wanted);
}

/* In a chunk, of which the message tells where it is. */
static void check_chunk(conic_context *context, const sound_file *sound, size_t chunk, size_t at, size_t value,
                        size_t n_bytes, const char *wrong) {
  char wanted[200];
  unsigned char bits[4];
  conic_store_32(bits, (uint32_t)value);
  snprintf(wanted, sizeof wanted, "has %s (at byte %zu)", wrong, chunk);
  check_edit(context, sound, at, bits, n_bytes, 1, wanted);
}

static void check_f32(conic_context *context, const sound_file *sound, size_t at, float value, const char *wrong) {
  check_u32(context, sound, at, conic_bits_of_float(value), wrong);
}

/* Where things are in the header: docs/reference/format-chy.md. */
enum {
  VERSION = 8,
  FLAGS = 12,
  COUNTS = 16,
  ORIGIN = 88,
  LOW = 112,
  HIGH = 124,
  LENGTH = 136,
  CUTOFF = 144,
  ZERO = 148
};
enum { VERTICES, TRIANGLES, SURFELS, LEVELS, CLUSTERS, NODES, MATERIALS, TEXELS, DATA };

static void test_header(conic_context *context, const sound_file *sound) {
  static const char counts[] = "the header has counts that do not go together (at byte 8)";
  static const char flags[] = "the header has unknown flags (at byte 8)";
  static const char range[] = "the header has a cutoff or length out of range (at byte 8)";
  static const char box[] = "the header has a box that is none (at byte 8)";
  const float infinite = INFINITY, not_a_number = NAN, small = 0.2f, large = 5.5f, low = -1e30f;
  const double wide_nan = NAN, negative = -1.0, wide = 1e30, endless = -INFINITY;
  const struct {
    size_t at;
    const void *value;
    size_t n;
    const char *wanted;
  } edits[] = {
      {0, "CONICHX", 7, "no .chy file (at byte 0)"},
      {VERSION, &(uint32_t){CONIC_CHY_VERSION + 1}, 4, "version 6 of the format is not known (at byte 8)"},
      {FLAGS, &(uint32_t){16}, 4, flags},
      {ZERO, &(uint32_t){1}, 4, flags},
      {COUNTS + 8 * VERTICES, &(uint64_t){UINT64_C(1) << 32}, 8, counts},
      {COUNTS + 8 * SURFELS, &(uint64_t){UINT64_MAX}, 8, counts},
      {COUNTS + 8 * LEVELS, &(uint64_t){sound->n_clusters - 1}, 8, counts},
      {COUNTS + 8 * CLUSTERS, &(uint64_t){0}, 8, counts},
      {COUNTS + 8 * NODES, &(uint64_t){0}, 8, counts},
      {COUNTS + 8 * NODES, &(uint64_t){2 * sound->n_clusters}, 8, counts},
      {COUNTS + 8 * MATERIALS, &(uint64_t){0}, 8, counts},
      {COUNTS + 8 * DATA, &(uint64_t){UINT64_C(1) << 38}, 8, counts},
      {CUTOFF, &small, 4, range},
      {CUTOFF, &large, 4, range},
      {CUTOFF, &not_a_number, 4, range},
      {LENGTH, &negative, 8, range},
      {LENGTH, &wide, 8, range},
      {LENGTH, &wide_nan, 8, range},
      {ORIGIN + 8, &wide_nan, 8, box},
      {ORIGIN, &endless, 8, box},
      {LOW, &infinite, 4, box},
      {HIGH, &low, 4, box},
      {HIGH + 8, &not_a_number, 4, box},
  };
  for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
    unsigned char value[8];
    memcpy(value, edits[i].value, edits[i].n);
    if (edits[i].n % 4 == 0)
      conic_turn_words(value, 1, edits[i].n);
    check_edit(context, sound, edits[i].at, value, edits[i].n, 1, edits[i].wanted);
  }
}

/* Sums that are not right, bytes that should be 0, and sizes. */
static void test_damage(conic_context *context, const sound_file *sound) {
  char wanted[200];
  unsigned char one = 1;
  unsigned char *longer = calloc(1, sound->n_bytes + 64);
  if (!longer)
    exit(1);
  check_edit(context, sound, CONIC_FILE_HEADER_BYTES - 8, "damaged!", 8, 0, "the header is damaged (at byte 248)");
  check_edit(context, sound, LOW, "wide", 4, 0, "the header is damaged (at byte 248)");
  check_edit(context, sound, sound->levels + offsetof(conic_hybrid_level, error), "error", 4, 0,
             "is damaged: its sum is not that of its header (at byte 256)");
  snprintf(wanted, sizeof wanted, "has a chunk that is damaged (at byte %zu)", sound->corners_at);
  check_edit(context, sound, sound->corners, "\377", 1, 0, wanted);
  size_t after_nodes = sound->nodes + sound->n_nodes * sizeof(conic_hybrid_node);
  CHECK(after_nodes < sound->clusters); /* 80 bytes each, and of a tree of pairs an odd number */
  snprintf(wanted, sizeof wanted, "is damaged (at byte %zu)", after_nodes);
  check_edit(context, sound, after_nodes, &one, 1, 1, wanted);
  memcpy(longer, sound->bytes, sound->n_bytes);
  for (int change = -64; change <= 64; change += 64) {
    size_t n = sound->n_bytes + (size_t)change;
    snprintf(wanted, sizeof wanted, "has %zu bytes where its header tells of %zu (at byte %zu)", n, sound->n_bytes,
             n < sound->n_bytes ? n : sound->n_bytes);
    if (change)
      check_message(context, longer, n, wanted);
  }
  check_message(context, longer, 255, "ends within its header (at byte 255)");
  check_message(context, longer, 8, "ends within its header (at byte 8)");
  check_message(context, longer, 7, "no .chy file (at byte 0)");
  free(longer);
}

#define RECORD(array, i, type, member) (sound->array + (i) * sizeof(type) + offsetof(type, member))
#define LEVEL(i, member) RECORD(levels, i, conic_hybrid_level, member)
#define CLUSTER(i, member) RECORD(clusters, i, conic_hybrid_cluster, member)
#define NODE(i, member) RECORD(nodes, i, conic_hybrid_node, member)
#define MATERIAL(i, member) RECORD(material_list, i, conic_chy_material, member)

static uint32_t u32_at(const sound_file *sound, size_t at) {
  return conic_load_32(sound->bytes + at);
}

static void test_levels(conic_context *context, const sound_file *sound) {
  static const char no_kind[] = "a level of no known kind", no_parts[] = "a level without its triangles or surfels",
                    no_vertices[] = "a level without its vertices",
                    range[] = "a level's error, reach or extent out of range", order[] = "chunks out of order";
  check_u32(context, sound, LEVEL(0, kind), 2, no_kind);
  check_u32(context, sound, LEVEL(1, kind), 2, no_kind);
  check_u32(context, sound, LEVEL(0, first_border), UINT32_MAX, "a level without its borders");
  check_u32(context, sound, LEVEL(0, count), 0, no_parts);
  check_u32(context, sound, LEVEL(0, count), UINT32_MAX, no_parts);
  check_u32(context, sound, LEVEL(0, count), u32_at(sound, LEVEL(0, count)) + 1,
            "other numbers of triangles or surfels than its levels");
  check_u32(context, sound, LEVEL(0, n_vertices), 0, no_vertices);
  check_u32(context, sound, LEVEL(0, n_vertices), UINT32_MAX, order);
  check_u32(context, sound, LEVEL(0, at), u32_at(sound, LEVEL(0, at)) + 1, order);
  check_u32(context, sound, LEVEL(sound->n_levels - 1, at), UINT32_MAX, order);
  check_chunk(context, sound, sound->corners_at, sound->corners + 4, u32_at(sound, LEVEL(0, n_vertices)), 2,
              "a corner out of range");
  check_f32(context, sound, LEVEL(1, error), NAN, range);
  check_f32(context, sound, LEVEL(1, error), INFINITY, range);
  check_f32(context, sound, LEVEL(1, error), -1e-6f, range);
  check_f32(context, sound, LEVEL(0, reach), -1.0f, range);
  check_f32(context, sound, LEVEL(1, cover), -1.0f, range);
  check_f32(context, sound, LEVEL(1, spread), NAN, range);
  check_f32(context, sound, LEVEL(1, change), NAN, range);
  check_f32(context, sound, LEVEL(1, smear), -1.0f, range);
  check_f32(context, sound, LEVEL(sound->n_levels - 1, reach), NAN, range);
}

/* Where clusters meet. */
static void test_frames(conic_context *context, const sound_file *sound) {
  static const char range[] = "a border out of range";
  size_t edge = sound->frame, from = edge + 4, to = edge + 8, across = edge + 12, at = sound->frame_at;
  check_u32(context, sound, CLUSTER(sound->framed, n_borders), u32_at(sound, CLUSTER(sound->framed, n_borders)) + 1,
            "borders of no level");
  check_u32(context, sound, CLUSTER(sound->framed, n_slots), UINT32_MAX, "chunks out of order");
  check_u32(context, sound, CLUSTER(sound->framed, frame_at), UINT32_MAX, "chunks out of order");
  check_u32(context, sound, CLUSTER(sound->framed, ends_at), UINT32_MAX, "chunks out of order");
  check_chunk(context, sound, at, edge, UINT32_MAX, 4, range);
  check_chunk(context, sound, at, edge, u32_at(sound, edge) | 3, 4, range); /* no triangle has a fourth corner */
  check_chunk(context, sound, at, from, sound->n_slots, 4, range);
  check_chunk(context, sound, at, to, sound->n_slots, 4, range);
  size_t other = to; /* of a border that does not run there as it is */
  uint32_t last = (uint32_t)sound->n_slots - 1, far = u32_at(sound, from) <= last / 2 ? last : 0;
  for (uint32_t k = 0; k < u32_at(sound, CLUSTER(sound->framed, n_borders)) && u32_at(sound, other) == far; k++) {
    other = to + 16 * (size_t)k;
    far = u32_at(sound, other - 4) <= last / 2 ? last : 0;
  }
  check_chunk(context, sound, at, other, far, 4, "borders that run over each other");
  check_chunk(context, sound, at, across, sound->n_clusters, 4, range);
  check_chunk(context, sound, at, across, sound->framed, 4, range);
  check_chunk(context, sound, at, sound->ends + 4 * u32_at(sound, from), conic_bits_of_float(77.0f), 4,
              "a border that is not its triangle's");
}

static void test_clusters(conic_context *context, const sound_file *sound) {
  static const char no_levels[] = "a patch without its levels", range[] = "a patch's bounds out of range";
  size_t last = sound->n_clusters - 1;
  uint32_t n_levels = u32_at(sound, CLUSTER(last, n_levels));
  check_u32(context, sound, CLUSTER(0, first_level), 1, no_levels);
  check_u32(context, sound, CLUSTER(1, first_level), 0, no_levels); /* whose levels are another's, too */
  check_u32(context, sound, CLUSTER(0, n_levels), 0, no_levels);
  check_u32(context, sound, CLUSTER(0, n_levels), sound->n_levels + 1, no_levels);
  check_u32(context, sound, CLUSTER(last, n_levels), n_levels + 1, "a level without its borders"); /* the root's */
  check_u32(context, sound, CLUSTER(0, built), u32_at(sound, CLUSTER(0, n_levels)), no_levels);
  if (u32_at(sound, CLUSTER(last, built)) + 1 < n_levels)
    check_u32(context, sound, CLUSTER(last, n_levels), n_levels - 1, "a node without its levels");
  check_f32(context, sound, CLUSTER(0, bound.center[1]), NAN, range);
  check_f32(context, sound, CLUSTER(0, bound.center[2]), INFINITY, range);
  check_f32(context, sound, CLUSTER(0, bound.axis[0]), 1.5f, range);
  check_f32(context, sound, CLUSTER(0, bound.radius), -1.0f, range);
  check_f32(context, sound, CLUSTER(0, bound.cone), -1.5f, range);
  check_f32(context, sound, CLUSTER(0, area), NAN, range);
}

/* Nodes have the levels after those of the clusters, one node after the other. */
static void test_joined(conic_context *context, const sound_file *sound) {
  static const char no_levels[] = "a node without its levels", range[] = "a node's point out of range";
  size_t last = sound->n_nodes - 1, with = 0;
  while (with < last && u32_at(sound, NODE(with, n_levels)) == 0)
    with++;
  uint32_t n = u32_at(sound, NODE(with, n_levels));
  CHECK(n > 0);
  check_u32(context, sound, NODE(0, n_levels), UINT32_MAX, no_levels);
  check_u32(context, sound, NODE(0, first_level), 0, no_levels);
  check_u32(context, sound, NODE(with, first_level), u32_at(sound, NODE(with, first_level)) - 1, no_levels);
  if (with < last)
    check_u32(context, sound, NODE(with, n_levels), n - 1, no_levels);
  n = u32_at(sound, NODE(last, n_levels));
  check_u32(context, sound, NODE(last, n_levels), n + 1, no_levels);
  if (n > 0)
    check_u32(context, sound, NODE(last, n_levels), n - 1, "levels of no patch or node");
  check_u32(context, sound, LEVEL(sound->n_levels - 1, kind), CONIC_HYBRID_TRIANGLES, "a level without its vertices");
  check_u32(context, sound, LEVEL(u32_at(sound, NODE(with, first_level)), n_borders), 1, "a node's level with borders");
  check_f32(context, sound, NODE(0, point.radius), NAN, range);
  check_f32(context, sound, NODE(0, point.radius), -1.0f, range);
  check_f32(context, sound, NODE(last, point.error), INFINITY, range);
  check_f32(context, sound, NODE(0, point.change), NAN, range);
  check_f32(context, sound, NODE(0, point.smear), -1.0f, range);
}

/* The tree is a walk: no node leads back, so that no file makes it go around. */
static void test_nodes(conic_context *context, const sound_file *sound) {
  static const char none[] = "a node that is none", order[] = "nodes out of order",
                    within[] = "nodes that are not within each other";
  size_t last = sound->n_nodes - 1;
  check_u32(context, sound, NODE(0, next), 0, none);
  check_u32(context, sound, NODE(1, next), 1, none);
  check_u32(context, sound, NODE(last, next), last - 1, none);
  check_u32(context, sound, NODE(last, next), sound->n_nodes + 1, none);
  check_u32(context, sound, NODE(1, end), 0, none);
  check_u32(context, sound, NODE(0, end), sound->n_clusters + 1, none);
  check_u32(context, sound, NODE(last, end), sound->n_clusters + 1, within);
  check_f32(context, sound, NODE(0, bound.radius), NAN, none);
  check_u32(context, sound, NODE(last, begin), u32_at(sound, NODE(last, begin)) - 1, order);
  check_u32(context, sound, NODE(0, begin), 1, order);
  check_u32(context, sound, NODE(0, next), sound->n_nodes - 1, within);
  check_u32(context, sound, NODE(0, end), sound->n_clusters - 1, within);
  check_u32(context, sound, NODE(last, end), u32_at(sound, NODE(last, end)) - 1, within);
  check_u32(context, sound, NODE(0, next), 1, order); /* a root without children, and more nodes */
  uint32_t i = 1;                                     /* a node that ends where its first child's first child begins */
  while (i + 2 < sound->n_nodes && u32_at(sound, NODE(i + 1, next)) == i + 2)
    i++;
  uint32_t end_and_next[2] = {u32_at(sound, NODE(i + 1, end)), i + 2};
  conic_turn_words(end_and_next, 2, 4);
  check_edit(context, sound, NODE(i, end), end_and_next, sizeof end_and_next, 1,
             "has nodes that are not within each other (at byte 256)");
}

static void test_attributes(conic_context *context, const sound_file *sound) {
  static const char no_texels[] = "a texture without its texels";
  check_chunk(context, sound, sound->corners_at, sound->materials, sound->n_materials, 4, "a material out of range");
  size_t i = u32_at(sound, MATERIAL(0, width)) ? 0 : 1;
  check_u32(context, sound, MATERIAL(i, width), 65536, no_texels);
  check_u32(context, sound, MATERIAL(i, width), 5, no_texels); /* 5 × 3, and there are 12 */
  check_u32(context, sound, MATERIAL(i, height), 0, no_texels);
  check_u32(context, sound, MATERIAL(i, wrap), 2, no_texels);
  check_u32(context, sound, MATERIAL(i, first_texel), 1, no_texels);
  check_u32(context, sound, MATERIAL(i, first_texel) + 4, 0x80000000u, no_texels);
}

/* What can be drawn, and yet is not as it was built. */
static void check_defect(conic_context *context, const sound_file *sound, size_t at, float value, size_t place) {
  conic_hybrid *hybrid;
  conic_hybrid_defects defects;
  unsigned char *bytes = malloc(sound->n_bytes);
  if (!bytes)
    exit(1);
  memcpy(bytes, sound->bytes, sound->n_bytes);
  conic_store_float(bytes + at, value);
  mend_hybrid(bytes, sound->n_bytes);
  const char *path = files_write_bytes("odd.chy", bytes, sound->n_bytes);
  CHECK_OK(conic_hybrid_read(context, path, &hybrid));
  CHECK_OK(conic_hybrid_check(hybrid, &defects));
  size_t found[] = {defects.values, defects.spheres, defects.cones, defects.levels};
  for (size_t i = 0; i < sizeof found / sizeof *found; i++)
    CHECK((found[i] > 0) == (i == place));
  conic_hybrid_destroy(hybrid);
  CHECK(unlink(path) == 0);
  free(bytes);
}

static void test_defects(conic_context *context, const sound_file *sound) {
  enum { VALUES, SPHERES, CONES, ERRORS };
  check_defect(context, sound, LEVEL(0, error), 0.5f, ERRORS); /* the mesh itself, with an error */
  for (size_t i = 0, n = 0; i + 2 < sound->n_levels && n < 3; i++)
    if (u32_at(sound, LEVEL(i + 1, kind)) == u32_at(sound, LEVEL(i + 2, kind)) &&
        u32_at(sound, LEVEL(i + 1, error)) < u32_at(sound, LEVEL(i + 2, error))) {
      check_defect(context, sound, LEVEL(i + 1, error), 9.0f, ERRORS); /* levels out of order */
      n++;
    }
  check_defect(context, sound, CLUSTER(0, bound.cone), 1.0f, CONES);
  check_defect(context, sound, CLUSTER(0, bound.radius), 0.0f, SPHERES);
  check_defect(context, sound, NODE(1, bound.radius), 0.0f, SPHERES);
  check_defect(context, sound, NODE(0, point.color[1]), NAN, VALUES);
  check_defect(context, sound, NODE(0, point.error), 0.0f, ERRORS);
  check_defect(context, sound, NODE(0, point.radius), 1e-3f, SPHERES);
}

int main(void) {
  conic_context *context = files_context();
  sound_file sound = make_sound(context);
  test_header(context, &sound);
  test_damage(context, &sound);
  test_levels(context, &sound);
  test_clusters(context, &sound);
  test_frames(context, &sound);
  test_nodes(context, &sound);
  test_joined(context, &sound);
  test_attributes(context, &sound);
  test_defects(context, &sound);
  free(sound.bytes);
  files_end(context);
  return check_result();
}
