#include "cli/outputs.h"

#include <strings.h>

#include "core/files/disk.h"
#include "core/files/file.h"

/* Whether there is a folder that PATH can be written in; devices and pipes stand where they are. */
static int check_folder(const char *path) {
  char folder[4096];
  conic_disk_entry found;
  if (strcmp(path, "-") == 0 || (conic_disk_look(path, &found) && !found.is_file && !found.is_folder))
    return CLI_DONE;
  if (conic_disk_look(path, &found) && found.is_folder)
    return cli_error(CLI_RESOURCE, "%s: cannot write: it is a directory", path);
  char target[4096];
  const char *real = conic_file_follow(path, target, sizeof target) ? target : path;
  int n = (int)(conic_file_name(real) - real);
  if (n >= (int)sizeof folder)
    return CLI_DONE; /* whoever opens it will say so */
  snprintf(folder, sizeof folder, "%.*s", n, real);
  if (!conic_disk_can_write_in(n ? folder : "."))
    return cli_error(CLI_RESOURCE, "%s: cannot write: %s", path, strerror(errno));
  return CLI_DONE;
}

/* What cannot be written is said before the work. */
static int check_folders(const cli_session *session, const char *const *paths, int n_paths) {
  int exit_code = CLI_DONE;
  for (int i = 0; i <= n_paths && exit_code == CLI_DONE; i++) {
    const char *path = i < n_paths ? paths[i] : session->json_path;
    if (path)
      exit_code = check_folder(path);
  }
  return exit_code;
}

static int find_folder(const char *path, conic_disk_entry *found) {
  char folder[4096];
  int n = (int)(conic_file_name(path) - path);
  if (n >= (int)sizeof folder)
    return 0;
  snprintf(folder, sizeof folder, "%.*s", n, path);
  return conic_disk_look(n ? folder : ".", found);
}

static int is_one(const conic_disk_entry *first, const conic_disk_entry *second) {
  return first->device == second->device && first->number == second->number;
}

/* Whether two names are those of one file, be it there or not; devices can be written to twice. */
static int is_same_file(const char *first, const char *second) {
  conic_disk_entry a, b;
  char first_target[4096], second_target[4096];
  if (strcmp(first, "-") == 0 || strcmp(second, "-") == 0 || strcmp(first, second) == 0)
    return strcmp(first, second) == 0 && strncmp(first, "/dev/", 5) != 0;
  int is_first = conic_disk_look(first, &a), is_second = conic_disk_look(second, &b);
  if (is_first || is_second)
    return is_first && is_second && a.is_file && is_one(&a, &b);
  return conic_file_follow(first, first_target, sizeof first_target) &&
         conic_file_follow(second, second_target, sizeof second_target) &&
         strcmp(conic_file_name(first_target), conic_file_name(second_target)) == 0 && find_folder(first_target, &a) &&
         find_folder(second_target, &b) && is_one(&a, &b);
}

int cli_check_outputs(const cli_session *session, const char *const *paths, int n_paths) {
  for (int i = 0; i < n_paths; i++) {
    for (int j = i + 1; j <= n_paths; j++) {
      const char *first = paths[i], *second = j < n_paths ? paths[j] : session->json_path;
      if (!first || !second || !is_same_file(first, second))
        continue;
      if (strcmp(first, "-") == 0)
        return cli_usage("%s: two outputs cannot both go to standard output", session->command);
      return cli_usage("%s: two outputs cannot both go to %s", session->command, second);
    }
  }
  return check_folders(session, paths, n_paths);
}

static const char *stands_for(const char *path, const char *standard) {
  return strcmp(path, "-") == 0 ? standard : path;
}

/* Of a URL, what is read only as a whole, and only from a file. */
static int is_for_disk(const char *name) {
  static const char *const whole[] = {"ply",  "obj", "stl", "off", "xyz", "pts",   "csv", "las", "pcd", "e57", "ptx",
                                      "gltf", "glb", "3mf", "dae", "fbx", "splat", "spz", "sog", "png", "exr", "jpg"};
  for (size_t i = 0; conic_layers_is_url(name) && i < sizeof whole / sizeof *whole; i++)
    if (strcasecmp(conic_file_ending(name), whole[i]) == 0)
      return 1;
  return 0;
}

int cli_check_inputs_stay(const cli_session *session, const char *const *inputs, int n_inputs,
                          const char *const *outputs, int n_outputs) {
  for (int i = 0; i < n_inputs; i++) {
    if (inputs[i] && is_for_disk(inputs[i]))
      return cli_error(
          CLI_INPUT,
          "%s: such a file is not read over the web; download it first (what is: .lpc, .chy, COPC, EPT and "
          "Potree 2)",
          inputs[i]);
    for (int j = 0; j <= n_outputs; j++) {
      const char *output = j < n_outputs ? outputs[j] : session->json_path;
      if (inputs[i] && output && is_same_file(stands_for(inputs[i], "/dev/stdin"), stands_for(output, "/dev/stdout")))
        return cli_usage("%s: %s is an input, and would be written over", session->command,
                         stands_for(output, "standard output"));
    }
  }
  return CLI_DONE;
}

int cli_check_ending(const char *path, const char *ending) {
  static const char *const known[] = {
      "ply", "obj", "las", "laz", "xyz", "pts", "cot",   "lpc", "chy",  "stl", "off",  "gltf", "glb", "3mf",  "dae",
      "fbx", "3ds", "x3d", "dxf", "amf", "exr", "png",   "jpg", "jpeg", "tif", "tiff", "pfm",  "hdr", "json", "csv",
      "txt", "pcd", "e57", "ptx", "spz", "sog", "splat", "npy", "npz",  "gif", "mp4",  "webm", "pdf", "svg"};
  const char *own = path ? conic_file_ending(path) : "";
  if (!*own || strcasecmp(own, ending) == 0)
    return CLI_DONE;
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
    if (strcasecmp(own, known[i]) == 0)
      return cli_usage("%s: what is written is no .%s; give the name the ending .%s", path, known[i], ending);
  return CLI_DONE;
}

void cli_name_attribute(conic_image *image, const char *name, const char *text, double value) {
  if (image->n_attributes == CONIC_MAX_ATTRIBUTES)
    return;
  conic_attribute *attribute = &image->attributes[image->n_attributes++];
  memset(attribute, 0, sizeof *attribute);
  snprintf(attribute->name, sizeof attribute->name, "%s", name);
  attribute->type = text ? CONIC_ATTRIBUTE_TEXT : CONIC_ATTRIBUTE_DOUBLE;
  if (text)
    snprintf(attribute->text, sizeof attribute->text, "%s", text);
  attribute->values[0] = value;
}
