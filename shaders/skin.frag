#version 330
#include "surface.glsl"
// Skin: its texture in the diffuse light, and an oily shine, found at the vertices.
uniform sampler2D color_map;  // rgb, alpha = oiliness

void main() {
    vec4 skin = texture(color_map, v_uv);
    out_color = shown(linear(skin.rgb) * v_light + vec3(skin.a * v_sheen), 1.0);
}
