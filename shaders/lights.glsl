// The lights of a picture, for vertex and fragment shaders. Colours are linear inside; textures
// and the picture hold their square roots, a gamma of 2, which costs no power function.
uniform vec3 light_direction[3];  // towards the key, fill and rim light, camera frame
uniform vec3 light_color[3];
uniform vec3 ambient_above;
uniform vec3 ambient_below;

vec3 ambient(vec3 normal) {
    return mix(ambient_above, ambient_below, 0.5 + 0.5 * normal.y);
}

// The GGX distribution without its constant factors; alpha2 is roughness to the fourth.
float glint(vec3 normal, vec3 view, vec3 light, float alpha2) {
    float cosine = dot(normal, normalize(light + view));
    float spread = cosine * cosine * (alpha2 - 1.0) + 1.0;
    return alpha2 / (spread * spread);
}

float fresnel(float cosine, float facing) {
    float rest = 1.0 - clamp(cosine, 0.0, 1.0);
    float square = rest * rest;
    return facing + (1.0 - facing) * square * square * rest;
}
