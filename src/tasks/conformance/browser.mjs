// SPDX-License-Identifier: Apache-2.0
//
// Runs a function in a page of a headless browser: Chromium with its software renderer. The environment variable
// BROWSER replaces this command, such as BROWSER='google-chrome --headless=new --no-sandbox' for the GPU.
import { spawn } from 'node:child_process';
import { mkdtemp, rm } from 'node:fs/promises';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

import { misuse } from './compare.mjs';

const CHROMIUM = 'chromium --headless=new --no-sandbox --no-first-run --use-angle=swiftshader --enable-unsafe-swiftshader ' +
    '--enable-unsafe-webgpu --use-webgpu-adapter=swiftshader';
const SECONDS = 300;

/** Numbers that `run(data)` returns in the page. JSON has no NaN, so they travel as words. */
export async function inBrowser(run, data) {
    const page = `<!doctype html><meta charset="utf-8"><script type="module">
        const answer = (ok, text) => fetch('/', { method: 'POST', body: JSON.stringify({ ok, text }) });
        try {
            const numbers = await (${run})(${JSON.stringify(data).replaceAll('<', '\\u003c')});
            await answer(true, Array.from(numbers, String).join(' '));
        } catch (error) {
            await answer(false, String(error));
        }
    </script>`;
    const profile = await mkdtemp(join(tmpdir(), 'conformance-'));
    let browser;
    const end = () => {
        try {
            process.kill(process.platform === 'win32' ? browser.pid : -browser.pid, 'SIGKILL');  // its children, too
        } catch {
            // It has ended, or it never began.
        }
    };
    process.on('exit', end);
    for (const signal of ['SIGINT', 'SIGTERM']) process.once(signal, () => misuse(`ended by ${signal}`));
    const { ok, text } = await new Promise((resolve) => {
        const fail = (reason) => resolve({ ok: false, text: reason });
        const server = createServer(async (request, response) => {
            if (request.method !== 'POST') return response.setHeader('Content-Type', 'text/html').end(page);
            let body = '';
            for await (const part of request) body += part;
            response.end();
            return resolve(JSON.parse(body));
        }).listen(0, '127.0.0.1', () => {
            const [program, ...flags] = (process.env.BROWSER || CHROMIUM).split(' ');
            const url = `http://127.0.0.1:${server.address().port}/`;
            browser = spawn(program, [...flags, `--user-data-dir=${profile}`, url], { stdio: 'ignore', detached: true });
            browser.on('error', (error) => fail(`${error.message}; set BROWSER to the command of a browser`));
            browser.on('exit', (status) => fail(`${program} ended with status ${status}`));
            setTimeout(() => fail(`${program}: no result after ${SECONDS} s`), 1000 * SECONDS).unref();
        });
    });
    const ended = new Promise((resolve) => browser.once('exit', resolve));
    end();
    if (browser.pid && browser.exitCode === null && browser.signalCode === null) await ended;
    // Its children may still write for a moment. What then stays is in the folder of temporary files.
    await rm(profile, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 }).catch(() => {});
    return ok ? text.split(' ').map(Number) : misuse(text);
}

/** The rows as RGBA, for a texture or a buffer, and results of such numbers as colors. */
export const pixelsOf = (rows) => rows.flatMap(({ scene }) => [...scene.map(String), '1']);
export const colorsOf = (pixels) => Array.from({ length: pixels.length / 4 }, (_, i) => pixels.slice(4 * i, 4 * i + 3));
