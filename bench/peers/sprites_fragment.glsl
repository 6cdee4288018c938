flat in vec3 disc_center, disc_normal, disc_color;
flat in float disc_radius;
uniform vec2 focal, center, size;
uniform float farthest;
uniform int is_visibility;
out vec4 sum;

/* The disc is met by the ray; the outline is 1.5 standard deviations from its centre. */
void main() {
  vec3 ray = vec3((vec2(gl_FragCoord.x, size.y - gl_FragCoord.y) - center) / focal, 1.0);
  float z = dot(disc_normal, disc_center) / dot(disc_normal, ray);
  vec3 offset = z * ray - disc_center;
  float square = dot(offset, offset) / (disc_radius * disc_radius);
  if (!(square < 1.0) || z <= 0.0)
    discard;
  gl_FragDepth = (is_visibility != 0 ? z + disc_radius : z) / farthest;
  float weight = exp(-0.5 * 2.25 * square);
  sum = vec4(weight * disc_color, weight);
}
