// AgX after B. Wrensch, Minimal AgX Implementation, 2023. It returns code values of the power 2.2.
const mat3 inset = mat3(
    0.842479062253094, 0.0423282422610123, 0.0423756549057051,
    0.0784335999999992, 0.878468636469772, 0.0784336,
    0.0792237451477643, 0.0791661274605434, 0.879142973793104);
const mat3 outset = mat3(
     1.19687900512017, -0.0528968517574562, -0.0529716355144438,
    -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
    -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
const float minEv = -12.47393, maxEv = 4.026069;

vec3 contrast(vec3 x)
{
    vec3 x2 = x*x;
    vec3 x4 = x2*x2;
    return + 15.5*x4*x2 - 40.14*x4*x + 31.96*x4 - 6.868*x2*x + 0.4298*x2 + 0.1191*x - 0.00232;
}

vec3 look(vec3 val, float saturation)
{
    float luma = dot(val, vec3(0.2126, 0.7152, 0.0722));
    return luma + saturation*(val - luma);
}

vec3 agx(vec3 val)
{
    val = inset*val;
    val = clamp(log2(val), minEv, maxEv);
    val = (val - minEv)/(maxEv - minEv);
    val = contrast(val);
    val = look(val, 1.0);
    return outset*val;
}
