/* Gaussian scenes by whatever format: which a file is, and its reader and writer. */

#include "core/assimp/assimp_kinds.h"
#include "core/base/loan_find.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/files/inflate.h"
#include "gaussians/formats/gaussian_formats.h"

typedef struct kind_facts {
  const char *name, *ending, *frame;
  int sh_degree;
  conic_status (*read)(const conic_gaussian_bytes *file, conic_gaussians *gaussians); /* null: PLY's */
  conic_status (*write)(const conic_gaussian_writer *writer);
} kind_facts;

/* Endings in the order in which they are looked for. */
static const kind_facts kinds[] = {
    [CONIC_GAUSSIANS_PLY] = {"ply", "ply", "rdf", 4, NULL, conic_gaussian_ply_write},
    [CONIC_GAUSSIANS_COMPRESSED_PLY] = {"compressed-ply", "compressed.ply", "rdf", 3, NULL, conic_compressed_ply_write},
    [CONIC_GAUSSIANS_SPLAT] = {"splat", "splat", "rdf", 0, conic_splat_file_read, conic_splat_file_write},
    [CONIC_GAUSSIANS_SPZ] = {"spz", "spz", "rub", 4, conic_spz_read, conic_spz_write},
    [CONIC_GAUSSIANS_SOG] = {"sog", "sog", "rdf", 3, conic_sog_read, conic_sog_write},
    [CONIC_GAUSSIANS_GLTF] = {"gltf", "gltf", "luf", 3, conic_gaussian_gltf_read, conic_gaussian_gltf_write},
    [CONIC_GAUSSIANS_GLB] = {"glb", "glb", "luf", 3, conic_gaussian_gltf_read, conic_gaussian_gltf_write},
    [CONIC_GAUSSIANS_KSPLAT] = {"ksplat", "ksplat", "rdf", 3, conic_ksplat_read, NULL},
};

static int is_kind(conic_gaussian_kind kind) {
  return (size_t)kind < sizeof kinds / sizeof *kinds;
}

const char *conic_gaussian_kind_name(conic_gaussian_kind kind) {
  return is_kind(kind) ? kinds[kind].name : NULL;
}

const char *conic_gaussian_kind_frame(conic_gaussian_kind kind) {
  return is_kind(kind) ? kinds[kind].frame : NULL;
}

int conic_gaussian_kind_sh_degree(conic_gaussian_kind kind) {
  return is_kind(kind) ? kinds[kind].sh_degree : -1;
}

int conic_gaussians_find_kind(const char *path, conic_gaussian_kind *kind) {
  int found = -1;
  for (int i = 0; i < CONIC_N_GAUSSIAN_KINDS; i++)
    if (conic_file_has_ending(path, kinds[i].ending))
      found = i; /* a longer ending comes after its own */
  if (found >= 0)
    *kind = (conic_gaussian_kind)found;
  return found >= 0;
}

/* --- what the readers share --- */

conic_status conic_gaussians_begin(conic_context *context, const char *name,
                                   const conic_gaussians_read_options *options, uint64_t count, int sh_degree,
                                   unsigned fields, conic_gaussians *gaussians) {
  if (count > CONIC_MOST_GAUSSIANS)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %llu Gaussians are too many (at byte 0)", name,
                      (unsigned long long)count);
  if (!options->keeps_source)
    fields &= ~(unsigned)CONIC_GAUSSIANS_SOURCE;
  if (options->half_harmonics)
    fields |= CONIC_GAUSSIANS_HALF;
  sh_degree = sh_degree < options->most_sh_degree ? sh_degree : options->most_sh_degree;
  return conic_gaussians_allocate(context, (size_t)count, sh_degree, fields, gaussians);
}

conic_status(conic_gaussian_bytes_wrong)(const conic_gaussian_bytes *file, size_t at, const char *what) {
  return conic_fail(file->context, CONIC_ERROR_INPUT, "%s: %s (at byte %zu)", file->name, what, at);
}

conic_status conic_gaussian_bytes_open(const conic_gaussian_bytes *file, const char *name, char path[4096],
                                       conic_mapping *mapping) {
  const char *own = file->path ? file->path : "";
  int n = snprintf(path, 4096, "%.*s%s", (int)(conic_file_name(own) - own), own, name);
  if (!own[0] || !name[0] || name[0] == '/' || strpbrk(name, "\\:") || strstr(name, "..") || n < 0 || n >= 4096 ||
      !conic_file_is_there(path))
    return conic_fail(file->context, CONIC_ERROR_INPUT, "%s: a file of it is not named, or not there: %s (at byte 0)",
                      file->name, name);
  return conic_mapping_open(file->context, path, mapping);
}

