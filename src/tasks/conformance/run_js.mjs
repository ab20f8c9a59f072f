// SPDX-License-Identifier: Apache-2.0
//
// Runs a function of a JavaScript module on the colors of the table. It takes [r, g, b], or three numbers if it has
// at least three parameters, and returns [r, g, b] or { r, g, b }.
//
//   node run_js.mjs engine.mjs toneMap
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

import { commandLine, finish, misuse } from './compare.mjs';

const { words: [file, name], rows, codes } = commandLine('run_js.mjs MODULE FUNCTION', 2);
const module = await import(pathToFileURL(resolve(file))).catch((error) => misuse(`${file}: ${error.message}`));
const toneMap = module[name] ?? module.default?.[name];
if (typeof toneMap !== 'function') misuse(`${file}: found no function ${name}; exports: ${Object.keys(module).join(', ')}`);
const results = rows.map(({ scene }) => {
    const color = toneMap.length >= 3 ? toneMap(...scene) : toneMap([...scene]);
    return Array.isArray(color) || ArrayBuffer.isView(color) ? color : [color?.r, color?.g, color?.b];
});
finish(rows, results, codes);
