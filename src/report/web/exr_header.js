// SPDX-License-Identifier: Apache-2.0
//
// Looks at an OpenEXR file before parse-exr does, which believes what a file says of itself: a picture must be of a kind
// that the page shows, its size must fit into memory, and no chunk may be missing.

const MOST_PIXELS = 1 << 26;
const LINES = { 0: 1, 1: 1, 2: 1, 3: 16, 4: 32, 5: 16, 6: 32, 7: 32, 8: 32, 9: 256 };

class Reader {
    constructor(buffer) {
        this.view = new DataView(buffer);
        this.at = 0;
    }
    bytes(count) {
        if (count < 0 || this.at + count > this.view.byteLength) throw new Error('the file is truncated');
        this.at += count;
        return this.at - count;
    }
    u8() { return this.view.getUint8(this.bytes(1)); }
    i32() { return this.view.getInt32(this.bytes(4), true); }
    f32() { return this.view.getFloat32(this.bytes(4), true); }
    offset() { return Number(this.view.getBigUint64(this.bytes(8), true)); }
    text(limit = 255) {
        let text = '';
        for (let c = this.u8(); c; c = this.u8()) {
            text += String.fromCharCode(c);
            if (text.length > limit) throw new Error('the header is damaged');
        }
        return text;
    }
}

const box = (reader) => [reader.i32(), reader.i32(), reader.i32(), reader.i32()];

function channelNames(reader, end) {
    const names = [];
    while (reader.at < end) {
        const name = reader.text();
        if (!name) break;
        names.push(name);
        reader.bytes(16);
    }
    return names;
}

// @throws Error  in words for the user
export function checkExr(buffer) {
    const reader = new Reader(buffer);
    if (reader.i32() !== 20000630) throw new Error('not an OpenEXR file');
    const flags = reader.i32() >>> 8;
    if (flags & 0x8) throw new Error('deep pictures have no pixels to show; flatten the picture first');
    if (flags & 0x10) throw new Error('it has several parts; write the part that you want into a file of its own');
    const found = {};
    for (let name = reader.text(); name; name = reader.text()) {
        reader.text();
        const size = reader.i32();
        const start = reader.bytes(size);
        const end = reader.at;
        reader.at = start;
        if (name === 'dataWindow') found.window = box(reader);
        if (name === 'displayWindow') found.shown = box(reader);
        if (name === 'channels') found.channels = channelNames(reader, end);
        if (name === 'compression') found.compression = reader.u8();
        if (name === 'tiles') found.tile = [reader.i32(), reader.i32(), reader.u8()];
        if (name === 'chromaticities') found.primaries = [0, 1, 2, 3].map(() => [reader.f32(), reader.f32()]);
        reader.at = end;
    }
    if (!found.window || !found.shown || !found.channels) throw new Error('the header is damaged');
    const [width, height] = sizeOf(found.window);
    const [shownWidth, shownHeight] = sizeOf(found.shown);
    if (!(found.compression in LINES)) throw new Error('its compression is unknown');
    if (found.compression === 6 || found.compression === 7)
        throw new Error('its compression, B44, is not supported; write the file with another one, such as ZIP');
    const has = (name) => found.channels.includes(name);
    if (!(has('R') && has('G') && has('B')) && !has('Y'))
        throw new Error(`it has no channels R, G and B; it has ${found.channels.slice(0, 8).join(', ')}`);
    checkChunks(reader, found, width, height);
    // Where the data lies in what viewers show.
    const offset = [found.window[0] - found.shown[0], found.window[1] - found.shown[1]];
    return { width: shownWidth, height: shownHeight, offset, primaries: found.primaries };
}

function sizeOf([left, top, right, bottom]) {
    const width = right - left + 1;
    const height = bottom - top + 1;
    if (!(width > 0 && height > 0)) throw new Error('the header is damaged');
    if (width * height > MOST_PIXELS)
        throw new Error(`${width} x ${height} pixels are too many for a page; expected at most ${MOST_PIXELS}`);
    return [width, height];
}

function checkChunks(reader, found, width, height) {
    let count = Math.ceil(height / LINES[found.compression]);
    if (found.tile) {
        const [x, y, mode] = found.tile;
        if (!(x > 0 && y > 0)) throw new Error('the header is damaged');
        if (mode & 0xf) throw new Error('it has several resolutions; write it with one');
        count = Math.ceil(width / x) * Math.ceil(height / y);
    }
    const table = reader.at;
    reader.bytes(8 * count);
    for (let i = 0; i < count; i++) {
        reader.at = table + 8 * i;
        const start = reader.offset();
        if (!(start >= table + 8 * count && start < reader.view.byteLength)) throw new Error('the file is truncated');
        reader.at = start;
        reader.bytes(found.tile ? 16 : 4);
        reader.bytes(reader.i32());
    }
}
