// SPDX-License-Identifier: Apache-2.0
//
// Bundles the viewer into ../viewer.html, or into the file that is named: node build.mjs [FILE]
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import { build } from 'esbuild';

const folder = new URL('./', import.meta.url);
const read = (path) => readFileSync(new URL(path, folder), 'utf8');

const bundle = async (entry, loader = {}) => {
    const result = await build({
        absWorkingDir: folder.pathname,
        entryPoints: [entry],
        bundle: true,
        minify: true,
        write: false,
        format: 'iife',
        target: 'es2022',
        charset: 'ascii',
        legalComments: 'none',
        loader,
    });
    return result.outputFiles[0].text.trim();
};

// An end tag inside the script would end it.
const script = (await bundle('main.js')).replaceAll('</script', '<\\/script');
const style = await bundle('style.css');
const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
// Only this script, the references, whose hash `tonewright report` fills in, and this style.
// Nothing is fetched: there is no connect-src, and forms have no target.
const policy = `default-src 'none'; script-src ${hash(script)} 'sha256-@TONEWRIGHT_REFERENCES@'; style-src ${hash(style)}; `
    + `img-src blob: data:; form-action 'none'; base-uri 'none'`;

const packages = ['parse-exr', 'fflate', 'uplot'];
const licenses = packages.map((name) => {
    const { version, license } = JSON.parse(read(`node_modules/${name}/package.json`));
    const file = { 'parse-exr': 'LICENSE.md' }[name] ?? 'LICENSE';
    const text = read(`node_modules/${name}/${file}`).replaceAll('--', '- -').trim();
    return `${name} ${version} (${license})\n\n${text}\n`;
});

const page = read('page.html')
    .replace('<!-- licenses -->', () => `<!--\nThis page contains:\n\n${licenses.join('\n')}-->`)
    .replace('{{policy}}', () => policy)
    .replace('/* style */', () => style)
    .replace('/* script */', () => script);
writeFileSync(process.argv[2] ?? new URL('../viewer.html', folder), page);
