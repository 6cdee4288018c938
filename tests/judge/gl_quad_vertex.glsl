// A quad a Gaussian, as an instance; in the order in which they are drawn. Follows a block of constants.
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
uniform vec2 size;
flat out vec2 place;
flat out vec4 form, color;

void main() {
  splat s = splats[list[gl_InstanceID]];
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  place = s.place;
  form = s.form;
  color = s.color;
  gl_Position = vec4((s.place + corner * s.extent) / size * 2.0 - 1.0, 0.0, 1.0);
}
