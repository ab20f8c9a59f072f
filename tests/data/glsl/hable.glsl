/* J. Hable, Filmic Tonemapping Operators, 2010,
   with macros. */
#define A 0.15
#define B 0.50
#define C 0.10
#define D 0.20
#define E 0.02
#define F 0.30
#define WHITE 11.2
#define curve(x) ((x*(A*x + C*B) + D*E)/(x*(A*x + B) + D*F) - E/F)

vec3 hable(vec3 color) {
    const float bias = 2.0;
    vec3 mapped = curve((bias*color));
    return mapped/curve(WHITE);
}
