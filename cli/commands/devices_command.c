/* conic devices: lists the devices that can draw. */
#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/json_write.h"

static void print_device(const conic_opencl_device *d) {
  printf("opencl:%d.%d  %s\n", d->i_platform, d->i_device, d->name);
  printf("            %s, %s, driver %s\n", d->platform, d->version, d->driver);
  printf("            %s, %d compute units, %.1f GiB\n", d->is_cpu ? "a CPU" : "a GPU or accelerator",
         d->n_compute_units, (double)d->memory_bytes / 1073741824.0);
  if (!d->has_double)
    puts("            no double precision: the host projects the splats for it");
  if (!d->rounds_correctly)
    puts("            does not round division and square root correctly: only with --allow-inexact");
}

static void report_device(cli_json *json, const conic_opencl_device *d) {
  char name[32];
  snprintf(name, sizeof name, "opencl:%d.%d", d->i_platform, d->i_device);
  cli_json_object(json, name);
  cli_json_texts(json, NULL, {"name", d->name}, {"platform", d->platform}, {"version", d->version},
                 {"driver", d->driver});
  cli_json_bool(json, "is_cpu", d->is_cpu);
  cli_json_bool(json, "has_double", d->has_double);
  cli_json_bool(json, "rounds_correctly", d->rounds_correctly);
  cli_json_counts(json, NULL, {"compute_units", (uint64_t)d->n_compute_units}, {"memory_bytes", d->memory_bytes});
  cli_json_close(json);
}

static int report_devices(cli_session *session, const conic_opencl_device *devices, size_t n) {
  cli_json *json;
  int exit_code = cli_json_open(session, &json);
  if (!json)
    return exit_code;
  cli_json_object(json, "devices");
  for (size_t i = 0; i < n; i++)
    report_device(json, &devices[i]);
  cli_json_close(json);
  return cli_json_finish(json);
}

static int list(cli_session *session) {
  conic_opencl_device *devices;
  size_t n;
  int exit_code = cli_session_open(session);
  if (exit_code != CLI_DONE)
    return exit_code;
  conic_status status = conic_opencl_devices(session->context, &devices, &n);
  if (status != CONIC_OK)
    return cli_exit_of(status);
  int prints = cli_json_leaves_text(session);
  for (size_t i = 0; i < n && prints; i++)
    print_device(&devices[i]);
  if (n == 0 && prints)
    puts("no OpenCL device; pictures are drawn on the CPU");
  exit_code = report_devices(session, devices, n);
  conic_opencl_devices_release(session->context, devices);
  return exit_code;
}

static int run_devices(cli_session *session, int argc, char **argv) {
  const char *positional[64];
  int n_positional = 0;
  if (argc > 64)
    return cli_usage("devices: there is nothing to name; see conic help devices");
  int exit_code = cli_parse(session, NULL, 0, argc, argv, positional, &n_positional);
  if (exit_code == CLI_DONE && n_positional)
    exit_code = cli_usage("devices: %s: there is nothing to name; see conic help devices", positional[0]);
  if (exit_code == CLI_DONE)
    exit_code = list(session);
  return exit_code < 0 ? CLI_DONE : exit_code;
}

const cli_command cli_devices = {
    .name = "devices",
    .summary = "lists the OpenCL devices that can draw",
    .usage = "conic devices [--json FILE]",
    .run = run_devices,
    .description = "Lists the devices that --device takes, and whether they round as they must for the same picture.",
};
