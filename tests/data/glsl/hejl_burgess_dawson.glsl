// J. Hejl and R. Burgess-Dawson in J. Hable, Filmic Tonemapping Operators, 2010: code values of the power 2.2.
vec3 filmic(vec3 color)
{
    color = max(vec3(0.), color - vec3(0.004));
    color = (color*(6.2*color + .5))/(color*(6.2*color + 1.7) + 0.06);
    return color;
}
