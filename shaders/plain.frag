#version 330
#include "surface.glsl"
// Cloth and other dull surfaces.
uniform sampler2D color_map;

void main() {
    float side = gl_FrontFacing ? 1.0 : 0.45;
    out_color = shown(linear(texture(color_map, v_uv).rgb) * v_light * side, 1.0);
}
