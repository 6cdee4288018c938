#include "cli/outputs.h"

#include <errno.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/files/file.h"

/* Whether there is a folder that PATH can be written in; devices and pipes stand where they are. */
static int check_folder(const char *path) {
  char folder[4096];
  struct stat found;
  if (strcmp(path, "-") == 0 || (stat(path, &found) == 0 && !S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode)))
    return CLI_DONE;
  if (stat(path, &found) == 0 && S_ISDIR(found.st_mode))
    return cli_error(CLI_RESOURCE, "%s: cannot write: it is a directory", path);
  char target[4096];
  const char *real = conic_file_follow(path, target, sizeof target) ? target : path, *slash = strrchr(real, '/');
  int n = slash ? slash == real ? 1 : (int)(slash - real) : 0;
  if (n >= (int)sizeof folder)
    return CLI_DONE; /* whoever opens it will say so */
  snprintf(folder, sizeof folder, "%.*s", n, real);
  if (access(n ? folder : ".", W_OK | X_OK) != 0)
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

static int find_folder(const char *path, struct stat *found) {
  char folder[4096];
  int n = (int)(conic_file_name(path) - path);
  if (n >= (int)sizeof folder)
    return 0;
  snprintf(folder, sizeof folder, "%.*s", n, path);
  return stat(n ? folder : ".", found) == 0;
}

static int is_one(const struct stat *first, const struct stat *second) {
  return first->st_dev == second->st_dev && first->st_ino == second->st_ino;
}

/* Whether two names are those of one file, be it there or not; devices can be written to twice. */
static int is_same_file(const char *first, const char *second) {
  struct stat a, b;
  char first_target[4096], second_target[4096];
  if (strcmp(first, "-") == 0 || strcmp(second, "-") == 0 || strcmp(first, second) == 0)
    return strcmp(first, second) == 0 && strncmp(first, "/dev/", 5) != 0;
  int is_first = stat(first, &a) == 0, is_second = stat(second, &b) == 0;
  if (is_first || is_second)
    return is_first && is_second && S_ISREG(a.st_mode) && is_one(&a, &b);
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

int cli_check_inputs_stay(const cli_session *session, const char *const *inputs, int n_inputs,
                          const char *const *outputs, int n_outputs) {
  for (int i = 0; i < n_inputs; i++) {
    for (int j = 0; j <= n_outputs; j++) {
      const char *output = j < n_outputs ? outputs[j] : session->json_path;
      if (inputs[i] && output && strcmp(output, "-") != 0 && is_same_file(inputs[i], output))
        return cli_usage("%s: %s is an input, and would be written over", session->command, output);
    }
  }
  return CLI_DONE;
}

int cli_check_ending(const char *path, const char *ending) {
  static const char *const known[] = {"ply", "obj",  "las", "laz",  "xyz", "pts",  "cot", "lpc", "chy", "stl",
                                      "off", "gltf", "glb", "3mf",  "dae", "fbx",  "3ds", "x3d", "dxf", "amf",
                                      "exr", "png",  "jpg", "jpeg", "tif", "tiff", "pfm", "hdr", "json"};
  const char *slash = path ? strrchr(path, '/') : NULL, *dot = path ? strrchr(slash ? slash : path, '.') : NULL;
  if (!dot || strcasecmp(dot + 1, ending) == 0)
    return CLI_DONE;
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
    if (strcasecmp(dot + 1, known[i]) == 0)
      return cli_usage("%s: what is written is no .%s; give the name the ending .%s", path, known[i], ending);
  return CLI_DONE;
}
