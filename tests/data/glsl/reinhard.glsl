// Reinhard et al. 2002, eq. 3, for numbers and for colors.
float reinhard(float x) {
    return x / (1.0 + x);
}

vec3 reinhard(vec3 c) {
    return c / (1.0 + c);
}
