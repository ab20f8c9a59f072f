// SPDX-License-Identifier: Apache-2.0
//
// Pictures as scene-linear Rec.709 light: RGBA in 32-bit floats, the top row first.
import parseExr from 'parse-exr';
import { toRec709 } from './color.js';
import { checkExr } from './exr_header.js';

const FLOAT = 1015;
const RGBA = 1023;

function readExr(buffer) {
    const { width, height, offset, primaries } = checkExr(buffer);
    const { width: dataWidth, height: dataHeight, data, format } = parseExr(buffer, FLOAT);
    const rgba = new Float32Array(4 * width * height);
    const channels = format === RGBA ? 4 : 1;
    const [left, right] = [Math.max(offset[0], 0), Math.min(offset[0] + dataWidth, width)];
    for (let y = Math.max(offset[1], 0); y < Math.min(offset[1] + dataHeight, height) && left < right; y++) {
        // parse-exr gives the bottom row first.
        const start = dataWidth * (dataHeight - 1 - (y - offset[1]));
        const row = data.subarray(channels * (start + left - offset[0]), channels * (start + right - offset[0]));
        const to = 4 * (width * y + left);
        if (channels === 4) rgba.set(row, to);
        else row.forEach((value, x) => rgba.set([value, value, value, 1], to + 4 * x));
    }
    if (primaries) convert(rgba, toRec709(primaries));
    return { width, height, rgba };
}

function convert(rgba, m) {
    if (!m.flat().every(Number.isFinite)) throw new Error('its chromaticities are impossible');
    const isIdentity = m.every((row, i) => row.every((x, j) => Math.abs(x - (i === j ? 1 : 0)) < 1e-4));
    if (isIdentity) return;
    for (let i = 0; i < rgba.length; i += 4) {
        const [r, g, b] = rgba.subarray(i, i + 3);
        for (let c = 0; c < 3; c++) rgba[i + c] = m[c][0] * r + m[c][1] * g + m[c][2] * b;
    }
}

// Radiance: G. Ward, "Real Pixels", Graphics Gems II; scanlines new and old.
function readHdr(buffer) {
    const bytes = new Uint8Array(buffer);
    let at = 0;
    const line = () => {
        let text = '';
        while (bytes[at] !== 10) {
            if (at >= bytes.length || text.length > 4096) throw new Error('the file is truncated');
            text += String.fromCharCode(bytes[at++]);
        }
        at++;
        return text;
    };
    while (line() !== '');
    const size = /^-Y (\d+) \+X (\d+)$/.exec(line());
    if (!size) throw new Error('its orientation is unusual; expected -Y HEIGHT +X WIDTH');
    const [height, width] = [Number(size[1]), Number(size[2])];
    if (!(width * height > 0 && width * height <= 1 << 26)) throw new Error(`${width} x ${height} pixels are too many`);
    const rgba = new Float32Array(4 * width * height).fill(1);
    const row = new Uint8Array(4 * width);
    const take = () => {
        if (at >= bytes.length) throw new Error('the file is truncated');
        return bytes[at++];
    };
    for (let y = 0; y < height; y++) {
        const isNew = width >= 8 && width < 32768 && bytes[at] === 2 && bytes[at + 1] === 2 && !(bytes[at + 2] & 0x80);
        if (isNew) {
            at += 4;
            for (let c = 0; c < 4; c++) {
                for (let x = 0; x < width;) {
                    const code = take();
                    const count = code > 128 ? code - 128 : code;
                    if (count === 0 || x + count > width) throw new Error('a scanline is damaged');
                    const same = code > 128 ? take() : -1;
                    for (let k = 0; k < count; k++) row[4 * x++ + c] = same < 0 ? take() : same;
                }
            }
        } else {
            for (let x = 0, shift = 0; x < width;) {
                const pixel = [take(), take(), take(), take()];
                const isRun = pixel[0] === 1 && pixel[1] === 1 && pixel[2] === 1;
                const count = isRun ? pixel[3] * 2 ** shift : 1;
                if ((isRun && x === 0) || x + count > width) throw new Error('a scanline is damaged');
                const source = isRun ? row.slice(4 * (x - 1), 4 * x) : pixel;
                for (let k = 0; k < count; k++) row.set(source, 4 * x++);
                shift = isRun ? shift + 8 : 0;
            }
        }
        for (let x = 0; x < width; x++) {
            const scale = row[4 * x + 3] ? 2 ** (row[4 * x + 3] - 136) : 0;
            for (let c = 0; c < 3; c++) rgba[4 * (width * y + x) + c] = row[4 * x + c] * scale;
        }
    }
    return { width, height, rgba };
}

// @throws Error  in words for the user
export function readPicture(buffer) {
    const start = new Uint8Array(buffer, 0, Math.min(10, buffer.byteLength));
    const text = String.fromCharCode(...start);
    if (text.startsWith('#?')) return readHdr(buffer);
    if (start[0] === 0x76 && start[1] === 0x2f) return readExr(buffer);
    throw new Error('neither OpenEXR nor Radiance HDR');
}

// What operators that measure a picture take from it, by the words of `tonewright list --json`.
export function measure({ rgba }) {
    const limited = (x) => Math.min(Math.max(Number.isNaN(x) ? 0 : x, 0), 65504);
    let sum = 0, logs = 0, lit = 0, largest = 0;
    for (let i = 0; i < rgba.length; i += 4) {
        const y = 0.2126 * limited(rgba[i]) + 0.7152 * limited(rgba[i + 1]) + 0.0722 * limited(rgba[i + 2]);
        sum += y;
        largest = Math.max(largest, y);
        if (y > 0) {
            logs += Math.log(y);
            lit++;
        }
    }
    return {
        'log mean luminance': lit ? Math.exp(logs / lit) : 0,
        'mean luminance': sum / (rgba.length / 4),
        'maximum luminance': largest,
        'half the maximum luminance': largest / 2,
    };
}
