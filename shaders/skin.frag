#version 330
#include "lighting.glsl"
// Skin: light that wraps round the edge of the shadow, red furthest, as it does under real skin.
uniform sampler2D color_map;  // rgb, alpha = oiliness

const vec3 WRAP = vec3(0.42, 0.20, 0.14);

void main() {
    vec3 normal = normalize(v_normal);
    vec3 view = -normalize(v_position);
    vec4 skin = texture(color_map, v_uv);
    vec3 albedo = linear(skin.rgb);
    float open = v_extra.x;
    // Light that bounces in a fold comes back coloured by the skin.
    vec3 openness = vec3(open) * (1.0 + (1.0 - open) * 0.9 * albedo);
    vec3 light = ambient(normal) * openness;
    float shine = 0.0;
    for (int i = 0; i < 3; i++) {
        float cosine = dot(normal, light_direction[i]);
        vec3 wrapped = clamp((cosine + WRAP) / (1.0 + WRAP), 0.0, 1.0);
        light += light_color[i] * wrapped * wrapped * mix(openness, vec3(1.0), 0.25);
        shine += light_color[i].g * max(cosine, 0.0) * glint(normal, view, light_direction[i], 0.11);
    }
    float gloss = skin.a * fresnel(dot(normal, view), 0.035) * open;
    out_color = shown(albedo * light + gloss * (shine * 3.2 + 0.5 * ambient(reflect(-view, normal))), 1.0);
}
