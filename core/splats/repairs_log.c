#include "core/splats/repairs_log.h"

#include "core/base/base.h"

void conic_repairs_log(conic_context *context, const char *path, const conic_repairs *repairs) {
  const struct {
    size_t n;
    const char *what;
  } reasons[] = {{repairs->nan, "left out, not finite"},
                 {repairs->failed, "left out, no ellipse to be found"},
                 {repairs->zero, "given a normal or size, having none that is one"},
                 {repairs->duplicate, "at the place of another"},
                 {repairs->isolated, "far from all others, kept small"},
                 {repairs->clip, "clip lines dropped"},
                 {repairs->dots, "on no surface, drawn as dots"}};
  char text[768];
  int length = 0;
  for (size_t i = 0; i < sizeof reasons / sizeof reasons[0]; i++)
    if (reasons[i].n)
      length += snprintf(text + length, sizeof text - (size_t)length, "%s%zu %s", length ? ", " : "", reasons[i].n,
                         reasons[i].what);
  if (length)
    conic_log(context, CONIC_LOG_INFO, "%s: of the points: %s", path, text);
}
