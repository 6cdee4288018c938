// A Gaussian a thread: what the screen sees of it. Follows a block of constants.
layout(local_size_x = 64) in;

struct splat {
  vec2 place, extent; // extent: half a box of pixels, 0 where nothing is drawn
  vec4 form;          // the inverse covariance, and the opacity
  vec4 color;         // and the depth
  vec4 key;           // by which it is sorted
};
layout(std430, binding = 0) readonly buffer scene_block {
  float scene[];
};
layout(std430, binding = 1) writeonly buffer splat_block {
  splat splats[];
};
uniform mat3 turn; // from the world to the camera
uniform vec3 shift, eye;
uniform vec2 focal, centre, size;
uniform float near_z, dilation, alpha_least;
uniform int count;

const int first_sh = 11;

vec3 sh(int at, int k) {
  int i = at + first_sh + 3 * k;
  return vec3(scene[i], scene[i + 1], scene[i + 2]);
}

vec3 color_from(int at, vec3 mean) {
  vec3 d = normalize(mean - eye), color = 0.28209479177387814 * sh(at, 0);
  float x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z;
#if SH_DEGREE > 0
  color += 0.4886025119029199 * (-y * sh(at, 1) + z * sh(at, 2) - x * sh(at, 3));
#endif
#if SH_DEGREE > 1
  color += 1.0925484305920792 * (x * y * sh(at, 4) - y * z * sh(at, 5) - x * z * sh(at, 7)) +
           0.31539156525252005 * (2.0 * zz - xx - yy) * sh(at, 6) + 0.5462742152960396 * (xx - yy) * sh(at, 8);
#endif
#if SH_DEGREE > 2
  color += -0.5900435899266435 * (y * (3.0 * xx - yy) * sh(at, 9) + x * (xx - 3.0 * yy) * sh(at, 15)) +
           2.890611442640554 * x * y * z * sh(at, 10) -
           0.4570457994644658 * (4.0 * zz - xx - yy) * (y * sh(at, 11) + x * sh(at, 13)) +
           0.3731763325901154 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy) * sh(at, 12) +
           1.445305721320277 * z * (xx - yy) * sh(at, 14);
#endif
  return max(color + 0.5, 0.0);
}

mat3 rotation(vec4 q) {
  q = QUATERNION(q);
  float r = q.x, x = q.y, y = q.z, z = q.w;
  return mat3(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + r * z), 2.0 * (x * z - r * y), //
              2.0 * (x * y - r * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + r * x), //
              2.0 * (x * z + r * y), 2.0 * (y * z - r * x), 1.0 - 2.0 * (x * x + y * y));
}

// xx, xy, yy on the screen.
vec3 covariance(int at, vec3 p) {
  mat3 M = rotation(vec4(scene[at + 6], scene[at + 7], scene[at + 8], scene[at + 9]));
  M[0] *= scene[at + 3];
  M[1] *= scene[at + 4];
  M[2] *= scene[at + 5];
  vec2 slope = p.xy / p.z, half_view = 0.5 * size / focal;
#if CLAMP == 1
  slope = clamp(slope, -1.3 * half_view, 1.3 * half_view);
#elif CLAMP == 2
  slope = clamp(slope, -(centre / focal + 0.3 * half_view), (size - centre) / focal + 0.3 * half_view);
#endif
  vec2 gain = focal / p.z;
  mat3 J = mat3(gain.x, 0.0, 0.0, 0.0, gain.y, 0.0, -gain * slope, 0.0), T = J * turn;
  mat3 sigma = T * (M * transpose(M)) * transpose(T);
  return vec3(sigma[0][0], sigma[0][1], sigma[1][1]);
}

vec2 place_on_screen(vec3 p) {
#if CLAMP == 1 // by way of clip space, as the original; counted from the first pixel's centre
  float w = 1.0 / (p.z + 0.0000001);
  vec2 seen = p.xy * (2.0 * focal / size) * w;
  return ((seen + 1.0) * size - 1.0) * 0.5;
#else
  return focal * p.xy / p.z + centre;
#endif
}

vec2 extent_of(vec3 c, float determinant, float opacity) {
#if CLAMP == 1
  float middle = 0.5 * (c.x + c.z);
  return vec2(ceil(3.0 * sqrt(middle + sqrt(max(0.1, middle * middle - determinant)))));
#elif CLAMP == 2
  if (opacity < alpha_least)
    return vec2(0.0);
  return ceil(min(3.33, sqrt(2.0 * log(opacity / alpha_least))) * sqrt(c.xz)) + 1.0;
#else
  return 3.0 * sqrt(c.xz) + 1.0;
#endif
}

void main() {
  int i = int(gl_GlobalInvocationID.x), at = i * STRIDE;
  if (i >= count)
    return;
  vec3 mean = vec3(scene[at], scene[at + 1], scene[at + 2]), p = turn * mean + shift;
  splat s = splat(vec2(0.0), vec2(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  if (IS_SEEN(p.z)) {
    vec3 c = covariance(at, p);
    float bare = c.x * c.z - c.y * c.y;
    c.xz += dilation;
    float determinant = c.x * c.z - c.y * c.y, opacity = scene[at + 10];
#ifdef COMPENSATION
    opacity *= sqrt(max(COMPENSATION, bare / determinant));
#endif
    if (determinant > 0.0) {
      s.place = place_on_screen(p);
      s.extent = extent_of(c, determinant, opacity);
      s.form = vec4(vec3(c.z, -c.y, c.x) / determinant, opacity);
      s.color = vec4(color_from(at, mean), p.z);
      s.key.x = KEY(p);
    }
  }
  splats[i] = s;
}
