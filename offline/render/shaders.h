// SPDX-License-Identifier: Apache-2.0
// The programs of the renderer. The geometry pass writes the ray depth of the surface point at the pixel's
// centre and the item's index; the colour pass lights it. Sharing one vertex shader keeps both passes on the
// same pixels. The colour pass comes in variants (TEXTURED, FILLS, GLOSS): a software rasteriser runs every
// branch of a shader for every pixel.
#pragma once

namespace sextant {

inline constexpr const char* kVertexShader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 colour;
layout(location = 3) in vec2 uv;
uniform mat4 clip_from_camera;
uniform mat4 camera_from_mesh;
out vec3 p_in_camera;
out vec3 n_in_camera;
out vec3 vertex_colour;
out vec2 vertex_uv;
void main() {
  vec4 p = camera_from_mesh * vec4(position, 1.0);
  p_in_camera = p.xyz;
  n_in_camera = mat3(camera_from_mesh) * normal;
  vertex_colour = colour;
  vertex_uv = uv;
  gl_Position = clip_from_camera * p;
}
)";

inline constexpr const char* kGeometryShader = R"(#version 330 core
in vec3 p_in_camera;
uniform int item;
layout(location = 0) out float ray_depth;
layout(location = 1) out int item_out;
void main() {
  ray_depth = length(p_in_camera);
  item_out = item;
}
)";

inline constexpr const char* kColourShader = R"(
in vec3 p_in_camera;
in vec3 n_in_camera;
in vec3 vertex_colour;
in vec2 vertex_uv;
uniform vec3 diffuse;
uniform sampler2D image;
uniform vec3 light_in_camera;
uniform float ambient;
uniform float strength;
uniform float gloss;
uniform int fill_count;
uniform vec3 fill_in_camera[3];
uniform float fill_strength[3];
layout(location = 0) out vec4 colour;
void main() {
  vec3 n = normalize(n_in_camera);
  if (dot(n, p_in_camera) > 0.0) n = -n;
  vec3 to_light = normalize(light_in_camera - p_in_camera);
  float lambert = max(0.0, dot(n, to_light));
  vec3 albedo = vertex_colour * diffuse;
#ifdef TEXTURED
  albedo *= texture(image, vec2(vertex_uv.x, 1.0 - vertex_uv.y)).rgb;
#endif
  float light = ambient + (1.0 - ambient) * strength * lambert;
  float shine = 0.0;
#ifdef GLOSS
  vec3 to_eye = normalize(-p_in_camera);
  shine = strength * pow(max(0.0, dot(n, normalize(to_light + to_eye))), 50.0);
#endif
#ifdef FILLS
  for (int i = 0; i < fill_count; ++i) {
    vec3 to_fill = normalize(fill_in_camera[i] - p_in_camera);
    light += fill_strength[i] * max(0.0, dot(n, to_fill));
#ifdef GLOSS
    shine += fill_strength[i] * pow(max(0.0, dot(n, normalize(to_fill + to_eye))), 50.0);
#endif
  }
#endif
  colour = vec4(albedo * light + gloss * shine, 1.0);
}
)";

}  // namespace sextant