void conic_gaussians_unit_rotation(const conic_gaussians *gaussians, size_t i, double q[4]) {
  double sum = 0.0;
  for (int k = 0; k < 4; k++) {
    q[k] = (double)gaussians->rotation[k][i];
    sum += q[k] * q[k];
  }
  int is_one = sum > 0.0 && conic_is_finite(sum);
  for (int k = 0; k < 4; k++)
    q[k] = is_one ? q[k] / sqrt(sum) : k == 0 ? 1.0 : 0.0;
}

int conic_find_left_out(double q[4], double (*rounded)(double value)) {
  double largest = 0.0, least_error = 8.0;
  int best = 0;
  for (int k = 0; k < 4; k++)
    largest = fabs(q[k]) > largest ? fabs(q[k]) : largest;
  for (int k = 0; k < 4; k++) {
    double sign = q[k] < 0.0 ? -1.0 : 1.0, sum = 0.0, error = 0.0;
    if (fabs(q[k]) < 0.9 * largest)
      continue;
    for (int j = 0; j < 4; j++)
      if (j != k) {
        double value = rounded(sign * q[j]);
        error += (value - sign * q[j]) * (value - sign * q[j]);
        sum += value * value;
      }
    double rest = sum < 1.0 ? sqrt(1.0 - sum) : 0.0;
    error += (rest - fabs(q[k])) * (rest - fabs(q[k]));
    int is_tie = fabs(error - least_error) < 1e-12; /* what was left out before is positive, and mostly the largest */
    if (is_tie ? (q[k] > 0.0) > (q[best] > 0.0) || ((q[k] > 0.0) == (q[best] > 0.0) && fabs(q[k]) > fabs(q[best]))
               : error < least_error) {
      least_error = error;
      best = k;
    }
  }
  for (int k = 0, is_negative = q[best] < 0.0; is_negative && k < 4; k++)
    q[k] = -q[k];
  return best;
}

/* --- which format a file is --- */

static int begins_as_ply(const unsigned char *bytes, size_t n) {
  return n >= 4 && memcmp(bytes, "ply", 3) == 0 && (bytes[3] == '\n' || bytes[3] == '\r' || bytes[3] == ' ');
}

static int is_compressed_ply(const unsigned char *bytes, size_t n) {
  size_t n_head = n < 65536 ? n : 65536;
  return begins_as_ply(bytes, n) && conic_assimp_has_text(bytes, n_head, " packed_position") &&
         conic_assimp_has_text(bytes, n_head, "element chunk");
}

static int is_gaussian_ply(const unsigned char *bytes, size_t n) {
  static const char *const names[] = {" scale_0", " scale_1", " rot_0", " rot_3", " opacity"};
  size_t n_head = n < 65536 ? n : 65536;
  if (!conic_assimp_has_text(bytes, n_head, " f_dc_2") && !conic_assimp_has_text(bytes, n_head, " blue"))
    return 0;
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (!conic_assimp_has_text(bytes, n_head, names[i]))
      return 0;
  return 1;
}

static int is_packed_spz(const unsigned char *bytes, size_t n) {
  unsigned char head[4];
  return !conic_inflate_is_there() ||
         (conic_inflate(CONIC_DEFLATE_GZIP, bytes, n, head, sizeof head, NULL) == sizeof head &&
          memcmp(head, "NGSP", 4) == 0);
}

/* Version 0.1, and a level of compression. */
static int is_ksplat(const unsigned char *bytes, size_t n) {
  return n > 4096 && memcmp(bytes, "\0\1\0\0", 4) == 0 && conic_load_16(bytes + 20) <= 2;
}

static int is_sog_archive(const unsigned char *bytes, size_t n) {
  size_t tail = n > 65536 ? n - 65536 : 0;
  return conic_assimp_has_text(bytes + tail, n - tail, "meta.json") &&
         conic_assimp_has_text(bytes + tail, n - tail, "means_l.webp");
}

/* The JSON of a glTF, whichever way it is wrapped. */
static int names_gaussians(const unsigned char *bytes, size_t n) {
  size_t from = 0, length = n;
  if (n >= 20 && memcmp(bytes, "glTF", 4) == 0) {
    from = 20;
    length = conic_load_32(bytes + 12);
    length = length < n - 20 ? length : n - 20;
  }
  return conic_assimp_has_text(bytes + from, length, "gaussian_splat");
}

