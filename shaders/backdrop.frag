#version 330
uniform sampler2D color_map;
in vec2 v_uv;
out vec4 out_color;

void main() { out_color = vec4(texture(color_map, v_uv).rgb, 1.0); }
