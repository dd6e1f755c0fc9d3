#version 330
// Places a vertex that hangs between the head and the body: in_extra.x is 0 on the head and 1
// at the base of the neck, so that the neck bends instead of breaking.
uniform mat4 head_to_camera;
uniform mat4 body_to_camera;
uniform mat4 projection;

in vec3 in_position;  // mm, model frame
in vec3 in_normal;
in vec2 in_uv;
in vec4 in_extra;  // hold of the body, openness to the sky, two values of the material

out vec3 v_position;  // mm, camera frame
out vec3 v_normal;
out vec3 v_model;  // mm, model frame
out vec2 v_uv;
out vec3 v_extra;

void main() {
    mat4 to_camera = head_to_camera * (1.0 - in_extra.x) + body_to_camera * in_extra.x;
    vec4 place = to_camera * vec4(in_position, 1.0);
    v_position = place.xyz;
    v_normal = mat3(to_camera) * in_normal;
    v_model = in_position;
    v_uv = in_uv;
    v_extra = in_extra.yzw;
    gl_Position = projection * place;
}
