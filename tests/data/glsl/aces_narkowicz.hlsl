// K. Narkowicz, ACES Filmic Tone Mapping Curve, 2016, as HLSL.
static const float a = 2.51f, b = 0.03f, c = 2.43f, d = 0.59f, e = 0.14f;

float3 ACESFilm(float3 x)
{
    return saturate((x * (a * x + b)) / (x * (c * x + d) + e));
}

float4 main(float4 position : SV_Position, float3 color : COLOR0) : SV_Target
{
    return float4(ACESFilm(color), 1.0f);
}
