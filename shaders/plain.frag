#version 330
#include "lighting.glsl"
// Teeth, tongue, mouth, cloth: a coloured surface with one highlight.
uniform sampler2D color_map;
uniform float gloss;
uniform float roughness2;
uniform float lit;  // share of the light that comes in, for what lies inside the mouth

void main() {
    vec3 normal = normalize(gl_FrontFacing ? v_normal : -v_normal);
    vec3 view = -normalize(v_position);
    vec3 albedo = linear(texture(color_map, v_uv).rgb);
    float open = v_extra.x * lit;
    vec3 light = ambient(normal);
    float shine = 0.0;
    for (int i = 0; i < 3; i++) {
        float cosine = dot(normal, light_direction[i]);
        light += light_color[i] * clamp((cosine + 0.2) / 1.2, 0.0, 1.0);
        shine += light_color[i].g * max(cosine, 0.0) * glint(normal, view, light_direction[i], roughness2);
    }
    out_color = shown((albedo * light + vec3(gloss * shine)) * open, 1.0);
}
