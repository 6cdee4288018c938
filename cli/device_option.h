/* --device, --isa: what draws. */
#pragma once

#include "cli/session.h"

typedef struct cli_device {
  const char *name; /* cpu, or opencl[:P.D][:gather|:lanes] */
  int allow_inexact;
  char own[64];  /* the name, where what was given has more */
  char used[32]; /* "cpu", "opencl:0.0": what it turned out to be */
} cli_device;

/* A parser of values, into a cli_device: NAME, or NAME:inexact. */
int cli_parse_device(const char *text, void *value);
/* CLI_DONE where the name is one, or CLI_USAGE after a message. */
int cli_device_check(const cli_session *session, const cli_device *device);

/* CLI_DONE where this machine and this build have the instruction set, or CLI_RESOURCE after a message. */
int cli_isa_check(const cli_session *session, conic_isa isa);

/* A renderer that draws there, which the caller destroys. Errors: UNSUPPORTED, MEMORY. */
conic_status cli_device_open(cli_session *session, cli_device *device, conic_renderer **renderer);
