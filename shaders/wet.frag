#version 330
#include "surface.glsl"
// Teeth and tongue: wet, and lit through the lips.
uniform sampler2D color_map;
uniform float gloss;
uniform float roughness2;
uniform float lit;  // share of the light that comes in

void main() {
    vec3 color = linear(texture(color_map, v_uv).rgb) * v_light;
    out_color = shown((color + gloss * highlight(roughness2)) * lit, 1.0);
}
