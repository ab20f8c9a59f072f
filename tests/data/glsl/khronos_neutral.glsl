// Khronos PBR Neutral Tone Mapper, 2024: after its specification.
vec3 neutral(vec3 c)
{
    const float F90 = 0.04, start = 0.8 - F90, desaturation = 0.15;
    float darkest = min(c.r, min(c.g, c.b));
    c -= darkest < 2.0*F90 ? darkest - darkest*darkest/(4.0*F90) : F90;
    float peak = max(max(c.r, c.g), c.b);
    if (peak < start)
        return c;
    else {
        float d = 1.0 - start;
        float newPeak = 1.0 - d*d/(peak + d - start);
        c *= newPeak/peak;
        float g = 1.0/(desaturation*(peak - newPeak) + 1.0);
        return mix(vec3(newPeak), c, g);
    }
}
