/* SPDX-License-Identifier: Apache-2.0
 *
 * Runs void FUNCTION(const float scene[3], float display[3]) on the colors of a table. C and C++ compile it.
 *
 *   cc -DFUNCTION=tonemap -include ./engine.h run.c -lm -o run && ./run colors.csv
 *
 * Exit status: 0 if all rows are within their tolerances, 1 if not, 2 for misuse. */
#include <math.h>
#include <stdio.h>
#include <string.h>

/* A display of 8 bits shows nothing below 0 and above 1. NaN stays. */
static double shown(double value, int codes) { return !codes ? value : value < 0 ? 0 : value > 1 ? 1 : value; }

int main(int argc, char** argv) {
    const int codes = argc == 3 && strcmp(argv[2], "--codes") == 0;
    FILE* const table = argc == 2 || codes ? fopen(argv[1], "r") : NULL;
    char text[1024], group[32];
    double n[12], worst = 0; /* scene, display, tolerance in float, tolerance of a code value */
    int line = 0, worst_line = 0, rows = 0, failures = 0, c;
    if (!table) return fprintf(stderr, "usage: run TABLE [--codes]\n"), 2;
    while (fgets(text, sizeof text, table)) {
        float in[3], out[3];
        int is_far = 0;
        ++line;
        if (text[0] == '#' || strncmp(text, "group,", 6) == 0) continue;
        if (sscanf(text, "%31[^,],%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", group, n, n + 1, n + 2, n + 3, n + 4,
                   n + 5, n + 6, n + 7, n + 8, n + 9, n + 10, n + 11) != 13)
            return fprintf(stderr, "%s:%d: expected a word and 12 numbers\n", argv[1], line), 2;
        for (c = 0; c < 3; ++c) in[c] = (float)n[c];
        FUNCTION(in, out);
        ++rows;
        for (c = 0; c < 3; ++c) {
            double error = fabs(shown((double)out[c], codes) - shown(n[3 + c], codes));
            if (error != error) error = HUGE_VAL;
            if (error > worst) worst = error, worst_line = line;
            if (error > n[(codes ? 9 : 6) + c]) is_far = 1;
        }
        failures += is_far;
        if (!is_far) continue;
        printf("line %d, %s: (%g %g %g) gives (%g %g %g); expected (%g %g %g), tolerance (%g %g %g)\n", line, group, n[0],
               n[1], n[2], (double)out[0], (double)out[1], (double)out[2], n[3], n[4], n[5], n[codes ? 9 : 6],
               n[codes ? 10 : 7], n[codes ? 11 : 8]);
    }
    if (rows == 0) return fprintf(stderr, "%s: expected rows\n", argv[1]), 2;
    printf("%d colors, %d failures, largest error %g, line %d\n", rows, failures, worst, worst_line);
    return failures > 0;
}
