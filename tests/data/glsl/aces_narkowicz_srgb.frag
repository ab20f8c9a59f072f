// Narkowicz' curve, then the encoding of sRGB: what the function returns is encoded.
vec3 toSrgb(vec3 linear)
{
    bvec3 isDark = lessThan(linear, vec3(0.0031308));
    vec3 higher = vec3(1.055)*pow(linear, vec3(1.0/2.4)) - vec3(0.055);
    vec3 lower = linear*vec3(12.92);
    return mix(higher, lower, isDark);
}

vec3 aces(vec3 x)
{
    return clamp(x*(2.51*x + 0.03)/(x*(2.43*x + 0.59) + 0.14), 0.0, 1.0);
}

vec3 shown(vec3 x)
{
    return toSrgb(aces(x));
}
