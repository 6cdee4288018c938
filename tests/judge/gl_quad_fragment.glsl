// What a Gaussian adds to a pixel; blending does the rest. Follows a block of constants.
flat in vec2 place;
flat in vec4 form, color;
layout(location = 0) out vec4 color_out;
layout(location = 1) out vec4 depth_out;

void main() {
  vec2 d = place - (floor(gl_FragCoord.xy) + PIXEL_CENTRE);
  float power = -0.5 * (form.x * d.x * d.x + form.z * d.y * d.y) - form.y * d.x * d.y;
  if (power > 0.0 || power < LEAST_POWER)
    discard;
  float alpha = min(ALPHA_MOST, form.w * FALLOFF(power));
  if (alpha < ALPHA_LEAST)
    discard;
  color_out = vec4(color.rgb * alpha, alpha);
  depth_out = vec4(color.w * alpha, 0.0, 0.0, alpha);
}
