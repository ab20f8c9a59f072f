// Reinhard et al. 2002, eq. 4, on luminance.
#version 300 es
precision highp float;

uniform sampler2D scene;
in vec2 uv;
out vec4 color;

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

vec3 reinhardExtended(vec3 c, float white)
{
    float old = luminance(c);
    if (old <= 0.0) return vec3(0.0);
    float mapped = old * (1.0 + old / (white * white));
    mapped /= 1.0 + old;
    return c * (mapped / old);
}

void main() {
    color = vec4(reinhardExtended(texture(scene, uv).rgb, 4.0), 1.0);
}
