// What surface.vert hands to every material's fragment shader.
in vec3 v_normal;
in vec3 v_half;  // between the key light and the view
in float v_key;  // strength of the key light's highlight
in vec2 v_uv;
in vec3 v_extra;  // openness to the light, two values of the material
in vec3 v_light;  // diffuse light
in float v_sheen;  // mirrored light of all lights and the surroundings

out vec4 out_color;

vec3 linear(vec3 color) { return color * color; }

// Soft shoulder for bright parts, then the display's gamma.
vec4 shown(vec3 color, float alpha) {
    vec3 soft = color * (1.0 + 0.22 * color) / (0.72 + color);
    return vec4(sqrt(max(soft, 0.0)), 1.0) * alpha;
}

float highlight(float roughness2) {
    float cosine = dot(normalize(v_normal), normalize(v_half));
    float spread = cosine * cosine * (roughness2 - 1.0) + 1.0;
    return v_key * roughness2 / (spread * spread);
}
