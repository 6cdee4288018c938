// What a Gaussian adds to a pixel; blending does the rest. Follows a block of constants.
uniform float alpha_least, alpha_most, pixel_centre, least_power;
flat in vec2 place;
flat in vec4 form, color;
layout(location = 0) out vec4 color_out;
layout(location = 1) out vec4 depth_out;

void main() {
  vec2 d = place - (floor(gl_FragCoord.xy) + pixel_centre);
  float power = -0.5 * (form.x * d.x * d.x + form.z * d.y * d.y) - form.y * d.x * d.y;
  if (power > 0.0 || power < least_power)
    discard;
  float alpha = min(alpha_most, form.w * FALLOFF(power));
  if (alpha < alpha_least)
    discard;
  color_out = vec4(color.rgb * alpha, alpha);
  depth_out = vec4(color.w * alpha, 0.0, 0.0, alpha);
}
