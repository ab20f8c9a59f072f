// SPDX-License-Identifier: Apache-2.0
//
// A .cube through three.js in a browser: its LUTCubeLoader reads it and its LUTPass draws a picture of codes with it.
//
//   node threejs.mjs NODE_MODULES BROWSER JOB.json
//
// The job: width, height, codes (a file of float32 RGBA), and for each picture cube (a file), type (UnsignedByteType or
// FloatType) and out (a file of float32 RGBA to write). Prints the versions and the renderer.
import { createRequire } from 'node:module';
import { readFile, writeFile } from 'node:fs/promises';
import path from 'node:path';

const [modules, browserPath, jobPath] = process.argv.slice(2);
const require = createRequire(path.join(modules, 'none.js'));
const { chromium } = require('playwright-core');
const job = JSON.parse(await readFile(jobPath, 'utf8'));

const HOST = 'http://three.test/';
const PAGE = `<script type="importmap">{"imports": {"three": "/three/build/three.module.js",
    "three/addons/": "/three/examples/jsm/"}}</script>
<script type="module">
    import * as THREE from 'three';
    import { LUTCubeLoader } from 'three/addons/loaders/LUTCubeLoader.js';
    import { LUTPass } from 'three/addons/postprocessing/LUTPass.js';

    const floats = async (url) => new Float32Array(await (await fetch(url)).arrayBuffer());
    const renderer = new THREE.WebGLRenderer();
    const gl = renderer.getContext();

    window.about = () => [THREE.REVISION, gl.getParameter(gl.VERSION)].join(', ');
    window.draw = async (cube, type, width, height) => {
        const loader = new LUTCubeLoader();
        if (type !== 'UnsignedByteType') loader.setType(THREE[type]);
        const { texture3D } = await loader.loadAsync(cube);
        const codes = new THREE.DataTexture(await floats('/codes'), width, height, THREE.RGBAFormat, THREE.FloatType);
        codes.needsUpdate = true;
        const target = new THREE.WebGLRenderTarget(width, height, { type: THREE.FloatType });
        const pass = new LUTPass({ lut: texture3D });
        pass.renderToScreen = false;
        pass.render(renderer, target, { texture: codes });
        const pixels = new Float32Array(width * height * 4);
        renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
        const bytes = new Uint8Array(pixels.buffer);
        let text = '';
        for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
        return btoa(text);
    };
    window.ready = true;
</script>`;

const browser = await chromium.launch({
    executablePath: browserPath,
    // No GPU: SwiftShader draws, which interpolates float textures in float.
    args: ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
try {
    const page = await browser.newPage();
    page.on('pageerror', (error) => console.error(String(error)));
    await page.route('**/*', async (route) => {
        const name = new URL(route.request().url()).pathname;
        if (name === '/') return route.fulfill({ contentType: 'text/html', body: PAGE });
        if (name === '/codes') return route.fulfill({ body: await readFile(job.codes) });
        if (name.startsWith('/cube/')) return route.fulfill({ body: await readFile(job.pictures[name.slice(6)].cube) });
        if (name.startsWith('/three/'))
            return route.fulfill({ contentType: 'text/javascript', body: await readFile(path.join(modules, name)) });
        return route.fulfill({ status: 404, body: '' });
    });
    await page.goto(HOST);
    await page.waitForFunction('window.ready', null, { timeout: 60000 });
    console.log(`three.js r${await page.evaluate('window.about()')}, Chromium ${browser.version()}`);
    for (const [number, { type, out }] of job.pictures.entries()) {
        const drawn = await page.evaluate(([cube, ...rest]) => window.draw(cube, ...rest),
            [`/cube/${number}`, type, job.width, job.height]);
        await writeFile(out, Buffer.from(drawn, 'base64'));
    }
} finally {
    await browser.close();
}
