#version 330
#include "lights.glsl"
// Places and lights a vertex. It may hang between the head and the body: in_extra.x is 0 on the
// head and 1 at the base of the neck, so that the neck bends instead of breaking.
//
// Diffuse light is found here and not per pixel: the meshes are dense where the light changes,
// and a machine that draws on its CPU has ten times more pixels than vertices.
uniform mat4 head_to_camera;
uniform mat4 body_to_camera;
uniform mat4 projection;
// How far light reaches round the edge of the shadow, by colour: red furthest in skin.
uniform vec3 wrap = vec3(0.2);
uniform float roughness2 = 0.11;
// Light that bounces in a fold comes back in this colour.
uniform vec3 bounce = vec3(0.0);
// Strands of hair run away from this direction of the model frame; zero for no strands.
uniform vec3 whorl = vec3(0.0);

in vec3 in_position;  // mm, model frame
in vec3 in_normal;
in vec2 in_uv;
in vec4 in_extra;  // hold of the body, openness, two values of the material

out vec3 v_position;  // mm, camera frame
out vec3 v_normal;
out vec3 v_half;  // between the key light and the view
out float v_key;  // strength of the key light's highlight
out vec3 v_model;  // mm, model frame
out vec2 v_uv;
out vec3 v_extra;
out vec3 v_light;
out float v_sheen;

// Hair shines along a line across its strands (Kajiya and Kay 1989).
float strand_gleam(vec3 tangent, vec3 light, vec3 view) {
    float along = dot(tangent, normalize(light + view));
    float across = 1.0 - along * along;
    across *= across;
    across *= across;
    return across * across * across;
}

void main() {
    mat4 to_camera = head_to_camera * (1.0 - in_extra.x) + body_to_camera * in_extra.x;
    vec4 place = to_camera * vec4(in_position, 1.0);
    vec3 normal = normalize(mat3(to_camera) * in_normal);
    vec3 view = -normalize(place.xyz);
    float open = in_extra.y;
    vec3 openness = vec3(open) * (1.0 + (1.0 - open) * bounce);
    vec3 tangent = mat3(to_camera) * normalize(in_normal * dot(in_normal, whorl) - whorl);
    bool strands = dot(whorl, whorl) > 0.0;
    vec3 light = ambient(normal) * openness;
    float sheen = strands ? 0.0 : fresnel(dot(normal, view), 0.035) * dot(ambient(reflect(-view, normal)), vec3(0.17));
    for (int i = 0; i < 3; i++) {
        vec3 direction = light_direction[i];
        float cosine = dot(normal, direction);
        vec3 wrapped = clamp((cosine + wrap) / (1.0 + wrap), 0.0, 1.0);
        light += light_color[i] * wrapped * wrapped * mix(openness, vec3(1.0), 0.25);
        if (strands) {
            sheen += light_color[i].g * strand_gleam(tangent, direction, view) * wrapped.x;
        } else if (i > 0) {
            sheen += 0.1 * light_color[i].g * max(cosine, 0.0) * glint(normal, view, direction, roughness2);
        }
    }
    v_position = place.xyz;
    v_normal = normal;
    v_half = normalize(light_direction[0] + view);
    v_key = 0.1 * light_color[0].g * max(dot(normal, light_direction[0]), 0.0) * open;
    v_model = in_position;
    v_uv = in_uv;
    v_extra = in_extra.yzw;
    v_light = light;
    v_sheen = sheen * open;
    if (!strands) v_sheen += v_key * glint(normal, view, light_direction[0], roughness2);
    gl_Position = projection * place;
}
