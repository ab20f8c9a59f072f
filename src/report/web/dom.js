// SPDX-License-Identifier: Apache-2.0

// An element. Properties that begin with "on" are listeners, others attributes; false and null leave one out.
export function h(tag, properties = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(properties)) {
        if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
        else if (value !== false && value != null) element.setAttribute(name, value === true ? '' : value);
    }
    element.append(...children.filter((child) => child != null));
    return element;
}

export const button = (text, onclick, properties = {}) => h('button', { type: 'button', onclick, ...properties }, text);

export function say(text) {
    document.getElementById('message').textContent = text;
}

// A number with few digits, for people.
export function short(value, digits = 4) {
    return Number.isFinite(value) ? String(Number(value.toPrecision(digits))) : String(value);
}

// A difference in 8-bit code values.
export function codes(value) {
    const size = Math.abs(value);
    return size < 0.001 ? '< 0.001' : size < 0.1 ? size.toFixed(3) : size.toFixed(2);
}

export function download(name, blob) {
    const link = h('a', { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
