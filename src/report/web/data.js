// SPDX-License-Identifier: Apache-2.0
//
// The page's data: a ZIP archive in base64.
import { unzipSync } from 'fflate';

function bytesOf(base64) {
    const text = atob(base64.trim());
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    return bytes;
}

const archive = bytesOf(document.getElementById('data').textContent);

// Files are unpacked when they are asked for: pictures and measurements are many.
export function file(name) {
    const found = unzipSync(archive, { filter: (entry) => entry.name === name })[name];
    if (!found) throw new Error(`the page has no ${name}`);
    return found;
}

export const page = JSON.parse(new TextDecoder().decode(file('page.json')));
export const operators = page.operators;
export const findOperator = (name) => operators.find((op) => op.name === name);
