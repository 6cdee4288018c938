/* A ray tracer's answer to splats: Embree's oriented discs. Of each pixel's ray, all discs within a disc's radius
 * behind the nearest one are averaged with a Gaussian of the distance from their centres. Prints what building and a
 * frame took, as a median, in milliseconds, and writes the picture.
 *
 *   discs_embree SPLATS.ply CAMERA OUT.pfm FRAMES
 *
 * SPLATS.ply is as `run` beside this makes it (binary: x y z nx ny nz radius r g b), and the camera is eighteen
 * numbers: width, height, fx, fy, cx, cy, and the rows of world to camera without the last. One thread. */
#include <embree3/rtcore.h>

#include "peer_scene.h"

/* What a gathering ray has found. */
typedef struct disc_gather {
  struct RTCIntersectContext context;
  const peer_splat *splats;
  float sum[3], weight;
} disc_gather;

static float linear_of[256];

static RTCScene build(RTCDevice device, const peer_splat *splats, unsigned n) {
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  RTCGeometry discs = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
  float(*vertices)[4] = rtcSetNewGeometryBuffer(discs, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, n);
  float(*normals)[3] = rtcSetNewGeometryBuffer(discs, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, 12, n);
  for (unsigned i = 0; i < n; i++) {
    memcpy(vertices[i], splats[i].position, sizeof splats[i].position);
    vertices[i][3] = splats[i].radius;
    memcpy(normals[i], splats[i].normal, sizeof splats[i].normal);
  }
  rtcSetGeometryUserData(discs, (void *)splats);
  rtcCommitGeometry(discs);
  rtcAttachGeometry(scene, discs);
  rtcReleaseGeometry(discs);
  rtcCommitScene(scene);
  return scene;
}

/* Adds a disc and lets the ray go on; the outline is 1.5 standard deviations from its centre. */
static void take_disc(const struct RTCFilterFunctionNArguments *arguments) {
  disc_gather *g = (disc_gather *)arguments->context;
  const struct RTCRay *ray = (const struct RTCRay *)arguments->ray;
  const struct RTCHit *hit = (const struct RTCHit *)arguments->hit;
  const peer_splat *s = &g->splats[hit->primID];
  const float d[3] = {ray->dir_x, ray->dir_y, ray->dir_z}, from[3] = {ray->org_x, ray->org_y, ray->org_z};
  float square = 0.0f, deviation = s->radius / 1.5f;
  for (int i = 0; i < 3; i++) {
    float offset = from[i] + ray->tfar * d[i] - s->position[i];
    square += offset * offset;
  }
  float weight = expf(-0.5f * square / (deviation * deviation));
  for (int i = 0; i < 3; i++)
    g->sum[i] += weight * linear_of[s->color[i]];
  g->weight += weight;
  arguments->valid[0] = 0;
}

static struct RTCRayHit ray_through(const peer_camera *c, int x, int y) {
  struct RTCRayHit r;
  memset(&r, 0, sizeof r);
  double d[3] = {(x + 0.5 - c->c[0]) / c->f[0], (y + 0.5 - c->c[1]) / c->f[1], 1.0}, world[3], eye[3];
  for (int i = 0; i < 3; i++) {
    world[i] = eye[i] = 0.0;
    for (int k = 0; k < 3; k++) {
      world[i] += c->world_to_camera[k][i] * d[k];
      eye[i] -= c->world_to_camera[k][i] * c->world_to_camera[k][3];
    }
  }
  r.ray.org_x = (float)eye[0], r.ray.org_y = (float)eye[1], r.ray.org_z = (float)eye[2];
  r.ray.dir_x = (float)world[0], r.ray.dir_y = (float)world[1], r.ray.dir_z = (float)world[2];
  r.ray.tfar = INFINITY;
  r.ray.mask = ~0u;
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return r;
}

static void draw_pixel(RTCScene scene, const peer_camera *c, const peer_splat *splats, int x, int y, float rgb[3]) {
  disc_gather g = {.splats = splats};
  struct RTCRayHit nearest = ray_through(c, x, y), again = nearest;
  rtcInitIntersectContext(&g.context);
  rtcIntersect1(scene, &g.context, &nearest);
  if (nearest.hit.geomID == RTC_INVALID_GEOMETRY_ID)
    return;
  float length = sqrtf(nearest.ray.dir_x * nearest.ray.dir_x + nearest.ray.dir_y * nearest.ray.dir_y +
                       nearest.ray.dir_z * nearest.ray.dir_z);
  again.ray.tfar = nearest.ray.tfar + splats[nearest.hit.primID].radius / length;
  g.context.filter = take_disc;
  rtcIntersect1(scene, &g.context, &again);
  for (int i = 0; i < 3; i++)
    rgb[i] = g.weight > 0.0f ? g.sum[i] / g.weight : 0.0f;
}

int main(int argc, char **argv) {
  unsigned n;
  peer_camera c;
  if (argc != 5)
    fail_peer("usage: discs_embree SPLATS.ply CAMERA OUT.pfm FRAMES");
  peer_splat *splats = read_splats(argv[1], &n);
  read_peer_camera(argv[2], &c);
  int n_frames = atoi(argv[4]);
  if (!splats || n_frames < 1)
    fail_peer("no splats, or no frames");
  fill_linear(linear_of);
  float *rgb = calloc((size_t)c.width * (size_t)c.height, 3 * sizeof *rgb);
  double ms[n_frames];
  RTCDevice device = rtcNewDevice("threads=1");
  double start = spent_ms();
  RTCScene scene = build(device, splats, n);
  double built = spent_ms();
  for (int frame = 0; frame < n_frames; frame++) {
    double begun = spent_ms();
    memset(rgb, 0, (size_t)c.width * (size_t)c.height * 3 * sizeof *rgb);
    for (int y = 0; y < c.height; y++)
      for (int x = 0; x < c.width; x++)
        draw_pixel(scene, &c, splats, x, y, rgb + 3 * ((size_t)(c.height - 1 - y) * (size_t)c.width + (size_t)x));
    ms[frame] = spent_ms() - begun;
  }
  qsort(ms, (size_t)n_frames, sizeof *ms, compare_ms);
  write_peer_picture(argv[3], &c, rgb);
  printf("%.2f %.2f\n", built - start, ms[n_frames / 2]);
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return 0;
}
