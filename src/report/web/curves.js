// SPDX-License-Identifier: Apache-2.0
//
// Tone curves of grays over stops, and the paths of saturated colors as exposure rises.
import uPlot from 'uplot';
import { decodeSrgb, oklab } from './color.js';
import { findOperator } from './data.js';
import { h } from './dom.js';
import { reference } from './reference.js';
import { onChange, state, valuesOf } from './state.js';

// Okabe and Ito's palette, which people with color vision deficiencies can tell apart.
const COLORS = ['#56b4e9', '#e69f00', '#f0f0f0', '#cc79a7'];
const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3]];
const STOPS = Array.from({ length: 481 }, (_, i) => -12 + i / 20);

function gray(slot, stops) {
    const light = 0.18 * 2 ** stops;
    const [r, g, b] = reference(findOperator(slot.op), [light, light, light], 0, valuesOf(slot));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

// Operators that the picture shows, each once, as far as they have a curve.
function slots() {
    const seen = new Set();
    return state.slots.filter((slot) => findOperator(slot.op).glsl && !seen.has(slot.op) && seen.add(slot.op));
}

function marks(u) {
    const { ctx } = u;
    ctx.save();
    ctx.textAlign = 'left';
    ctx.font = `${12 * devicePixelRatio}px system-ui`;
    for (const [stops, text] of [[0, 'mid gray 0.18'], [Math.log2(1 / 0.18), 'white 1.0']]) {
        const x = u.valToPos(stops, 'x', true);
        ctx.strokeStyle = ctx.fillStyle = '#b4b4b4';
        ctx.setLineDash([4, 4]);
        ctx.beginPath();
        ctx.moveTo(x, u.bbox.top);
        ctx.lineTo(x, u.bbox.top + u.bbox.height);
        ctx.stroke();
        ctx.fillText(text, x + 4, u.bbox.top + (stops ? 28 : 14) * devicePixelRatio);
    }
    ctx.restore();
}

function drawPlot(box, hasSlope) {
    const all = slots();
    const codes = all.map((slot) => STOPS.map((stops) => 255 * gray(slot, stops)));
    const slopes = hasSlope ? codes.map((line) => line.map((_, i) => (i && i < line.length - 1 ? (line[i + 1] - line[i - 1]) * 10 : null))) : [];
    const axis = { stroke: '#e4e4e4', grid: { stroke: '#3c3c3c', width: 1 }, ticks: { stroke: '#757575' } };
    const series = (lines, scale, suffix) => lines.map((_, i) => ({
        label: findOperator(all[i].op).title + suffix, stroke: COLORS[i], dash: DASHES[i], scale, width: suffix ? 1 : 2,
        value: (_, v) => (v == null ? '' : v.toFixed(1)),
    }));
    box.replaceChildren();
    const width = Math.max(280, Math.min(box.clientWidth || 900, 1150));
    new uPlot({
        width, height: Math.min(460, Math.max(260, width / 2)),
        scales: { x: { time: false }, y: { range: [0, 260] } },
        axes: [{ ...axis, label: 'stops around 0.18' }, { ...axis, label: '8-bit code value, sRGB' },
            ...(hasSlope ? [{ ...axis, scale: 'slope', side: 1, label: 'codes for each stop', grid: { show: false } }] : [])],
        series: [{ label: 'stops', value: (_, v) => (v == null ? '' : v.toFixed(2)) }, ...series(codes, 'y', ''), ...series(slopes, 'slope', ', slope')],
        hooks: { draw: [marks] },
    }, [STOPS, ...codes, ...slopes], box);
}

// Twelve hues, from -6 to 8 stops, in the plane of Oklab's a and b.
function drawHues(slot) {
    const size = 280;
    const canvas = h('canvas', { width: 2 * size, height: 2 * size, role: 'img',
        'aria-label': `${findOperator(slot.op).title}: paths of twelve saturated hues as exposure rises` });
    Object.assign(canvas.style, { width: `${size}px`, height: `${size}px`, background: '#141414' });
    const ctx = canvas.getContext('2d');
    const place = (v) => size + v * size / 0.36;
    ctx.strokeStyle = '#555';
    ctx.beginPath();
    ctx.moveTo(0, size); ctx.lineTo(2 * size, size); ctx.moveTo(size, 0); ctx.lineTo(size, 2 * size);
    ctx.stroke();
    for (let hue = 0; hue < 12; hue++) {
        const base = [0, 1, 2].map((c) => Math.min(Math.max(Math.abs((hue / 2 + 6 - 2 * c) % 6 - 3) - 1, 0), 1));
        let before = null;
        for (let stops = -6; stops <= 8; stops += 0.25) {
            const code = reference(findOperator(slot.op), base.map((x) => x * 2 ** stops), 0, valuesOf(slot));
            const [, a, b] = oklab(code.map(decodeSrgb));
            const at = [place(a), place(-b)];
            if (before) {
                ctx.strokeStyle = `rgb(${code.map((x) => Math.round(255 * Math.max(x, 0.15))).join(' ')})`;
                ctx.lineWidth = 3;
                ctx.beginPath();
                ctx.moveTo(...before);
                ctx.lineTo(...at);
                ctx.stroke();
            }
            before = at;
        }
    }
    return h('figure', {}, canvas, h('figcaption', {}, findOperator(slot.op).title));
}

export function makeCurves() {
    const plot = h('div', { id: 'plot' });
    const hues = h('div', { id: 'hues', class: 'tools' });
    const slope = h('input', { type: 'checkbox', id: 'slope', onchange: draw });
    const section = h('section', { class: 'page', 'aria-label': 'Curves' },
        h('h2', {}, 'Tone curves of grays'),
        h('p', { class: 'note' }, 'The operators of the picture view, with their parameters, at exposure 0. Curves come from the 64-bit reference.'),
        h('p', {}, slope, ' ', h('label', { for: 'slope' }, 'Show the slope')), plot,
        h('h2', {}, 'Paths of saturated hues'),
        h('p', { class: 'note' }, 'Twelve hues of Rec.709 from -6 to 8 stops, in the plane of Oklab. A straight path keeps its hue; '
            + 'a path that returns to the center becomes white.'), hues);
    function draw() {
        if (state.tab !== 'curves') return;
        drawPlot(plot, slope.checked);
        hues.replaceChildren(...slots().map(drawHues));
    }
    onChange(draw);
    addEventListener('resize', draw);
    return { section, draw };
}
