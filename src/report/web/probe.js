// SPDX-License-Identifier: Apache-2.0
//
// One pixel: what goes in, and what each backend makes of it.
import { file, findOperator, page } from './data.js';
import { codes, h, short } from './dom.js';
import { reference } from './reference.js';
import { isDefault, shownSlots, state, valuesOf } from './state.js';

const measured = new Map();
function differences(name) {
    if (!measured.has(name)) {
        const bytes = file(name);
        measured.set(name, new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength));
    }
    return measured.get(name);
}

// What was measured when the page was made, at the nearest pixel of a grid; or why there is nothing.
function backendRows(slot, op, picture, x, y) {
    const embedded = picture.embedded;
    const why = !embedded ? 'not measured for a dropped picture'
        : op.facts.parameters.some((p) => p.statistic) ? 'not measured for operators that measure the picture'
            : !isDefault(slot) || state.exposure !== 0 ? 'measured at exposure 0 and the default parameters only' : '';
    const name = embedded && op.measured?.[state.picture];
    if (why || !name) return page.backends.map((backend) => ({ name: backend, why: why || 'not measured' }));
    const { step, width, height } = embedded;
    const [nx, ny] = [Math.min(Math.round(x / step), Math.floor((width - 1) / step)), Math.min(Math.round(y / step), Math.floor((height - 1) / step))];
    const columns = Math.ceil(width / step);
    const points = columns * Math.ceil(height / step);
    const at = 4 * (picture.width * ny * step + nx * step);
    const exact = reference(op, [...picture.rgba.subarray(at, at + 3)], 0, valuesOf(slot));
    return page.backends.map((backend, i) => {
        const difference = [0, 1, 2].map((c) => differences(name).getInt16(2 * (3 * (points * i + columns * ny + nx) + c), true) / 1024);
        return { name: backend, shown: exact.map((value, c) => value + difference[c] / 255), difference, at: [nx * step, ny * step] };
    });
}

export function probeRows(slot, picture, renderer, x, y) {
    const op = findOperator(slot.op);
    const at = 4 * (picture.width * y + x);
    const scene = [...picture.rgba.subarray(at, at + 3)];
    if (!op.glsl) return { op, scene, rows: [], measured: [] };
    const values = valuesOf(slot);
    const exact = reference(op, scene, state.exposure, values);
    const rows = [{ name: 'Reference, 64-bit float', shown: exact, difference: null }];
    if (renderer) {
        const shown = renderer.probe(op, values, state.exposure, x, y);
        rows.push({ name: 'Shader, on this machine', shown, difference: shown.map((value, c) => 255 * (value - exact[c])) });
    }
    return { op, scene, rows, measured: backendRows(slot, op, picture, x, y) };
}

export function makeProbe() {
    const box = h('section', { id: 'probe', 'aria-label': 'Pixel', tabindex: 0 });
    function show(picture, renderer, pixel) {
        if (!picture || !pixel) {
            box.replaceChildren(h('p', { class: 'note' }, 'Point at a pixel, or focus the picture and press the arrow keys.'));
            return;
        }
        const slot = shownSlots()[pixel.slot] ?? shownSlots()[0];
        const { op, scene, rows, measured: others } = probeRows(slot, picture, renderer, pixel.x, pixel.y);
        const cells = (values, digits) => values.map((v) => h('td', {}, digits === undefined ? short(v, 6) : v.toFixed(digits)));
        const body = h('tbody', {}, h('tr', {}, h('th', { scope: 'row' }, 'Scene, linear'), ...cells(scene), h('td', {}, '')));
        const line = (row) => {
            const worst = row.difference && Math.max(...row.difference.map(Math.abs));
            return h('tr', {}, h('th', { scope: 'row' }, row.name), ...cells(row.shown.map((v) => 255 * v), 3),
                h('td', { class: worst >= 1 ? 'bad' : '' }, row.difference ? codes(worst) : ''));
        };
        body.append(...rows.map(line));
        const why = others.find((row) => row.why)?.why;
        const place = others.find((row) => row.at)?.at;
        if (why) {
            body.append(h('tr', {}, h('td', { colspan: 5, class: 'text' }, `Engine, OpenColorIO and LUT: ${why}.`)));
        } else if (place) {
            const isHere = place[0] === pixel.x && place[1] === pixel.y;
            body.append(h('tr', {}, h('td', { colspan: 5, class: 'text' }, 'Measured when the page was made'
                + (isHere ? ':' : `, at the nearest measured pixel, ${place[0]}, ${place[1]}:`))), ...others.map(line));
        }
        if (rows.length === 0)
            body.append(h('tr', {}, h('td', { colspan: 5 }, 'This operator looks at the surroundings of a pixel; no shader does that.')));
        const head = ['Backend', 'Red', 'Green', 'Blue', 'Difference'].map((text) => h('th', { scope: 'col' }, text));
        box.replaceChildren(h('table', {},
            h('caption', {}, `Pixel ${pixel.x}, ${pixel.y}, ${op.title}. Code values of 8 bits; difference from the reference.`),
            h('thead', {}, h('tr', {}, ...head)), body));
    }
    return { element: box, show };
}
