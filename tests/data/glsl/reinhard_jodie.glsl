// Jodie, 2017: Reinhard on luminance in the shadows, on channels in the lights.
vec3 reinhard_jodie(vec3 v)
{
    float l = dot(v, vec3(0.2126, 0.7152, 0.0722));
    vec3 tv = v/(1.0 + v);
    return mix(v/(1.0 + l), tv, tv);
}
