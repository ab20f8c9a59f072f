// SPDX-License-Identifier: Apache-2.0
//
// Compares an engine's colors with the table. The runners for Node.js share it.
import { readFileSync } from 'node:fs';
import { parseArgs } from 'node:util';

export function misuse(message) {
    console.error(message);
    process.exit(2);
}

// The status 1 is that of failing rows.
process.on('uncaughtException', (error) => misuse(error.stack));

/** The command line of a runner: its words, --codes, --table FILE, and --uniform NAME=NUMBER where the usage has it. */
export function commandLine(usage, words) {
    const options = { codes: { type: 'boolean' }, table: { type: 'string' } };
    if (usage.includes('--uniform')) options.uniform = { type: 'string', multiple: true };
    try {
        const { values, positionals } = parseArgs({ options, allowPositionals: true });
        if (positionals.length !== words) throw new Error(`found ${positionals.length} words; expected ${words}`);
        return { words: positionals, codes: values.codes, rows: readTable(values.table), uniforms: values.uniform ?? [] };
    } catch (error) {
        return misuse(`${error.message}\nusage: node ${usage} [--codes] [--table FILE]`);
    }
}

export function readText(path) {
    try {
        return readFileSync(path, 'utf8');
    } catch (error) {
        return misuse(error.message);
    }
}

/** The rows of a table, by default of the one beside the runners. Lines of words and comments are no rows. */
function readTable(path = new URL('colors.csv', import.meta.url)) {
    const rows = [];
    for (const [i, text] of readFileSync(path, 'utf8').split('\n').entries()) {
        if (text.trim() === '' || text.startsWith('#') || text.startsWith('group,')) continue;
        const [group, ...cells] = text.split(',');
        const n = cells.map(Number);
        if (n.length !== 12) throw new Error(`${path}:${i + 1}: found ${n.length} numbers; expected 12`);
        rows.push({ line: i + 1, group, scene: n.slice(0, 3), display: n.slice(3, 6), float: n.slice(6, 9), code: n.slice(9) });
    }
    if (rows.length === 0) throw new Error(`${path}: found no rows; expected colors`);
    return rows;
}

/** Prints failing rows and the largest error. Exit status: 0 if all rows are within their tolerances, else 1.
 *  @param results  a color of three numbers for each row */
export function finish(rows, results, codes) {
    // A display of 8 bits shows nothing below 0 and above 1. Math.min and Math.max keep NaN.
    const shown = (value) => (codes ? Math.min(Math.max(value, 0), 1) : value);
    let worst = { error: 0 };
    let failures = 0;
    for (const [i, row] of rows.entries()) {
        const result = Array.from({ length: 3 }, (_, c) => Number(results[i][c]));
        const tolerance = codes ? row.code : row.float;
        const errors = row.display.map((value, c) => Math.abs(shown(result[c]) - shown(value)))
            .map((error) => (Number.isNaN(error) ? Infinity : error));
        for (const error of errors) {
            if (error > worst.error) worst = { error, row };
        }
        if (errors.every((error, c) => error <= tolerance[c])) continue;
        failures += 1;
        console.log(`line ${row.line}, ${row.group}: (${row.scene.join(' ')}) gives (${result.join(' ')}); ` +
            `expected (${row.display.join(' ')}), tolerance (${tolerance.join(' ')})`);
    }
    console.log(`${rows.length} colors, ${failures} failures, largest error ${worst.error.toPrecision(3)}${worst.row ? `, line ${worst.row.line}` : ''}`);
    process.exit(failures > 0 ? 1 : 0);
}
