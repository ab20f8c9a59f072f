// H. Uchimura, HDR Theory and Practice, 2017, as shadertoys have it.
float uchimura(float x, float P, float a, float m, float l, float c, float b)
{
    float l0 = (P - m)*l/a;
    float S0 = m + l0, S1 = m + a*l0;
    float C2 = a*P/(P - S1);
    float w0 = 1.0 - smoothstep(0.0, m, x);
    float w2 = step(S0, x);
    float w1 = 1.0 - w0 - w2;
    float toe = m*pow(x/m, c) + b;
    float line = m + a*(x - m);
    float shoulder = P - (P - S1)*exp(-C2*(x - S0)/P);
    return toe*w0 + line*w1 + shoulder*w2;
}

vec3 tonemap(vec3 color)
{
    vec3 result;
    result.r = uchimura(color.r, 1., 1., .22, .4, 1.33, 0.);
    result.g = uchimura(color.g, 1., 1., .22, .4, 1.33, 0.);
    result[2] = uchimura(color[2], 1., 1., .22, .4, 1.33, 0.);
    return result;
}

void mainImage(out vec4 fragColor, in vec2 fragCoord)
{
    vec2 uv = fragCoord/iResolution.xy;
    vec3 color = vec3(0);
    for (int i = 0; i < 4; ++i)
        color += texture(iChannel0, uv + float(i)).rgb;
    fragColor = vec4(tonemap(color), 1.);
}
