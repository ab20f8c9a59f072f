// J. Hejl, 2015, with a default argument.
float3 ToneMapHejl2015(in float3 hdr, in float whitePt = 11.2f)
{
    float4 vh = float4(hdr, whitePt);
    float4 va = (1.435f * vh) + 0.05f;
    float4 vf = ((vh * va + 0.004f) / ((vh * (va + 0.55f) + 0.0491f))) - 0.0821f;
    return vf.xyz / vf.www;
}
