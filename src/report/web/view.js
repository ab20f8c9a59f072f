// SPDX-License-Identifier: Apache-2.0
//
// The stage: panels of the picture, zoom and pan, the wipe line, the probe.
import { file, findOperator, page } from './data.js';
import { h, say } from './dom.js';
import { HdrRenderer, whyNot } from './hdr.js';
import { change, hdrValuesOf, onChange, shownSlots, state, valuesOf } from './state.js';

const SURROUND = 0.1255;

export function makeView(renderer, showProbe) {
    const canvas = renderer?.canvas;
    const line = h('div', { class: 'wipe', hidden: true });
    const cross = h('div', { class: 'cross', hidden: true });
    const labels = h('div', {});
    const images = h('div', {});
    const hdrCanvas = h('canvas', { id: 'hdr_canvas', 'aria-hidden': true, hidden: true });
    const stage = h('div', { id: 'stage', tabindex: 0, role: 'application',
        'aria-label': 'Picture. Arrow keys move the probe, plus and minus zoom, 0 fits the picture.' },
        canvas ?? '', hdrCanvas, images, line, cross, labels);
    canvas?.addEventListener('webglcontextlost', () => say('The browser stopped the graphics of this page; reload it.'));
    let picture = null;
    let pixel = null;
    let ratio = 1;
    const shownImages = new Map();

    const size = () => [canvas?.width ?? 1, canvas?.height ?? 1];
    function rects() {
        const [w, h2] = size();
        const half = [Math.floor(w / 2), Math.floor(h2 / 2)];
        if (state.mode === 'side') return [[0, 0, half[0], h2], [half[0], 0, w - half[0], h2]];
        if (state.mode === 'grid')
            return [0, 1, 2, 3].map((i) => [i % 2 ? half[0] : 0, i > 1 ? half[1] : 0, i % 2 ? w - half[0] : half[0], i > 1 ? h2 - half[1] : half[1]]);
        return [[0, 0, w, h2]];
    }
    const panelOf = (i) => rects()[Math.min(i, rects().length - 1)];
    function fitZoom() {
        const [, , w, h2] = panelOf(0);
        return Math.min(w / picture.width, h2 / picture.height);
    }
    const zoom = () => (state.zoom > 0 ? state.zoom : fitZoom());
    // The picture's pixel at the corner of a panel.
    function origin(rect) {
        const z = zoom();
        const center = state.zoom > 0 ? [state.x, state.y] : [picture.width / 2, picture.height / 2];
        const corner = [0, 1].map((i) => center[i] - rect[2 + i] / 2 / z);
        // On pixels of the canvas: in a panel with an odd size, a middle would lie on the edge of two pixels of the picture.
        return z < 1 ? corner : corner.map((at) => Math.round(at * z) / z);
    }
    function resize() {
        ratio = devicePixelRatio || 1;
        const { width, height } = stage.getBoundingClientRect();
        if (!canvas || !width) return;
        const to = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
        if (canvas.width === to[0] && canvas.height === to[1]) return;
        [canvas.width, canvas.height] = to;
        draw();
    }

    const falseColor = findOperator('false_color');
    function draw() {
        if (!picture || !renderer) return;
        renderer.clear(SURROUND);
        images.replaceChildren();
        labels.replaceChildren();
        shownSlots().forEach((slot, i) => {
            const rect = panelOf(i);
            const clip = [...rect];
            if (state.mode === 'wipe') {
                const split = Math.round(rect[2] * state.wipe);
                [clip[0], clip[2]] = i ? [split, rect[2] - split] : [0, split];
            }
            const op = findOperator(slot.op);
            drawPanel(slot, op, rect, clip);
            const label = h('span', { class: 'label' }, state.falseColor ? 'False color' : op.title);
            const isRight = state.mode === 'wipe' && i === 1;
            label.style.top = `${rect[1] / ratio + 6}px`;
            label.style[isRight ? 'right' : 'left'] = isRight ? '6px' : `${rect[0] / ratio + 6}px`;
            labels.append(label);
        });
        drawHdr();
        line.hidden = state.mode !== 'wipe';
        line.style.left = `${100 * state.wipe}%`;
        placeCross();
    }
    // A piece of the work for the operators that the next keys may show; false when nothing is left to do.
    function drawAhead(ops) {
        if (!picture || !renderer || state.tab !== 'picture' || state.falseColor) return false;
        const rect = panelOf(state.active);
        const panel = { exposure: state.exposure, rect, origin: origin(rect), zoom: zoom() };
        try {
            return ops.some((op) => op.glsl && renderer.drawAhead(op, { ...panel, values: valuesOf({ op: op.name, values: {} }) }));
        } catch {
            return false;  // draw() says why when the operator is chosen
        }
    }
    function drawPanel(slot, op, rect, clip) {
        const common = { exposure: state.exposure, rect, clip, origin: origin(rect), zoom: zoom() };
        try {
            if (state.falseColor && falseColor) renderer.draw(falseColor, { ...common, values: falseColor.values });
            else if (op.glsl) renderer.draw(op, { ...common, values: valuesOf(slot), marks: state.clipping });
            else drawShown(op, rect, clip);
        } catch (error) {
            say(`${op.title}: ${error.message}`);
        }
    }
    let hdr = null;  // a promise: WebGPU starts when it is first asked for
    function hdrRenderer() {
        hdr ??= HdrRenderer.make(hdrCanvas, () => {
            hdr = null;
            hdrCanvas.hidden = true;
            say('The browser stopped the graphics of the HDR view; the page shows SDR.');
            change({ hdr: false });
        });
        return hdr;
    }
    async function drawHdr() {
        const op = findOperator(state.slots[0].op);
        const isShown = () => state.hdr && !whyNot() && state.mode === 'single' && op.hdr && !state.falseColor && !state.clipping;
        hdrCanvas.hidden = !isShown();
        if (!isShown()) return;
        try {
            const drawer = await hdrRenderer();
            if (!isShown() || findOperator(state.slots[0].op) !== op) return;
            const [width, height] = size();
            if (hdrCanvas.width !== width || hdrCanvas.height !== height) Object.assign(hdrCanvas, { width, height });
            drawer.setPicture(picture);
            drawer.draw(op, hdrValuesOf(state.slots[0]), state.exposure, origin(panelOf(0)), zoom());
        } catch (error) {
            hdrCanvas.hidden = true;
            say(`HDR: ${error.message}`);
        }
    }
    // What a local operator showed of an embedded picture.
    function drawShown(op, rect, clip) {
        const name = picture.embedded?.shown[op.name];
        if (!name) {
            const text = h('p', { class: 'label' }, 'This operator looks at the surroundings of each pixel. A shader sees one pixel '
                + 'alone, so it cannot run on a picture that is dropped here; use `tonewright apply`.');
            Object.assign(text.style, { left: `${clip[0] / ratio + 12}px`, top: `${clip[1] / ratio + clip[3] / ratio / 2}px`, whiteSpace: 'normal' });
            labels.append(text);
            return;
        }
        if (!shownImages.has(name)) shownImages.set(name, URL.createObjectURL(new Blob([file(name)], { type: 'image/png' })));
        const box = h('div', {});
        const [ox, oy] = origin(rect);
        Object.assign(box.style, { position: 'absolute', overflow: 'hidden', left: `${clip[0] / ratio}px`, top: `${clip[1] / ratio}px`,
            width: `${clip[2] / ratio}px`, height: `${clip[3] / ratio}px` });
        const image = h('img', { src: shownImages.get(name), alt: `${op.title}, computed when the page was made` });
        const z = zoom() / ratio;
        Object.assign(image.style, { inset: 'auto', maxWidth: 'none', left: `${-ox * z + (rect[0] - clip[0]) / ratio}px`,
            top: `${-oy * z + (rect[1] - clip[1]) / ratio}px`, width: `${picture.width * z}px`, height: `${picture.height * z}px`,
            imageRendering: z >= 1 ? 'pixelated' : 'auto' });
        box.append(image);
        images.append(box);
        if (state.exposure !== 0) say(`${op.title} was computed at exposure 0.`);
    }

    // The slot and the pixel under a point of the stage.
    function find(event) {
        const box = stage.getBoundingClientRect();
        const at = [(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio];
        const all = rects();
        let i = all.findIndex(([x, y, w, h2]) => at[0] >= x && at[0] < x + w && at[1] >= y && at[1] < y + h2);
        if (i < 0) return null;
        const [ox, oy] = origin(all[i]);
        const place = [ox + (at[0] - all[i][0]) / zoom(), oy + (at[1] - all[i][1]) / zoom()];
        if (state.mode === 'wipe') i = at[0] / size()[0] < state.wipe ? 0 : 1;
        return { slot: i, place };
    }
    function probeAt(slot, x, y) {
        if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
        pixel = { slot, x, y };
        placeCross();
        schedule();
    }
    let pending = 0;
    // Once for each frame, however fast the pointer is.
    function schedule() {
        pending ||= requestAnimationFrame(() => {
            pending = 0;
            showProbe(picture, renderer, pixel);
        });
    }
    function placeCross() {
        cross.hidden = !pixel;
        if (!pixel) return;
        const rect = panelOf(Math.min(pixel.slot, rects().length - 1));
        const [ox, oy] = origin(rect);
        cross.style.left = `${(rect[0] + (pixel.x + 0.5 - ox) * zoom()) / ratio}px`;
        cross.style.top = `${(rect[1] + (pixel.y + 0.5 - oy) * zoom()) / ratio}px`;
    }

    function zoomTo(value, about) {
        if (!picture) return;
        const z = zoom();
        const next = Math.min(Math.max(value, fitZoom() / 4, 0.01), 64);
        const center = state.zoom > 0 ? [state.x, state.y] : [picture.width / 2, picture.height / 2];
        const fixed = about ?? center;
        change({ zoom: next, x: fixed[0] + (center[0] - fixed[0]) * z / next, y: fixed[1] + (center[1] - fixed[1]) * z / next });
    }

    const pointers = new Map();
    let isWiping = false;
    stage.addEventListener('pointerdown', (event) => {
        if (!picture) return;
        stage.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, [event.clientX, event.clientY]);
        const box = stage.getBoundingClientRect();
        isWiping = state.mode === 'wipe' && Math.abs((event.clientX - box.left) / box.width - state.wipe) * box.width < 14;
        const found = find(event);
        if (!found || isWiping) return;
        if (state.mode !== 'single') change({ active: found.slot });
        probeAt(found.slot, ...found.place.map(Math.floor));  // a finger does not hover
    });
    stage.addEventListener('pointermove', (event) => {
        if (!picture) return;
        const before = pointers.get(event.pointerId);
        if (!before) {
            const found = find(event);
            if (found) probeAt(found.slot, ...found.place.map(Math.floor));
            return;
        }
        const box = stage.getBoundingClientRect();
        if (isWiping) {
            change({ wipe: Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1) });
            return;
        }
        const others = [...pointers.entries()].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
        pointers.set(event.pointerId, [event.clientX, event.clientY]);
        if (others.length) {
            const distance = (a) => Math.hypot(a[0] - others[0][0], a[1] - others[0][1]);
            zoomTo(zoom() * distance([event.clientX, event.clientY]) / Math.max(distance(before), 1));
            return;
        }
        const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
        if (!dx && !dy) return;
        const center = state.zoom > 0 ? [state.x, state.y] : [picture.width / 2, picture.height / 2];
        change({ zoom: zoom(), x: center[0] - dx * ratio / zoom(), y: center[1] - dy * ratio / zoom() });
    });
    for (const name of ['pointerup', 'pointercancel'])
        stage.addEventListener(name, (event) => {
            pointers.delete(event.pointerId);
            isWiping = false;
        });
    stage.addEventListener('wheel', (event) => {
        event.preventDefault();
        const found = find(event);
        if (found) zoomTo(zoom() * 2 ** (-Math.sign(event.deltaY) / 2), found.place);
    }, { passive: false });
    stage.addEventListener('keydown', (event) => {
        if (!picture || event.ctrlKey || event.metaKey || event.altKey) return;
        const step = event.shiftKey ? 10 : 1;
        const move = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[event.key];
        if (move) {
            const at = pixel ?? { slot: 0, x: Math.floor(picture.width / 2), y: Math.floor(picture.height / 2) };
            const limit = (value, most) => Math.min(Math.max(value, 0), most - 1);
            probeAt(at.slot, limit(at.x + move[0], picture.width), limit(at.y + move[1], picture.height));
        } else if (event.key === '+' || event.key === '=') {
            zoomTo(zoom() * Math.SQRT2, pixel && [pixel.x + 0.5, pixel.y + 0.5]);
        } else if (event.key === '-') {
            zoomTo(zoom() / Math.SQRT2, pixel && [pixel.x + 0.5, pixel.y + 0.5]);
        } else if (event.key === '0') {
            change({ zoom: 0, x: 0, y: 0 });
        } else {
            return;
        }
        event.preventDefault();
    });

    onChange(() => {
        if (state.tab !== 'picture') return;
        draw();
        if (pixel) schedule();
    });
    new ResizeObserver(resize).observe(stage);
    return {
        stage, draw, drawAhead, zoomTo, zoom,
        setPicture(next) {
            renderer?.setPicture(next);
            picture = next;
            pixel = null;
            showProbe(null);
            resize();
            draw();
        },
        get picture() { return picture; },
        probeAt, canvas, hdrRenderer,
        pageVersion: page.version,
    };
}
