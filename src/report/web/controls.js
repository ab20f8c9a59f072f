// SPDX-License-Identifier: Apache-2.0
//
// The list of operators, and the parameters of the one that is chosen.
import { findOperator, operators } from './data.js';
import { button, h, short } from './dom.js';
import { activeSlot, change, isDefault, onChange, shownSlots, state, valuesOf } from './state.js';

const LETTERS = 'ABCD';

export function makeOperatorList() {
    const list = h('ul', { id: 'operators', role: 'listbox', tabindex: 0, 'aria-label': 'Operators' });
    const rows = operators.filter((op) => !op.facts.is_diagnostic).map((op, i) => {
        const row = h('li', { role: 'option', id: `operator${i}`, title: op.facts.character, onclick: () => choose(op) }, op.title);
        list.append(row);
        return { op, row, text: `${op.name} ${op.title} ${op.facts.character}`.toLowerCase() };
    });
    const search = h('input', { type: 'search', class: 'search', placeholder: 'Search operators', 'aria-label': 'Search operators',
        'aria-controls': 'operators', oninput: filter });
    const none = h('p', { class: 'note', hidden: true }, 'No operator has these words.');

    const visible = () => rows.filter(({ row }) => !row.hidden);
    function choose(op) {
        Object.assign(activeSlot(), { op: op.name, values: {} });
        change();
    }
    function filter() {
        const words = search.value.toLowerCase().split(/\s+/);
        for (const { row, text } of rows) row.hidden = !words.every((word) => text.includes(word));
        none.hidden = visible().length > 0;
    }
    function move(event) {
        const shown = visible();
        const at = shown.findIndex(({ op }) => op.name === activeSlot().op);
        const to = { ArrowDown: at + 1, ArrowUp: at < 0 ? shown.length - 1 : at - 1, Home: 0, End: shown.length - 1 }[event.key];
        if (to === undefined || (event.target === search && ['Home', 'End'].includes(event.key))) return;
        event.preventDefault();
        const next = shown[Math.min(Math.max(to, 0), shown.length - 1)];
        if (next) choose(next.op);
    }
    for (const element of [list, search]) element.addEventListener('keydown', move);

    const slots = h('div', { class: 'group', role: 'group', 'aria-label': 'Part of the view that the list changes' });
    function update() {
        const { op: name } = activeSlot();
        for (const { op, row } of rows) {
            const isChosen = op.name === name;
            row.setAttribute('aria-selected', isChosen);
            if (!isChosen) continue;
            list.setAttribute('aria-activedescendant', row.id);
            const { top, bottom } = row.getBoundingClientRect();
            const box = list.getBoundingClientRect();
            if (top < box.top) list.scrollTop -= box.top - top;
            if (bottom > box.bottom) list.scrollTop += bottom - box.bottom;
        }
        const shown = shownSlots();
        slots.hidden = shown.length < 2;
        slots.replaceChildren(...shown.map((slot, i) => button(`${LETTERS[i]}: ${findOperator(slot.op).title}`,
            () => change({ active: i }), { 'aria-pressed': String(i === state.active) })));
    }
    onChange(update);
    // Those that the arrow keys reach with one or two strokes.
    function neighbors() {
        const shown = visible();
        const at = shown.findIndex(({ op }) => op.name === activeSlot().op);
        return [1, -1, 2, -2].map((by) => shown[at + by]?.op).filter(Boolean);
    }
    return { elements: [h('h2', {}, 'Operators'), slots, search, list, none], update, neighbors };
}

// Sliders of numbers over several powers of ten are logarithmic.
function scaleOf({ min, max }) {
    const low = min ?? -10, high = max ?? 100;
    const isLog = low > 0 && high / low > 100;
    return isLog
        ? { toSlider: (x) => Math.log(x / low) / Math.log(high / low), fromSlider: (t) => low * (high / low) ** t }
        : { toSlider: (x) => (x - low) / (high - low), fromSlider: (t) => low + t * (high - low) };
}

export function makeParameters() {
    const box = h('div', { id: 'parameters' });
    const title = h('h2', {}, 'Parameters');
    const reset = button('Reset', () => { activeSlot().values = {}; change(); });
    let built = '';
    let rows = [];

    function build(op) {
        rows = [];
        box.replaceChildren();
        for (const parameter of op.facts.parameters) {
            if (!(parameter.name in (op.values ?? {}))) continue;
            const id = `parameter_${parameter.name}`;
            const scale = scaleOf(parameter);
            const set = (value) => {
                const limited = Math.min(Math.max(value, parameter.min ?? -Infinity), parameter.max ?? Infinity);
                if (Number.isFinite(limited)) activeSlot().values[parameter.name] = limited;
                change();
            };
            const slider = h('input', { type: 'range', min: 0, max: 1, step: 0.001, id, title: parameter.help,
                oninput: () => set(Number(scale.fromSlider(Number(slider.value)).toPrecision(4))) });
            const number = h('input', { type: 'number', step: 'any', min: parameter.min, max: parameter.max,
                'aria-label': `${parameter.name}, as a number`, onchange: () => set(Number(number.value)) });
            const label = parameter.name.replaceAll('_', ' ') + (parameter.unit ? ` (${parameter.unit})` : '');
            box.append(h('div', { class: 'parameter' }, h('label', { for: id, title: parameter.help }, label), slider, number));
            rows.push({ parameter, slider, number, scale });
        }
        const fixed = op.facts.parameters.filter(({ name }) => !(name in (op.values ?? {}))).map(({ name }) => name.replaceAll('_', ' '));
        if (fixed.length) box.append(h('p', { class: 'note' }, `Fixed in this page: ${fixed.join(', ')}.`));
        if (op.facts.parameters.some((p) => p.statistic && p.name in (op.values ?? {})))
            box.append(h('p', { class: 'note' }, 'The page measures the picture for this operator.'));
        box.append(h('p', { class: 'note' }, op.facts.character ? `${op.facts.character}. ` : '', `Source: ${op.facts.source}`));
        for (const warning of op.facts.warnings) box.append(h('p', { class: 'note' }, warning));
    }
    function update() {
        const slot = activeSlot();
        const op = findOperator(slot.op);
        if (built !== op.name) build(op);
        built = op.name;
        title.textContent = op.title;
        reset.disabled = isDefault(slot);
        const values = valuesOf(slot);
        for (const { parameter, slider, number, scale } of rows) {
            slider.value = scale.toSlider(values[parameter.name]);
            slider.setAttribute('aria-valuetext', short(values[parameter.name]));
            if (document.activeElement !== number) number.value = short(values[parameter.name], 6);
        }
    }
    onChange(update);
    return { elements: [title, box, reset], update };
}
