// SPDX-License-Identifier: Apache-2.0
import { makeOperatorList, makeParameters } from './controls.js';
import { makeCurves } from './curves.js';
import { file, findOperator, operators, page } from './data.js';
import { button, h, say, short } from './dom.js';
import { Renderer } from './gpu.js';
import { whyNot } from './hdr.js';
import { makeDialects, makeParity, onOpen } from './parity.js';
import { measure, readPicture } from './picture.js';
import { makeProbe, probeRows } from './probe.js';
import { computeSomeRows, reference } from './reference.js';
import { cubeOf, makeSave, toneOf } from './save.js';
import { change, hdrValuesOf, MODES, onChange, setStatistics, state, TABS } from './state.js';
import { makeView } from './view.js';

const TITLES = { picture: 'Picture', curves: 'Curves', parity: 'Parity', dialects: 'Dialects',
    single: 'Single', wipe: 'Wipe', side: 'Side by side', grid: 'Grid of 4' };

let renderer = null;
try {
    renderer = new Renderer(h('canvas', { 'aria-hidden': true }));
} catch (error) {
    say(error.message);
}
const probe = makeProbe();
const view = makeView(renderer, probe.show);
const list = makeOperatorList();
const parameters = makeParameters();
const save = makeSave(view);
const curves = makeCurves();
const parity = makeParity();
const dialects = makeDialects();

// Pictures: embedded ones are decoded as dropped ones are.
function show(picture, name, embedded) {
    setStatistics(measure(picture));
    view.setPicture({ ...picture, name, embedded });
}
function open(bytes, name, embedded) {
    say('');
    try {
        show(readPicture(bytes), name, embedded);
        return true;
    } catch (error) {
        say(`${name}: ${error.message}`);
        return false;
    }
}
function openEmbedded() {
    const picture = page.pictures[state.picture];
    open(file(picture.file).slice().buffer, picture.name, picture);
    change();
}
async function openFile(dropped) {
    if (!dropped) return;
    const bytes = await dropped.arrayBuffer().catch(() => null);
    if (!bytes) {
        say(`${dropped.name}: the file cannot be read`);
    } else if (open(bytes, dropped.name, null)) {
        choose.value = '';
        change({ zoom: 0, x: 0, y: 0 });
    }
    chosen.value = '';
}

const choose = h('select', { id: 'choose', onchange: () => { change({ picture: Number(choose.value), zoom: 0, x: 0, y: 0 }); openEmbedded(); } },
    ...page.pictures.map(({ name }, i) => h('option', { value: i }, name)), h('option', { value: '', hidden: true }, 'dropped picture'));
choose.value = state.picture;
const chosen = h('input', { type: 'file', id: 'open', accept: '.exr,.hdr', hidden: true, onchange: () => openFile(chosen.files[0]) });
const exposure = h('input', { type: 'range', id: 'exposure', min: -10, max: 10, step: 0.05, oninput: () => change({ exposure: Number(exposure.value) }) });
const stops = h('input', { type: 'number', min: -20, max: 20, step: 0.1, 'aria-label': 'Exposure in stops, as a number',
    onchange: () => change({ exposure: Math.min(Math.max(Number(stops.value) || 0, -20), 20) }) });
const modes = MODES.map((mode) => button(TITLES[mode], () => change({ mode })));
const wipe = h('input', { type: 'range', id: 'wipe', min: 0, max: 1, step: 0.01, oninput: () => change({ wipe: Number(wipe.value) }) });
const wipeLabel = h('label', { for: 'wipe' }, 'Wipe', wipe);
const toggles = { falseColor: button('False color', () => change({ falseColor: !state.falseColor })),
    clipping: button('Clipping', () => change({ clipping: !state.clipping }), { title: 'Stripes where a channel reaches white (orange) or all are black (blue)' }) };
