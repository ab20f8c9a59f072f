// SPDX-License-Identifier: Apache-2.0
// PlayCanvas: materials that map tones themselves, and the frame of a camera that does.
import * as pc from 'playcanvas';

export const version = `PlayCanvas ${pc.version}`;

export function install(use, { app, camera }) {
    use(app.graphicsDevice);
    camera.camera.toneMapping = pc.TONEMAP_ACES2;
}
export const set = (_, name, value) => pc.app.graphicsDevice.scope.resolve(`tw_${name}`).setValue(value);

const appOf = (canvas) => {
    const app = new pc.Application(canvas, { graphicsDeviceOptions: { antialias: false, preserveDrawingBuffer: true } });
    app.autoRender = false;
    app.setCanvasFillMode(pc.FILLMODE_NONE, canvas.width, canvas.height);
    app.setCanvasResolution(pc.RESOLUTION_FIXED, canvas.width, canvas.height);
    return app;
};

const cameraOf = (app, options) => {
    const camera = new pc.Entity();
    camera.addComponent('camera', { clearColor: new pc.Color(0, 0, 0, 1), ...options });
    app.root.addChild(camera);
    return camera;
};

const shape = (app, type, material, place, scale = [1, 1, 1]) => {
    const entity = new pc.Entity();
    entity.addComponent('render', { type, material });
    entity.setLocalPosition(...place);
    entity.setLocalScale(...scale);
    app.root.addChild(entity);
    return entity;
};

const materialOf = (settings) => {
    const material = Object.assign(new pc.StandardMaterial(), settings);
    material.update();
    return material;
};

const drawn = async (app, post) => {
    await new Promise((done) => {
        app.once('frameend', () => done(post()));
        app.renderNextFrame = true;
        app.start();
    });
    app.destroy();
};

export async function picture(canvas, light, use, post, isPipeline) {
    const app = appOf(canvas);
    const camera = cameraOf(app, {
        projection: pc.PROJECTION_ORTHOGRAPHIC, orthoHeight: 0.5, aspectRatioMode: pc.ASPECT_MANUAL, aspectRatio: 1,
    });
    camera.setLocalPosition(0, 0, 1);
    await use({ app, camera });
    if (isPipeline) {
        const frame = new pc.CameraFrame(app, camera.camera);
        frame.rendering.toneMapping = pc.TONEMAP_ACES2;
        frame.rendering.renderFormats = [pc.PIXELFORMAT_RGBA16F]; // its first choice has 5 or 6 bits
        frame.update();
        // A linear filter mixes a little of the neighbors into a pixel, and a neighbor may be a billion times as bright.
        const { sceneTexture } = frame.renderPassCamera;
        sceneTexture.minFilter = sceneTexture.magFilter = pc.FILTER_NEAREST;
    }
    // PlayCanvas shows the first row at the top.
    const row = 4 * canvas.width;
    const turned = new Float32Array(light.length);
    for (let y = 0; y < canvas.height; y++) turned.set(light.subarray(y * row, (y + 1) * row), light.length - (y + 1) * row);
    const map = new pc.Texture(app.graphicsDevice, {
        width: canvas.width, height: canvas.height, format: pc.PIXELFORMAT_RGBA32F, mipmaps: false, levels: [turned],
        minFilter: pc.FILTER_NEAREST, magFilter: pc.FILTER_NEAREST,
    });
    const material = materialOf({ useLighting: false, emissive: new pc.Color(1, 1, 1), emissiveMap: map });
    shape(app, 'plane', material, [0, 0, 0]).setLocalEulerAngles(90, 0, 0);
    await drawn(app, post);
}

// Spheres of all hues, lamps up to 256 times white.
export async function room(canvas, use, post) {
    const app = appOf(canvas);
    app.scene.ambientLight = new pc.Color(0.1, 0.1, 0.1);
    const camera = cameraOf(app, { fov: 45 });
    await use({ app, camera });
    camera.setLocalPosition(0, 2.5, 12);
    camera.lookAt(0, 0.8, 0);
    for (let i = 0; i < 7; i++) {
        const [r, g, b] = [0, 1, 2].map((c) => Math.min(Math.max(Math.abs((6 * i / 7 + 6 - 2 * c) % 6 - 3) - 1, 0), 1));
        const color = new pc.Color(r, g, b);
        shape(app, 'sphere', materialOf({ diffuse: color, gloss: 0.85 - 0.1 * i }), [2 * i - 6, 0, 0], [1.6, 1.6, 1.6]);
        const lamp = { useLighting: false, emissive: color, emissiveIntensity: 2 ** (2 * i - 4) };
        shape(app, 'sphere', materialOf(lamp), [2 * i - 6, 2.2, -2], [1.6, 1.6, 1.6]);
        const entity = new pc.Entity();
        entity.addComponent('light', { type: 'omni', color, intensity: 2, range: 12 });
        entity.setLocalPosition(2 * i - 6, 1.5, 3);
        app.root.addChild(entity);
    }
    shape(app, 'box', materialOf({ diffuse: new pc.Color(0.5, 0.5, 0.5), gloss: 0.6 }), [0, -0.9, 0], [40, 0.1, 20]);
    await drawn(app, post);
}
