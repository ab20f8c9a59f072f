// SPDX-License-Identifier: Apache-2.0
//
// What the page shows, which is also its URL hash: a link shows the same.
import { findOperator, operators, page } from './data.js';

export const MODES = ['single', 'wipe', 'side', 'grid'];
export const TABS = ['picture', 'curves', 'parity', 'dialects'];
const LETTERS = 'abcd';

const first = operators.find((op) => !op.facts.is_diagnostic && op.glsl) ?? operators[0];
const defaults = () => {
    const usual = ['agx_blender', 'aces_20', 'hable', 'khronos_neutral'].map(findOperator).filter(Boolean);
    const slots = [...usual, ...operators.filter((op) => op.glsl && !op.facts.is_diagnostic), first].slice(0, 4);
    while (slots.length < 4) slots.push(slots.at(-1));
    return {
        tab: 'picture', picture: 0, exposure: 0, mode: 'single', active: 0, wipe: 0.5, falseColor: false, clipping: false, hdr: false,
        slots: slots.map((op) => ({ op: op.name, values: {} })), zoom: 0, x: 0, y: 0,
    };
};

export const state = defaults();
const listeners = [];
export const onChange = (listener) => listeners.push(listener);

// The parameters of a slot: those of the operator, with what the user has set and the picture says.
let statistics = {};
export const setStatistics = (found) => { statistics = found; };
export function valuesOf(slot) {
    const op = findOperator(slot.op);
    const values = { ...op.values };
    for (const parameter of op.facts.parameters) {
        const measured = statistics[parameter.statistic];
        if (measured > 0 && parameter.name in values)
            values[parameter.name] = Math.min(Math.max(measured, parameter.min ?? 0), parameter.max ?? Infinity);
    }
    return { ...values, ...slot.values };
}
// For the operator's HDR version, whose defaults may differ.
export function hdrValuesOf(slot) {
    const op = findOperator(slot.op);
    const decided = Object.entries(op.hdr.values).filter(([name, value]) => value !== op.values[name]);
    return { ...valuesOf(slot), ...Object.fromEntries(decided), ...slot.values };
}
export const isDefault = (slot) => Object.keys(slot.values).length === 0;

export const activeSlot = () => state.slots[state.active];
export const shownSlots = () => state.slots.slice(0, { single: 1, wipe: 2, side: 2, grid: 4 }[state.mode]);

function toHash() {
    const out = new URLSearchParams();
    const usual = defaults();
    for (const name of ['tab', 'picture', 'exposure', 'mode', 'active', 'wipe', 'zoom', 'x', 'y']) {
        if (state[name] !== usual[name]) out.set(name, typeof state[name] === 'number' ? Number(state[name].toFixed(4)) : state[name]);
    }
    for (const name of ['falseColor', 'clipping', 'hdr']) if (state[name]) out.set(name, 1);
    shownSlots().forEach((slot, i) => {
        out.set(LETTERS[i], slot.op);
        for (const [name, value] of Object.entries(slot.values)) out.set(`${LETTERS[i]}.${name}`, value);
    });
    return '#' + out;
}

// Whatever a link says is checked: it may come from anywhere.
function fromHash(hash) {
    const given = new URLSearchParams(hash.slice(1));
    const number = (name, low, high) => {
        const value = Number(given.get(name));
        if (given.has(name) && value >= low && value <= high) state[name] = value;
    };
    number('exposure', -20, 20);
    number('wipe', 0, 1);
    number('zoom', 0, 64);
    number('x', -1e6, 1e6);
    number('y', -1e6, 1e6);
    if (Number(given.get('picture')) < page.pictures.length) number('picture', 0, page.pictures.length - 1);
    number('active', 0, 3);
    state.active = Math.trunc(state.active);
    state.picture = Math.trunc(state.picture);
    if (MODES.includes(given.get('mode'))) state.mode = given.get('mode');
    if (TABS.includes(given.get('tab'))) state.tab = given.get('tab');
    state.falseColor = given.get('falseColor') === '1';
    state.clipping = given.get('clipping') === '1';
    state.hdr = given.get('hdr') === '1';
    state.slots.forEach((slot, i) => {
        const op = findOperator(given.get(LETTERS[i]));
        if (!op) return;
        slot.op = op.name;
        slot.values = {};
        for (const { name, min, max } of op.facts.parameters) {
            const text = given.get(`${LETTERS[i]}.${name}`);
            const value = Number(text);
            if (text !== null && name in (op.values ?? {}) && value >= (min ?? -Infinity) && value <= (max ?? Infinity))
                slot.values[name] = value;
        }
    });
    if (state.active >= shownSlots().length) state.active = 0;
}

let pending = 0;
export function change(changes = {}) {
    Object.assign(state, changes);
    if (state.active >= shownSlots().length) state.active = 0;
    clearTimeout(pending);
    // Browsers limit how often the address may change.
    pending = setTimeout(() => history.replaceState(null, '', toHash()), 250);
    for (const listener of listeners) listener();
}

export const link = () => location.href.split('#')[0] + toHash();

fromHash(location.hash);
addEventListener('hashchange', () => {
    fromHash(location.hash);
    for (const listener of listeners) listener();
});