const hdr = button('HDR', () => change({ hdr: !state.hdr }), { title: "Show the operator's HDR version" });
const hdrNote = h('span', { class: 'note' });
function updateHdr() {
    const why = whyNot();
    const op = findOperator(state.slots[0].op);
    hdr.hidden = why !== '';
    hdr.setAttribute('aria-pressed', state.hdr);
    hdrNote.textContent = why || (!state.hdr ? '' : !op.hdr ? `${op.title} has no HDR version; this is SDR.`
        : state.mode !== 'single' ? 'The Single view shows HDR; this is SDR.'
            : state.falseColor || state.clipping ? 'Without false color and clipping, this view shows HDR.' : '');
}
matchMedia('(dynamic-range: high)').addEventListener('change', () => change());
const zoomText = h('span', { class: 'note' });
const tools = h('div', { class: 'tools' },
    h('label', { for: 'choose' }, 'Picture', choose),
    button('Open EXR or HDR', () => chosen.click()), chosen,
    h('label', { for: 'exposure' }, 'Exposure', exposure), stops,
    h('div', { class: 'group', role: 'group', 'aria-label': 'View' }, ...modes), wipeLabel,
    h('div', { class: 'group', role: 'group', 'aria-label': 'Marks' }, ...Object.values(toggles)),
    h('div', { class: 'group', role: 'group', 'aria-label': 'Zoom' }, button('Fit', () => change({ zoom: 0, x: 0, y: 0 })),
        button('1:1', () => view.zoomTo(1)), button('-', () => view.zoomTo(view.zoom() / 2), { 'aria-label': 'Zoom out' }),
        button('+', () => view.zoomTo(view.zoom() * 2), { 'aria-label': 'Zoom in' }), zoomText), hdr, hdrNote);

const sections = {
    picture: h('section', { id: 'picture', 'aria-label': 'Picture' }, tools, view.stage,
        h('div', { id: 'side' }, ...list.elements, ...parameters.elements, save.element), probe.element),
    curves: curves.section, parity: parity.section, dialects: dialects.section,
};
for (const [name, section] of Object.entries(sections)) {
    section.setAttribute('role', 'tabpanel');
    section.setAttribute('aria-labelledby', `tab_${name}`);
    section.removeAttribute('aria-label');
    section.id ||= `panel_${name}`;
}
const tabs = TABS.map((name) => h('button', { type: 'button', role: 'tab', id: `tab_${name}`, 'aria-controls': sections[name].id, onclick: () => change({ tab: name }) }, TITLES[name]));
const tabList = document.getElementById('tabs');
tabList.append(...tabs);
tabList.addEventListener('keydown', (event) => {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    const next = (TABS.indexOf(state.tab) + by + TABS.length) % TABS.length;
    change({ tab: TABS[next] });
    tabs[next].focus();
});
document.querySelector('main').append(...Object.values(sections));

onChange(update);
function update() {
    TABS.forEach((name, i) => {
        const isChosen = name === state.tab;
        sections[name].hidden = !isChosen;
        tabs[i].setAttribute('aria-selected', isChosen);
        tabs[i].tabIndex = isChosen ? 0 : -1;
    });
    MODES.forEach((mode, i) => modes[i].setAttribute('aria-pressed', mode === state.mode));
    for (const [name, element] of Object.entries(toggles)) element.setAttribute('aria-pressed', state[name]);
    exposure.value = state.exposure;
    exposure.setAttribute('aria-valuetext', `${short(state.exposure)} stops`);
    if (document.activeElement !== stops) stops.value = short(state.exposure);
    wipe.value = state.wipe;
    wipeLabel.hidden = state.mode !== 'wipe';
    if (view.picture) zoomText.textContent = `${Math.round(100 * view.zoom())} %`;
    updateHdr();
    save.update();
    if (state.tab === 'dialects') dialects.draw();
}

onOpen((a, b) => {
    Object.assign(state.slots[0], { op: a.name, values: {} });
    Object.assign(state.slots[1], { op: b.name, values: {} });
    change();
});

addEventListener('dragover', (event) => {
    event.preventDefault();
    view.stage.classList.add('is-target');
});
addEventListener('dragleave', () => view.stage.classList.remove('is-target'));
addEventListener('drop', (event) => {
    event.preventDefault();
    view.stage.classList.remove('is-target');
    openFile(event.dataTransfer.files[0]);
});

// In idle time: the nodes of lattices, then what the next keys show.
const whenIdle = globalThis.requestIdleCallback ?? ((work) => setTimeout(() => work({ timeRemaining: () => 8 }), 50));
let isWaiting = true;  // until the picture is there
function workAhead() {
    if (isWaiting) return;
    isWaiting = true;
    whenIdle((deadline) => {
        isWaiting = false;
        if (computeSomeRows(() => deadline.timeRemaining() > 3) || view.drawAhead(list.neighbors())) workAhead();
    });
}
onChange(workAhead);

// Before the first paint: everything has its place, so that nothing jumps when the picture comes.
update();
list.update();
parameters.update();
curves.draw();
requestAnimationFrame(() => setTimeout(() => {
    openEmbedded();
    document.documentElement.dataset.ready = 'true';
    isWaiting = false;
    workAhead();
}));

// For tests and for the curious: the same functions that the page uses.
globalThis.tonewright = { operators, state, change, view, reference, cubeOf, toneOf,
    probe: (slot, x, y) => probeRows(state.slots[slot], view.picture, renderer, x, y), hdrValuesOf, findOperator };
