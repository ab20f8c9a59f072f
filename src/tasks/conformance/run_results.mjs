// SPDX-License-Identifier: Apache-2.0
//
// Compares results that the engine wrote itself, in any language: a text file with a line `r,g,b` (or `r g b`) for each
// row of the table, in its order. Lines that begin with # are comments.
//
//   node run_results.mjs results.csv
import { commandLine, finish, misuse, readText } from './compare.mjs';

const { words: [file], rows, codes } = commandLine('run_results.mjs RESULTS', 1);
const lines = readText(file).split('\n').filter((line) => line.trim() !== '' && !line.startsWith('#'));
const results = lines.map((line) => line.trim().split(/[\s,]+/).map(Number));
if (results.length !== rows.length) misuse(`${file}: found ${results.length} lines; expected ${rows.length}, one for each row`);
if (results.some((result) => result.length !== 3)) misuse(`${file}: found a line without three numbers; expected r,g,b`);
finish(rows, results, codes);
