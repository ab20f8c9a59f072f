// Reinhard, then the power 1/2.2.
vec3 tonemapReinhard(vec3 color, float exposure)
{
    color *= exposure;
    color = color/(color + vec3(1.0));
    return pow(color, vec3(1.0/2.2));
}
