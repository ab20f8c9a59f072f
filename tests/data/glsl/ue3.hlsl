// Unreal Engine 3: code values of the power 2.2.
half3 Tonemap(half3 LinearColor)
{
    half3 Encoded = LinearColor / (LinearColor + (half3)0.155h) * 1.019h;
    return min(Encoded, 1.0h);
}
