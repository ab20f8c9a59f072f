// SPDX-License-Identifier: Apache-2.0
//
// Primaries of pictures, and Oklab for paths of hues.

const multiply = (a, b) => a.map((row) => b[0].map((_, j) => row.reduce((sum, x, k) => sum + x * b[k][j], 0)));
const apply = (m, v) => m.map((row) => row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
function inverse(m) {
    const [[a, b, c], [d, e, f], [g, i, j]] = m;
    const det = a * (e * j - f * i) - b * (d * j - f * g) + c * (d * i - e * g);
    return [
        [e * j - f * i, c * i - b * j, b * f - c * e],
        [f * g - d * j, a * j - c * g, c * d - a * f],
        [d * i - e * g, b * g - a * i, a * e - b * d],
    ].map((row) => row.map((x) => x / det));
}
const xyz = ([x, y]) => [x / y, 1, (1 - x - y) / y];

// Primaries as [[x, y] of red, green, blue, white].
function toXyz(primaries) {
    // Not divided by y, which is 0 in two of the primaries of XYZ itself.
    const columns = primaries.slice(0, 3).map(([x, y]) => [x, y, 1 - x - y]);
    const m = [0, 1, 2].map((i) => columns.map((column) => column[i]));
    const scale = apply(inverse(m), xyz(primaries[3]));
    return m.map((row) => row.map((x, i) => x * scale[i]));
}

const BRADFORD = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
export const REC709 = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];

// From light of these primaries to linear Rec.709, the white adapted as Bradford has it.
export function toRec709(primaries) {
    const from = apply(BRADFORD, xyz(primaries[3]));
    const to = apply(BRADFORD, xyz(REC709[3]));
    const scale = to.map((x, i) => [0, 1, 2].map((k) => (k === i ? x / from[i] : 0)));
    const adapt = multiply(inverse(BRADFORD), multiply(scale, BRADFORD));
    return multiply(inverse(toXyz(REC709)), multiply(adapt, toXyz(primaries)));
}

export const decodeSrgb = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);

// B. Ottosson, "A perceptual color space for image processing", 2020: of linear Rec.709.
export function oklab([r, g, b]) {
    const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return [
        0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
        1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
        0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
    ];
}