/* Of a file that is no PLY. */
static int find_scene_kind(const char *path, const unsigned char *bytes, size_t n, conic_gaussian_kind *kind) {
  size_t blank = n >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
  while (blank < n && bytes[blank] && strchr(" \t\r\n", bytes[blank]))
    blank++;
  int is_json = blank < n && bytes[blank] == '{';
  if ((n >= 4 && memcmp(bytes, "NGSP", 4) == 0) ||
      (n >= 2 && memcmp(bytes, "\x1f\x8b", 2) == 0 && is_packed_spz(bytes, n)))
    *kind = CONIC_GAUSSIANS_SPZ;
  else if (n >= 4 && memcmp(bytes, "glTF", 4) == 0 && names_gaussians(bytes, n))
    *kind = CONIC_GAUSSIANS_GLB;
  else if (is_json && names_gaussians(bytes, n))
    *kind = CONIC_GAUSSIANS_GLTF;
  else if ((n >= 4 && memcmp(bytes, "PK\3\4", 4) == 0 && is_sog_archive(bytes, n)) ||
           (is_json && ((conic_assimp_has_text(bytes, n, "\"means\"") && conic_assimp_has_text(bytes, n, "\"sh0\"")) ||
                        conic_assimp_has_text(bytes, n, "\"lodLevels\""))))
    *kind = CONIC_GAUSSIANS_SOG;
  else if (path && conic_file_has_ending(path, "splat"))
    *kind = CONIC_GAUSSIANS_SPLAT;
  else if (is_ksplat(bytes, n) || (path && conic_file_has_ending(path, "ksplat")))
    *kind = CONIC_GAUSSIANS_KSPLAT;
  else
    return 0;
  return 1;
}

/* The file of a folder that says what the others are. */
static const char *resolve_folder(const char *path, char room[4096]) {
  conic_disk_entry about;
  if (strcmp(path, "-") == 0 || !conic_disk_look(path, &about) || !about.is_folder)
    return path;
  for (const char *name = "meta.json\0lod-meta.json\0"; *name; name += strlen(name) + 1) {
    int n = snprintf(room, 4096, "%s/%s", path, name);
    if (n > 0 && n < 4096 && conic_file_is_there(room))
      return room;
  }
  return path;
}

/* Whether it is a scene, and one whose vertices are columns of a PLY. */
static int look_for_scene(conic_context *context, const char *path, int *is_plain_ply) {
  char room[4096];
  conic_mapping file;
  conic_gaussian_kind kind;
  const char *resolved = resolve_folder(path, room);
  *is_plain_ply = 0;
  if (strcmp(path, "-") == 0 || !conic_file_is_there(resolved) ||
      conic_mapping_open(context, resolved, &file) != CONIC_OK)
    return 0;
  int is_one = is_compressed_ply(file.bytes, file.n_bytes);
  if (!is_one && begins_as_ply(file.bytes, file.n_bytes))
    is_one = *is_plain_ply = is_gaussian_ply(file.bytes, file.n_bytes);
  else if (!is_one)
    is_one = find_scene_kind(resolved, file.bytes, file.n_bytes, &kind);
  conic_mapping_close(context, &file);
  return is_one;
}

int conic_gaussians_is_file(conic_context *context, const char *path) {
  int is_plain_ply;
  if (conic_loan_is_named(path, "gaussians"))
    return 1;
  return look_for_scene(context, path, &is_plain_ply);
}

int conic_gaussians_is_packed(conic_context *context, const char *path) {
  int is_plain_ply;
  if (conic_loan_is_named(path, "gaussians"))
    return 1;
  return look_for_scene(context, path, &is_plain_ply) && !is_plain_ply;
}

/* --- reading --- */

CONIC_DEFINE_OPTIONS(conic_gaussians_read_options, .most_sh_degree = CONIC_MAX_SH_DEGREE)

static conic_status read_ply_scene(conic_input *input, const conic_gaussians_read_options *options,
                                   conic_gaussians *gaussians) {
  conic_ply_header header;
  conic_gaussian_kind kind = CONIC_GAUSSIANS_PLY;
  conic_status status = conic_ply_header_read(input, &header);
  if (status != CONIC_OK)
    return status;
  if (conic_ply_has_compressed_gaussians(&header)) {
    kind = CONIC_GAUSSIANS_COMPRESSED_PLY;
    status = conic_compressed_ply_read(input, &header, options, gaussians);
  } else if (conic_ply_has_gaussians(&header))
    status = conic_gaussian_ply_read(input, &header, options, gaussians);
  else
    status = conic_fail(input->context, CONIC_ERROR_INPUT,
                        "%s: no Gaussians: the vertices lack f_dc_… or colours, opacity, scale_… or rot_… (line %llu)",
                        input->name, (unsigned long long)(input->line - 1));
  gaussians->kind = kind;
  conic_ply_header_release(input->context, &header);
  return status;
}

