#version 330
#include "lights.glsl"
#include "surface.glsl"
// An eyeball: wet, with a cornea that bulges, an iris that lies deeper than the surface, and
// the shade of the lids on it.
in vec3 v_position;  // mm, camera frame
in vec3 v_model;  // mm, model frame

uniform sampler2D color_map;  // front view: distance from the centre = angle from the axis
uniform mat3 axes;  // columns: x, y and outward axis of the eye, camera frame
uniform vec3 center;  // of the eyeball, model frame
uniform vec4 lids;  // model frame from the centre, mm: x of both corners, y of upper, lower lid
uniform vec2 corners;  // y of the corners at small and large x

float lid_edge(float x, float middle) {
    float span = clamp((x - lids.x) / (lids.y - lids.x), 0.0, 1.0);
    float line = mix(corners.x, corners.y, span);
    return line + (middle - mix(corners.x, corners.y, 0.5)) * 4.0 * span * (1.0 - span);
}

void main() {
    vec3 normal = normalize(v_normal);
    vec3 view = -normalize(v_position);
    vec3 axis = axes[2];
    float ahead = dot(normal, axis);
    float cornea = smoothstep(0.845, 0.90, ahead);
    // Refraction: the iris is seen through the cornea, shifted against the view.
    vec2 slide = vec2(dot(view, axes[0]), dot(view, axes[1]));
    vec3 base = linear(texture(color_map, v_uv - 0.035 * cornea * slide).rgb);
    vec3 across = normal - axis * ahead;

    vec3 local = v_model - center;
    float below_upper = local.y - lid_edge(local.x, lids.z);
    float above_lower = lid_edge(local.x, lids.w) - local.y;
    float shade = smoothstep(-0.8, 4.2, below_upper) * smoothstep(-1.2, 2.0, above_lower);
    float side = (local.x - lids.x) / (lids.y - lids.x);
    shade *= smoothstep(-0.06, 0.22, side) * smoothstep(-0.06, 0.22, 1.0 - side);
    shade = 0.22 + 0.78 * shade;

    vec3 light = ambient(normal) * 1.1;
    for (int i = 0; i < 2; i++) {
        // The iris is a bowl: it is brightest opposite the light.
        float cosine = dot(normalize(normal - 1.15 * across * cornea), light_direction[i]);
        light += light_color[i] * clamp((cosine + 0.35) / 1.35, 0.0, 1.0) * 0.85;
    }
    vec3 bulged = normalize(normal - 0.46 * axis * cornea);
    vec3 mirrored = reflect(-view, bulged);
    float window = smoothstep(0.955, 0.978, dot(mirrored, light_direction[0]));
    float second = smoothstep(0.975, 0.99, dot(mirrored, light_direction[1]));
    float wet = fresnel(dot(bulged, view), 0.025);
    vec3 shine = light_color[0] * window * 0.75 + light_color[1] * second * 0.3
        + ambient(mirrored) * wet * 1.2;
    out_color = shown(base * light * shade + shine * smoothstep(0.25, 0.8, shade), 1.0);
}
