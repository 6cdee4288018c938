#include "cli/device_option.h"

#include "core/lanes/instruction_sets.h"
#include "opencl/device_name.h"

int cli_parse_device(const char *text, void *value) {
  static const char inexact[] = ":inexact";
  cli_device *device = value;
  size_t length = strlen(text), n = length > sizeof inexact - 1 ? length - (sizeof inexact - 1) : length;
  device->name = text;
  if (strcmp(text + n, inexact) != 0)
    return *text != '\0';
  snprintf(device->own, sizeof device->own, "%.*s", (int)n, text);
  device->name = device->own;
  return device->allow_inexact = 1;
}

int cli_device_check(const cli_session *session, const cli_device *device) {
  conic_device_name name;
  if (strcmp(device->name, "cpu") == 0 || conic_device_name_read(device->name, &name))
    return CLI_DONE;
  return cli_usage("%s: --device takes cpu or opencl[:P.D][:gather|:lanes], not %s", session->command, device->name);
}

int cli_isa_check(const cli_session *session, conic_isa isa) {
  if (conic_isa_is_here(isa))
    return CLI_DONE;
  return cli_error(CLI_RESOURCE, "%s: this machine or build has no %s", session->command, conic_isa_name(isa));
}

/* Where programs that were built for a device are kept: $XDG_CACHE_HOME/conic, else ~/.cache/conic; null where there is
 * neither. */
static const char *cache_folder(char *folder, size_t room) {
  const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
  int n = -1;
  if (cache && cache[0] == '/')
    n = snprintf(folder, room, "%s/conic", cache);
  else if (home && home[0] == '/')
    n = snprintf(folder, room, "%s/.cache/conic", home);
  return n > 0 && (size_t)n < room ? folder : NULL;
}

conic_status cli_device_open(cli_session *session, cli_device *device, conic_renderer **renderer) {
  char folder[3072];
  conic_opencl_options options;
  conic_opencl_device found;
  conic_device_name name;
  snprintf(device->used, sizeof device->used, "cpu");
  if (!device->name || strcmp(device->name, "cpu") == 0)
    return conic_renderer_create(session->context, renderer);
  conic_opencl_options_init(&options);
  conic_device_name_read(device->name, &name);
  options.device = device->name;
  options.allow_inexact = device->allow_inexact;
  options.cache_folder = cache_folder(folder, sizeof folder);
  conic_status status = conic_opencl_renderer_create(session->context, &options, &found, renderer);
  if (status == CONIC_OK)
    snprintf(device->used, sizeof device->used, "opencl:%d.%d%s", found.i_platform, found.i_device,
             name.work == CONIC_OPENCL_WORK_AUTO    ? ""
             : name.work == CONIC_OPENCL_WORK_TILES ? ":lanes"
                                                    : ":gather");
  return status;
}
