#version 330
#include "surface.glsl"
// Skin: its texture in the diffuse light, and an oily highlight of the key light.
uniform sampler2D color_map;  // rgb, alpha = oiliness
uniform float roughness2;

void main() {
    vec4 skin = texture(color_map, v_uv);
    vec3 mirrored = vec3(skin.a * (highlight(roughness2) + v_sheen));
    out_color = shown(linear(skin.rgb) * v_light + mirrored, 1.0);
}
