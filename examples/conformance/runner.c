/* Draws a conformance suite in plain C: what a runner is. `draw` follows gsplat-1.6; put yours in its place.
 *
 *   conic conformance suite --profile gsplat-1.6 --level 2
 *   cc -O2 runner.c -o runner -lm && mkdir pictures && ./runner suite pictures gsplat-1.6
 *   conic judge --suite suite --pictures pictures --profile gsplat-1.6 --level 2 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct camera {
  int width, height;
  double fx, fy, cx, cy, view[4][4]; /* world to camera, rows */
} camera;

typedef struct gaussian {
  double mean[3], scale[3], rotation[4], opacity, sh[3][16]; /* w, x, y, z; sh by channel */
  double place[2], z, form[3], color[3];                     /* what draw makes of it */
} gaussian;

static char *read_file(const char *folder, const char *name, size_t *size) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "rb");
  char *text = NULL;
  if (file && fseek(file, 0, SEEK_END) == 0 && (*size = (size_t)ftell(file), rewind(file), text = malloc(*size + 1)))
    text[fread(text, 1, *size, file)] = 0;
  if (!text)
    exit((perror(path), 1));
  fclose(file);
  return text;
}

static camera read_camera(const char *text) {
  static const char *const keys[] = {"\"width\":", "\"height\":", "\"fx\":", "\"fy\":", "\"cx\":", "\"cy\":"};
  double n[6];
  for (int k = 0; k < 6; k++)
    n[k] = strtod(strstr(text, keys[k]) + strlen(keys[k]), NULL);
  camera c = {(int)n[0], (int)n[1], n[2], n[3], n[4], n[5], {{0}}};
  const char *at = strstr(text, "world_to_camera") + strlen("world_to_camera\":");
  for (int k = 0; k < 16; k++)
    c.view[k / 4][k % 4] = strtod(at + strspn(at, " \n[],"), (char **)&at);
  return c;
}

/* Every property is a float. A record with a number that is not finite, or a quaternion of length 0, is left out. */
static gaussian *read_ply(const char *data, size_t *n, int *n_sh) {
  const char *body = strstr(data, "end_header\n") + strlen("end_header\n"), *at = data;
  size_t n_records = strtoul(strstr(data, "element vertex ") + strlen("element vertex "), NULL, 10), n_names = 0;
  static char names[80][24];
  while ((at = strstr(at, "property float ")) && at < body)
    sscanf(at += strlen("property float "), "%23s", names[n_names++]);
  gaussian *all = calloc(n_records + 1, sizeof *all);
  for (size_t i = *n = 0; i < n_records; i++) {
    gaussian g = {{0}};
    double sum = 0.0;
    int n_rest = 0;
    for (size_t k = 0; k < n_names; k++)
      n_rest += strncmp(names[k], "f_rest_", 7) == 0;
    for (size_t k = 0; k < n_names; k++) {
      float f;
      int which = (int)strtol(names[k] + strcspn(names[k], "0123456789"), NULL, 10);
      memcpy(&f, body + (i * n_names + k) * sizeof f, sizeof f);
      sum += f;
      if (strchr("xyz", names[k][0]) && !names[k][1])
        g.mean[names[k][0] - 'x'] = f;
      else if (strncmp(names[k], "f_dc_", 5) == 0)
        g.sh[which][0] = f;
      else if (strncmp(names[k], "f_rest_", 7) == 0) /* one channel after the other */
        g.sh[which / (n_rest / 3)][1 + which % (n_rest / 3)] = f;
      else if (strcmp(names[k], "opacity") == 0)
        g.opacity = (float)(1.0 / (1.0 + exp(-(double)f))); /* a logit */
      else if (strncmp(names[k], "scale_", 6) == 0)
        g.scale[which] = (float)exp((double)f); /* a logarithm */
      else if (strncmp(names[k], "rot_", 4) == 0)
        g.rotation[which] = f;
    }
    const double *q = g.rotation;
    *n_sh = 1 + n_rest / 3;
    if (isfinite(sum) && q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] > 0.0)
      all[(*n)++] = g;
  }
  return all;
}

#include "gsplat_draw.h" /* draw: RGBA over the background, rows from the top */

static void write_npy(const char *folder, const char *name, const camera *c, const float *rgba) {
  char path[4096], header[119];
  snprintf(path, sizeof path, "%s/%s.npy", folder, name);
  snprintf(header, sizeof header, "{'descr': '<f4', 'fortran_order': False, 'shape': (%d, %d, 4)}", c->height,
           c->width);
  FILE *file = fopen(path, "wb");
  if (!file)
    exit((perror(path), 1));
  fwrite("\x93NUMPY\1\0\x76\0", 1, 10, file); /* a header of 118 bytes, of which the last is a line's end */
  fprintf(file, "%-117s\n", header);
  fwrite(rgba, sizeof *rgba, 4 * (size_t)c->width * (size_t)c->height, file);
  if (fclose(file))
    exit((perror(path), 1));
}

int main(int argc, char **argv) {
  if (argc != 4)
    return fprintf(stderr, "runner SUITE PICTURES PROFILE\n"), 2;
  size_t size, n;
  int n_sh;
  char *cases = read_file(argv[1], "cases.tsv", &size), name[256], scene[256], view[256], profile[64];
  float behind[3];
  for (char *line = strtok(cases, "\n"); line; line = strtok(NULL, "\n")) {
    if (sscanf(line, "%255s %255s %255s %63s %f,%f,%f", name, scene, view, profile, behind, behind + 1, behind + 2) !=
            7 ||
        strcmp(profile, argv[3]) != 0)
      continue;
    char *ply = read_file(argv[1], scene, &size), *json = read_file(argv[1], view, &size);
    const camera c = read_camera(json);
    gaussian *gaussians = read_ply(ply, &n, &n_sh);
    float *rgba = calloc((size_t)c.width * (size_t)c.height, 4 * sizeof *rgba);
    draw(gaussians, n, n_sh, &c, behind, rgba);
    write_npy(argv[2], name, &c, rgba);
    free(rgba), free(gaussians), free(json), free(ply);
  }
  free(cases);
  return 0;
}
