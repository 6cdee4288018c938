// A fragment a pixel: the tile's Gaussians, front to back. Follows a block of constants.
struct splat {
  vec2 place, extent;
  vec4 form, color, key;
};
layout(std430, binding = 1) readonly buffer splat_block {
  splat splats[];
};
layout(std430, binding = 2) readonly buffer list_block {
  int list[];
};
layout(std430, binding = 3) readonly buffer tile_block {
  int tiles[]; // where the tile's part of the list begins; the next one's is its end
};
uniform float alpha_least, alpha_most, pixel_centre, least_power;
uniform int tiles_across;
layout(location = 0) out vec4 color_out;
layout(location = 1) out vec4 depth_out;

void main() {
  vec2 pixel = floor(gl_FragCoord.xy) + pixel_centre;
  int tile = int(gl_FragCoord.y) / 16 * tiles_across + int(gl_FragCoord.x) / 16, end = tiles[tile + 1];
  vec4 sum = vec4(0.0);
  float T = 1.0;
  for (int i = tiles[tile]; i < end; i++) {
    splat s = splats[list[i]];
    vec2 d = s.place - pixel;
    float power = -0.5 * (s.form.x * d.x * d.x + s.form.z * d.y * d.y) - s.form.y * d.x * d.y;
    if (power > 0.0 || power < least_power)
      continue;
    float alpha = min(alpha_most, s.form.w * FALLOFF(power));
    if (alpha < alpha_least)
      continue;
    float next = T * (1.0 - alpha);
    if (HAS_ENDED(next))
      break;
    sum += s.color * alpha * T;
    T = next;
  }
  color_out = vec4(sum.rgb, 1.0 - T);
  depth_out = vec4(sum.w, T, 0.0, 0.0);
}
