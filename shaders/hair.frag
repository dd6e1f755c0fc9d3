#version 330
#include "surface.glsl"
// Hair and lashes, with holes where the coverage is low.
uniform sampler2D color_map;  // rgb, alpha = coverage
uniform float cutoff;  // coverage below which nothing is drawn; 0 blends
uniform float shine;

void main() {
    vec4 hair = texture(color_map, v_uv);
    float coverage = hair.a * v_extra.y;
    if (coverage < max(cutoff, 0.02)) discard;
    vec3 color = linear(hair.rgb);
    vec3 result = color * v_light + (shine * v_sheen) * (0.04 + color);
    out_color = shown(result, cutoff > 0.0 ? 1.0 : min(coverage, 1.0));
}
