// SPDX-License-Identifier: Apache-2.0
//
// The table of `tonewright verify`, and how far dialects of one operator are apart.
import { operators, page } from './data.js';
import { button, codes, h } from './dom.js';
import { reference } from './reference.js';
import { change } from './state.js';

const COLUMNS = [
    { title: 'Operator', of: (row) => row.operator },
    { title: 'Backend', of: (row) => row.backend, isText: true },
    { title: 'Largest difference', of: (row) => 255 * row.max, text: codes },
    { title: '99.9 %', of: (row) => 255 * row.p999, text: codes },
    { title: 'Mean', of: (row) => 255 * row.mean, text: codes },
    { title: 'Bound', of: (row) => 255 * row.bound, text: codes },
    { title: 'Result', of: (row) => (row.bound === 0 ? `not run: ${row.note}` : row.ok ? 'within the bound' : `beyond the bound: ${row.note}`), isText: true },
];

export function makeParity() {
    const section = h('section', { class: 'page', 'aria-label': 'Parity' }, h('h2', {}, 'Parity with the double reference'));
    if (page.parity.length === 0) {
        section.append(h('p', {}, 'This page was made without the table. `tonewright verify` prints it.'));
        return { section };
    }
    const ran = page.parity.filter((row) => row.bound > 0);
    const exact = ran.filter((row) => row.max < 0.5 / 255);
    const worst = ran.reduce((a, b) => (b.max > a.max ? b : a), ran[0] ?? { max: 0 });
    section.append(h('p', {}, `Each backend computed thousands of colors. In ${exact.length} of ${ran.length} rows, the largest difference `
        + 'is below half a step of an 8-bit picture, so the rounded picture is the same or one step off where a value is on the edge. '
        + (worst.operator ? `The largest difference that you could see is ${codes(255 * worst.max)} of an 8-bit step: ${worst.operator}, ${worst.backend}.` : '')));
    const body = h('tbody', {});
    const heads = COLUMNS.map((column) => h('th', { scope: 'col', class: column.isText && 'text' }, button(column.title, () => sort(column))));
    let by = COLUMNS[0];
    let sign = -1;
    function sort(column) {
        sign = column === by ? -sign : typeof column.of(page.parity[0]) === 'number' ? -1 : 1;
        by = column;
        const compare = (a, b) => (typeof a === 'number' ? a - b : String(a).localeCompare(String(b)));
        const sorted = [...page.parity].sort((a, b) => sign * compare(by.of(a), by.of(b)));
        body.replaceChildren(...sorted.map((row) => h('tr', {}, ...COLUMNS.map((c) => h('td', { class: `${row.ok ? '' : 'bad'} ${c.isText ? 'text' : ''}` },
            c.text ? c.text(c.of(row)) : c.of(row))))));
        COLUMNS.forEach((c, i) => heads[i].setAttribute('aria-sort', c !== by ? 'none' : sign > 0 ? 'ascending' : 'descending'));
    }
    section.append(h('table', {}, h('caption', {}, 'Differences of sRGB code values from the reference, in steps of an 8-bit picture'),
        h('thead', {}, h('tr', {}, ...heads)), body));
    sort(COLUMNS[0]);
    return { section };
}

// Grays, hues at two saturations, and skin-like colors over exposure.
function testColors() {
    const colors = [];
    for (let stops = -6; stops <= 6; stops++) {
        const light = 0.18 * 2 ** stops;
        for (const saturation of [0, 0.5, 0.9]) {
            for (let hue = 0; hue < (saturation ? 12 : 1); hue++) {
                colors.push([0, 1, 2].map((c) => {
                    const full = Math.min(Math.max(Math.abs((hue / 2 + 6 - 2 * c) % 6 - 3) - 1, 0), 1);
                    return light * (1 - saturation + saturation * full);
                }));
            }
        }
    }
    return colors;
}

export function makeDialects() {
    const section = h('section', { class: 'page', id: 'dialects', 'aria-label': 'Dialects' }, h('h2', {}, 'Dialects: one name, several pictures'),
        h('p', { class: 'note' }, 'Mean difference of the pictures in 8-bit steps, over grays and 12 hues from -6 to 6 stops. '
            + 'Select a cell to see the two operators side by side.'));
    let isMade = false;
    function draw() {
        if (isMade) return;
        isMade = true;
        const families = new Map();
        for (const op of operators) {
            if (!op.glsl || !op.facts.dialects) continue;
            families.set(op.facts.dialects, [...(families.get(op.facts.dialects) ?? []), op]);
        }
        const colors = testColors();
        for (const [family, members] of families) {
            if (members.length > 1) section.append(h('h3', {}, `${family} in ${members.length} forms`), matrix(members, colors));
        }
        if (section.querySelector('table') === null)
            section.append(h('p', {}, 'None of the operators of this page have dialects here.'));
        section.append(h('h2', {}, 'Names of other programs'),
            h('p', { class: 'note' }, 'Tone mappers that other programs have under one name, and the operators that compute the same.'));
        for (const table of page.names) section.append(h('h3', {}, `"${table.name}"`), nameTable(table));
    }
    return { section, draw };
}

function matrix(members, colors) {
    const shown = members.map((op) => colors.map((color) => reference(op, color, 0, op.values)));
    const distance = (a, b) => {
        let sum = 0;
        shown[a].forEach((color, i) => color.forEach((x, c) => { sum += Math.abs(x - shown[b][i][c]); }));
        return 255 * sum / (3 * colors.length);
    };
    const short = (op) => op.title;
    const body = members.map((op, i) => h('tr', {}, h('th', { scope: 'row' }, short(op)), ...members.map((other, j) => {
        if (i === j) return h('td', {}, '0');
        const value = distance(i, j);
        const cell = button(value < 10 ? value.toFixed(1) : value.toFixed(0), () => {
            change({ tab: 'picture', mode: 'side', active: 0 });
            open(op, other);
        }, { 'aria-label': `${op.title} and ${other.title}: ${value.toFixed(1)}; show side by side` });
        // Dark to light of one hue, for every color vision.
        const light = Math.min(value / 40, 1);
        cell.style.background = `rgb(${30 + 215 * light} ${40 + 160 * light} ${70 + 10 * light})`;
        cell.style.color = light > 0.4 ? '#101010' : '#f4f4f4';
        return h('td', {}, cell);
    })));
    return h('table', {}, h('thead', {}, h('tr', {}, h('td', {}), ...members.map((op) => h('th', { scope: 'col' }, short(op))))), h('tbody', {}, ...body));
}

// Distances that the command computed, in the same unit.
function nameTable({ meanings, distances }) {
    const body = meanings.map(({ operator, uses }, i) => h('tr', {}, h('th', { scope: 'row' }, `${i + 1} ${operator}: ${uses.join(', ')}`),
        ...distances[i].map((value) => h('td', {}, value < 10 ? value.toFixed(1) : value.toFixed(0)))));
    return h('table', { class: 'names' }, h('thead', {}, h('tr', {}, h('td', {}), ...meanings.map((_, i) => h('th', { scope: 'col' }, i + 1)))),
        h('tbody', {}, ...body));
}

let open = () => {};
export const onOpen = (listener) => { open = listener; };
