#include "opencl/device_name.h"

#include <string.h>

/* The digits at *text as a number, and *text past them; -1 where there are none or too many. */
static int take_number(const char **text) {
  int number = 0, n_digits = 0;
  for (; **text >= '0' && **text <= '9' && n_digits < 4; (*text)++, n_digits++)
    number = 10 * number + (**text - '0');
  return n_digits ? number : -1;
}

/* ":P.D" at *text, and *text past it. */
static int take_device_place(const char **text, conic_device_name *name) {
  (*text)++;
  name->i_platform = take_number(text);
  if (**text != '.')
    return 0;
  (*text)++;
  name->i_device = take_number(text);
  return name->i_platform >= 0 && name->i_device >= 0;
}

int conic_device_name_read(const char *text, conic_device_name *name) {
  *name = (conic_device_name){-1, -1, CONIC_OPENCL_WORK_AUTO};
  if (!text || strncmp(text, "opencl", 6) != 0)
    return 0;
  text += 6;
  if (text[0] == ':' && text[1] >= '0' && text[1] <= '9' && !take_device_place(&text, name))
    return 0;
  if (strcmp(text, ":gather") == 0)
    name->work = CONIC_OPENCL_WORK_PIXELS;
  else if (strcmp(text, ":lanes") == 0)
    name->work = CONIC_OPENCL_WORK_TILES;
  return !*text || name->work != CONIC_OPENCL_WORK_AUTO;
}
