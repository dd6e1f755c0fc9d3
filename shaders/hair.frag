#version 330
#include "lighting.glsl"
// Hair, lashes: strands that shine along a line across their direction (Kajiya and Kay 1989).
uniform sampler2D color_map;  // rgb, alpha = coverage
uniform float cutoff;  // coverage below which nothing is drawn; 0 blends
uniform float shine;

void main() {
    vec4 hair = texture(color_map, v_uv);
    float coverage = hair.a * v_extra.y;
    if (coverage < max(cutoff, 0.02)) discard;
    vec3 normal = normalize(v_normal);
    vec3 view = -normalize(v_position);
    // Strands run along v of the texture.
    vec3 tangent = normalize(dFdx(v_position) * dFdy(v_uv.x) - dFdy(v_position) * dFdx(v_uv.x));
    vec3 color = linear(hair.rgb);
    vec3 light = ambient(normal) * v_extra.x;
    vec3 gleam = vec3(0.0);
    for (int i = 0; i < 3; i++) {
        vec3 direction = light_direction[i];
        float along = dot(tangent, direction);
        float cosine = dot(normal, direction);
        float facing = clamp(0.3 + 0.7 * cosine, 0.0, 1.0);
        light += light_color[i] * facing * (0.35 + 0.65 * sqrt(max(1.0 - along * along, 0.0)));
        float half_along = dot(tangent, normalize(direction + view));
        float across = max(1.0 - half_along * half_along, 0.0);
        across *= across;
        across *= across;
        across *= across;
        gleam += light_color[i] * across * across * facing;
    }
    vec3 result = color * light * v_extra.x + shine * gleam * (0.04 + color) * v_extra.x;
    out_color = shown(result, cutoff > 0.0 ? 1.0 : clamp(coverage, 0.0, 1.0));
}