static conic_status read_scene_bytes(const conic_gaussian_bytes *file, conic_gaussians *gaussians) {
  conic_gaussian_kind kind = CONIC_GAUSSIANS_SPLAT;
  if (file->n_bytes == 0)
    return conic_gaussian_bytes_wrong(file, 0, "the file is empty");
  if (!find_scene_kind(file->path, file->bytes, file->n_bytes, &kind) && !file->options->is_splat)
    return conic_gaussian_bytes_wrong(
        file, 0,
        "no Gaussian scene that is known: a .ply, .compressed.ply, .splat, .ksplat, .spz, .sog, .gltf or .glb is");
  int is_levels = kind == CONIC_GAUSSIANS_SOG && conic_assimp_has_text(file->bytes, file->n_bytes, "\"lodLevels\"");
  conic_status status = is_levels ? conic_sog_levels_read(file, gaussians) : kinds[kind].read(file, gaussians);
  gaussians->kind = kind;
  return status;
}

static conic_status read_input(conic_input *input, const char *path, const conic_gaussians_read_options *options,
                               conic_gaussians *gaussians) {
  conic_gaussian_bytes file = {input->context, input->name, path, NULL, 0, options};
  conic_mapping mapping = {NULL, 0, 0};
  conic_status status = conic_input_fill(input, 4);
  if (status == CONIC_OK && begins_as_ply(conic_input_bytes(input), conic_input_available(input)))
    return read_ply_scene(input, options, gaussians);
  if (status == CONIC_OK)
    status = path && input->has_size ? conic_mapping_take(input, SIZE_MAX, &mapping)
                                     : conic_input_take_rest(input, SIZE_MAX, &mapping.bytes, &mapping.n_bytes);
  file.bytes = mapping.bytes;
  file.n_bytes = mapping.n_bytes;
  if (status == CONIC_OK)
    status = read_scene_bytes(&file, gaussians);
  conic_mapping_close(input->context, &mapping);
  return status;
}

conic_status conic_gaussians_read(conic_context *context, const char *path, const conic_gaussians_read_options *options,
                                  conic_gaussians *gaussians) {
  conic_gaussians_read_options own;
  char room[4096];
  conic_input input;
  const char *resolved = resolve_folder(path, room);
  memset(gaussians, 0, sizeof *gaussians);
  conic_gaussians_read_options_init(&own);
  if ((options && !conic_options_take(&own, options)) || own.most_sh_degree < 0)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the reader's options have no meaning", path);
  const conic_gaussians *lent = conic_loan_find(context, path, "gaussians");
  if (lent)
    return conic_gaussians_copy_lent(context, path, lent, &own, gaussians);
  conic_status status = conic_input_open(context, resolved, &input);
  if (status != CONIC_OK)
    return status;
  status = read_input(&input, strcmp(path, "-") == 0 ? NULL : resolved, &own, gaussians);
  conic_input_close(&input);
  if (status != CONIC_OK)
    conic_gaussians_release(context, gaussians);
  return status;
}

/* --- writing --- */

CONIC_DEFINE_OPTIONS(conic_gaussians_write_options, .sh_bits = {8, 8}, .spz_version = 4,
                     .most_sh_degree = CONIC_MAX_SH_DEGREE)

conic_status conic_gaussian_writer_put(const conic_gaussian_writer *writer, const void *bytes, size_t n_bytes) {
  if (fwrite(bytes, 1, n_bytes, writer->to) == n_bytes)
    return CONIC_OK;
  return conic_fail(writer->context, CONIC_ERROR_IO, "%s: cannot write: %s", writer->path, strerror(errno));
}

conic_status conic_gaussian_writer_tell(const conic_gaussian_writer *writer, size_t i) {
  size_t n = writer->gaussians->count;
  return i % 65536 != 65535 ? CONIC_OK : conic_progress(writer->context, "write", (double)i / (double)n);
}

static int are_usable(const conic_gaussians_write_options *options) {
  int is_usable = (int)options->kind >= 0 && (int)options->kind < CONIC_N_GAUSSIAN_KINDS &&
                  options->most_sh_degree >= 0 && (options->spz_version == 3 || options->spz_version == 4);
  for (int i = 0; i < 2; i++)
    is_usable = is_usable && options->sh_bits[i] >= 1 && options->sh_bits[i] <= 8;
  return is_usable;
}

conic_status conic_gaussians_write(conic_context *context, const char *path, const conic_gaussians *gaussians,
                                   const conic_gaussians_write_options *options) {
  conic_gaussians_write_options own;
  conic_output *output;
  conic_gaussians_write_options_init(&own);
  if ((options && !conic_options_take(&own, options)) || !are_usable(&own))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the writer's options have no meaning", path);
  conic_status status = conic_gaussians_check(context, gaussians, path);
  if (status == CONIC_OK)
    status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  const kind_facts *kind = &kinds[own.kind];
  int sh_degree = gaussians->sh_degree < kind->sh_degree ? gaussians->sh_degree : kind->sh_degree;
  sh_degree = sh_degree < own.most_sh_degree ? sh_degree : own.most_sh_degree;
  const conic_gaussian_writer writer = {context, path, conic_output_stream(output), gaussians, &own, sh_degree};
  return conic_output_end(output, kind->write(&writer));
}
