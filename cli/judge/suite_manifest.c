#include "cli/judge/suite_manifest.h"

enum { SUITE_MOST_LEVELS = 99, SUITE_MOST_ENTRIES = 4096 };

/* A scene or a file of the manifest. */
typedef struct manifest_scene {
  char name[SUITE_WORD_ROOM], ply[2 * SUITE_NAME_ROOM], camera[2 * SUITE_NAME_ROOM];
  char stage[SUITE_WORD_ROOM], colors[SUITE_WORD_ROOM];
  int width, height, step;
} manifest_scene;

typedef struct manifest_file {
  char path[2 * SUITE_NAME_ROOM], sha256[CONIC_SHA256_ROOM];
  uint64_t bytes;
} manifest_file;

typedef struct manifest_reader {
  conic_json json;
  suite_manifest *manifest;
  manifest_scene *scenes;
  manifest_file *files;
  size_t n_scenes, n_files, case_room, scene_room, file_room;
  int has_format;
} manifest_reader;

/* Whether a text consists of plain names, with slashes between them if it may be a path. */
static int is_plain_path(const char *text, int may_have_folders) {
  int is_start = 1;
  for (const char *c = text; *c; c++) {
    int is_word = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9');
    int is_slash = may_have_folders && *c == '/' && !is_start;
    if (!is_word && !is_slash && (is_start || !strchr("-_.", *c)))
      return 0;
    is_start = *c == '/';
  }
  return !is_start;
}

/* Reads a plain text that fits. */
static conic_status read_plain(conic_json *json, char *text, size_t room, int may_have_folders) {
  const char *raw;
  size_t length;
  conic_status status = conic_json_raw_text(json, &raw, &length);
  if (status != CONIC_OK)
    return status;
  if (length >= room)
    return conic_json_wrong(json, "a name is too long");
  memcpy(text, raw, length);
  text[length] = '\0';
  return strlen(text) == length && is_plain_path(text, may_have_folders)
             ? CONIC_OK
             : conic_json_wrong(json, "a name has other signs than letters, digits, points, hyphens and underscores");
}

/* A member of an object: a word, a path or a number, or an object with a path. */
typedef enum member_kind { WORD, PATH, NUMBER, COUNT, INNER_PATH } member_kind;
typedef struct manifest_member {
  const char *key;
  member_kind kind;
  size_t at, room;   /* in the entry */
  double most;       /* of a number */
  const char *inner; /* the key of an inner path */
  const char *other; /* null; or another such key */
} manifest_member;

static int is_key(const char *key, const char *name) {
  return strcmp(key, name) == 0;
}

static void read_object(conic_json *json, const manifest_member *members, int n, void *entry);

static void read_member(conic_json *json, const manifest_member *member, void *entry) {
  char *to = (char *)entry + member->at;
  double value;
  if (member->kind == WORD || member->kind == PATH) {
    read_plain(json, to, member->room, member->kind == PATH);
    return;
  }
  if (member->kind == INNER_PATH) {
    const manifest_member inner[2] = {{member->inner, PATH, member->at, member->room},
                                      {member->other, PATH, member->at, member->room}};
    read_object(json, inner, member->other ? 2 : 1, entry);
    return;
  }
  if (conic_json_number(json, &value) != CONIC_OK)
    return;
  if (!(value >= 1.0 && value <= member->most && value == (double)(uint64_t)value))
    conic_json_wrong(json, "a number is not whole, or too large");
  else if (member->kind == COUNT)
    *(uint64_t *)(void *)to = (uint64_t)value;
  else
    *(int *)(void *)to = (int)value;
}

static void read_object(conic_json *json, const manifest_member *members, int n, void *entry) {
  char key[CONIC_JSON_KEY_ROOM];
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key)) {
    int i = 0;
    while (i < n && !is_key(key, members[i].key))
      i++;
    if (i < n)
      read_member(json, &members[i], entry);
    else
      conic_json_skip(json);
  }
}

#define AT(type, member) offsetof(type, member), sizeof((type *)NULL)->member

static void read_scene_entry(conic_json *json, manifest_scene *scene) {
  static const manifest_member members[] = {
      {"name", WORD, AT(manifest_scene, name)},
      {"files", INNER_PATH, AT(manifest_scene, ply), .inner = "ply", .other = "gltf"},
      {"camera", INNER_PATH, AT(manifest_scene, camera), .inner = "conic"},
      {"width", NUMBER, AT(manifest_scene, width), 65535.0},
      {"height", NUMBER, AT(manifest_scene, height), 65535.0},
      {"stage", WORD, AT(manifest_scene, stage)},
      {"colors", WORD, AT(manifest_scene, colors)},
      {"step", NUMBER, AT(manifest_scene, step), 65535.0}};
  read_object(json, members, 8, scene);
  if (!scene->name[0] || !scene->ply[0] || !scene->camera[0] || !scene->width || !scene->height ||
      scene->step / 2 >= scene->width || scene->step / 2 >= scene->height)
    conic_json_wrong(json, "a scene lacks its name, its files.ply or files.gltf, its camera.conic, its width or its "
                           "height, or its step is larger");
}

static void read_case_entry(conic_json *json, suite_entry *one) {
  static const manifest_member members[] = {{"name", WORD, AT(suite_entry, name)},
                                            {"scene", WORD, AT(suite_entry, scene)},
                                            {"profile", WORD, AT(suite_entry, profile)},
                                            {"npy", PATH, AT(suite_entry, npy)},
                                            {"level", NUMBER, AT(suite_entry, level), SUITE_MOST_LEVELS}};
  read_object(json, members, 5, one);
  if (!one->name[0] || !one->scene[0] || !one->profile[0] || !one->npy[0] || !one->level)
    conic_json_wrong(json, "a case lacks its name, its scene, its profile, its npy or its level");
}

