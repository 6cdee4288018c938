layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float radius;
layout(location = 3) in vec3 color;
uniform mat4x3 camera_from_world;
uniform vec2 focal, center, size;
flat out vec3 disc_center, disc_normal, disc_color;
flat out float disc_radius;

void main() {
  disc_center = camera_from_world * vec4(position, 1.0);
  disc_normal = mat3(camera_from_world) * normal;
  disc_radius = radius;
  disc_color = color;
  vec2 pixel = focal * disc_center.xy / disc_center.z + center;
  gl_Position = vec4(2.0 * pixel.x / size.x - 1.0, 1.0 - 2.0 * pixel.y / size.y, 0.0, 1.0);
  /* of the ball about the disc */
  float least = max(disc_center.z * disc_center.z - radius * radius, 1e-12);
  gl_PointSize = 2.0 * radius * max(focal.x, focal.y) / sqrt(least) + 1.0;
  if (disc_center.z <= radius || dot(disc_normal, disc_center) >= 0.0)
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}