static void read_file_entry(conic_json *json, manifest_file *file) {
  static const manifest_member members[] = {{"path", PATH, AT(manifest_file, path)},
                                            {"sha256", WORD, AT(manifest_file, sha256)},
                                            {"bytes", COUNT, AT(manifest_file, bytes), 0x1p40}};
  read_object(json, members, 3, file);
  if (!file->path[0] || !file->bytes || strlen(file->sha256) != CONIC_SHA256_ROOM - 1)
    conic_json_wrong(json, "a file lacks its path, its bytes or its sha256");
}

/* Makes room for one more entry, which is zero; null after a failure. */
static void *add_entry(manifest_reader *r, void *array, size_t *n, size_t *room, size_t size) {
  void *added = NULL;
  if (*n == SUITE_MOST_ENTRIES)
    conic_json_wrong(&r->json, "there are more than 4096 scenes, cases or files");
  if (r->json.status == CONIC_OK && !(added = conic_memory_add(r->json.context, array, n, room, size)))
    r->json.status = CONIC_ERROR_MEMORY;
  return added;
}

static void read_entries(manifest_reader *r, const char *key) {
  conic_json *json = &r->json;
  suite_manifest *manifest = r->manifest;
  conic_json_begin_array(json);
  while (conic_json_next_item(json)) {
    if (is_key(key, "scenes")) {
      manifest_scene *scene = add_entry(r, &r->scenes, &r->n_scenes, &r->scene_room, sizeof *scene);
      if (scene)
        read_scene_entry(json, scene);
    } else if (is_key(key, "cases")) {
      suite_entry *one = add_entry(r, &manifest->cases, &manifest->n_cases, &r->case_room, sizeof *one);
      if (one)
        read_case_entry(json, one);
    } else {
      manifest_file *file = add_entry(r, &r->files, &r->n_files, &r->file_room, sizeof *file);
      if (file)
        read_file_entry(json, file);
    }
  }
}

static void read_members(manifest_reader *r) {
  static const manifest_member floats = {"name", WORD, AT(suite_manifest, floats)};
  char key[CONIC_JSON_KEY_ROOM], format[SUITE_WORD_ROOM];
  conic_json *json = &r->json;
  double version = 0.0;
  conic_json_begin_object(json);
  while (conic_json_next_member(json, key))
    if (is_key(key, "format")) {
      if (conic_json_text(json, format, sizeof format) == CONIC_OK)
        r->has_format = is_key(format, "conic-conformance");
    } else if (is_key(key, "version")) {
      if (conic_json_number(json, &version) == CONIC_OK && version != 1.0)
        conic_json_wrong(json, "the suite is of a version that this conic does not know");
    } else if (is_key(key, "floats"))
      read_object(json, &floats, 1, r->manifest);
    else if (is_key(key, "scenes") || is_key(key, "cases") || is_key(key, "files"))
      read_entries(r, key);
    else
      conic_json_skip(json);
  conic_json_end(json);
  if (!r->has_format || version != 1.0)
    conic_json_wrong(json, "it is no manifest of a suite: its format is not conic-conformance, or it has no version");
}

static int has_scene(manifest_reader *r, suite_entry *one) {
  for (size_t i = 0; i < r->n_scenes; i++) {
    const manifest_scene *scene = &r->scenes[i];
    if (strcmp(scene->name, one->scene) != 0)
      continue;
    memcpy(one->ply, scene->ply, sizeof one->ply);
    memcpy(one->camera, scene->camera, sizeof one->camera);
    one->width = scene->width;
    one->height = scene->height;
    one->step = scene->step;
    memcpy(one->stage, scene->stage, sizeof one->stage);
    memcpy(one->colors, scene->colors, sizeof one->colors);
    return 1;
  }
  return 0;
}

static int has_file(const manifest_reader *r, suite_entry *one) {
  for (size_t i = 0; i < r->n_files; i++)
    if (strcmp(r->files[i].path, one->npy) == 0) {
      memcpy(one->sha256, r->files[i].sha256, sizeof one->sha256);
      one->bytes = r->files[i].bytes;
      return 1;
    }
  return 0;
}

static void join_entries(manifest_reader *r) {
  suite_manifest *manifest = r->manifest;
  if (r->json.status == CONIC_OK && manifest->n_cases == 0)
    conic_json_wrong(&r->json, "there are no cases");
  for (size_t i = 0; r->json.status == CONIC_OK && i < manifest->n_cases; i++)
    if (!has_scene(r, &manifest->cases[i]) || !has_file(r, &manifest->cases[i]))
      conic_json_wrong(&r->json, "a case is of a scene that is not there, or its npy is not among the files");
}

conic_status cli_suite_read_manifest(conic_context *context, const char *path, suite_manifest *manifest) {
  manifest_reader r = {.manifest = manifest};
  memset(manifest, 0, sizeof *manifest);
  conic_status status = conic_json_open(context, path, &r.json);
  if (status != CONIC_OK)
    return status;
  read_members(&r);
  join_entries(&r);
  status = r.json.status;
  conic_json_close(&r.json);
  conic_memory_release_these(context, r.scenes, r.files);
  if (status != CONIC_OK)
    cli_suite_release_manifest(context, manifest);
  return status;
}

void cli_suite_release_manifest(conic_context *context, suite_manifest *manifest) {
  conic_memory_release(context, manifest->cases);
  memset(manifest, 0, sizeof *manifest);
}
