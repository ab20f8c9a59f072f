// SPDX-License-Identifier: Apache-2.0
// CesiumJS: the tone mapper's stage of a scene with high dynamic range, without a globe.
import * as Cesium from '@cesium/engine';

export const version = '@cesium/engine';

export function install(use, { scene }) {
    scene.highDynamicRange = true;
    return use(scene);
}
export const set = (stage, name, value) => { stage.uniforms[`tw_${name}`] = value; };

const sceneOf = async (canvas, use) => {
    const webgl = { preserveDrawingBuffer: true, antialias: false };
    const scene = new Cesium.Scene({ canvas, contextOptions: { webgl }, msaaSamples: 1 });
    scene.rethrowRenderErrors = true;
    scene.backgroundColor = Cesium.Color.BLACK;
    await use({ scene });
    if (!scene.highDynamicRange) throw new Error('the scene has no high dynamic range');
    return scene;
};

const drawn = async (scene, post) => {
    // In the first frame, the stages wait for their textures.
    for (let i = 0; i < 3; i++) scene.render();
    await post();
    scene.destroy();
};

export async function picture(canvas, light, use, post) {
    const scene = await sceneOf(canvas, use);
    scene.logarithmicDepthBuffer = false; // its shaders discard what has no depth
    const { context } = scene;
    const map = new Cesium.Texture({
        context, pixelDatatype: Cesium.PixelDatatype.FLOAT, sampler: Cesium.Sampler.NEAREST, flipY: false,
        source: { width: canvas.width, height: canvas.height, arrayBufferView: light },
    });
    const command = context.createViewportQuadCommand(`
        uniform sampler2D light;
        in vec2 v_textureCoordinates;
        void main() { out_FragColor = vec4(texture(light, v_textureCoordinates).rgb, 1.0); }`,
    { uniformMap: { light: () => map }, pass: Cesium.Pass.OPAQUE, renderState: Cesium.RenderState.fromCache() });
    scene.primitives.add({ update: ({ commandList }) => commandList.push(command), isDestroyed: () => false, destroy() {} });
    await drawn(scene, post);
}

// Spheres of all hues above Greenwich, lamps up to 256 times white.
export async function room(canvas, use, post) {
    const scene = await sceneOf(canvas, use);
    const place = Cesium.Transforms.eastNorthUpToFixedFrame(Cesium.Cartesian3.fromDegrees(0, 51, 100));
    const inPlace = (x, y, z) => Cesium.Matrix4.multiplyByPoint(place, new Cesium.Cartesian3(x, y, z), new Cesium.Cartesian3());
    const add = (geometry, material, x, y, z) => {
        const modelMatrix = Cesium.Matrix4.multiplyByTranslation(place, new Cesium.Cartesian3(x, y, z), new Cesium.Matrix4());
        scene.primitives.add(new Cesium.Primitive({
            geometryInstances: new Cesium.GeometryInstance({ geometry, modelMatrix }),
            appearance: new Cesium.MaterialAppearance({ material, translucent: false, closed: true }),
            asynchronous: false,
        }));
    };
    const vertexFormat = Cesium.VertexFormat.POSITION_NORMAL_AND_ST;
    const ball = () => new Cesium.EllipsoidGeometry({ radii: new Cesium.Cartesian3(0.8, 0.8, 0.8), vertexFormat });
    const shown = (component, { red, green, blue }, factor) => new Cesium.Material({
        translucent: false,
        fabric: { components: { [component]: `${factor.toFixed(6)} * vec3(${[red, green, blue].map((c) => c.toFixed(6))})` } },
    });
    for (let i = 0; i < 7; i++) {
        const color = Cesium.Color.fromHsl(i / 7, 1, 0.5);
        add(ball(), shown('diffuse', color, 1), 2 * i - 6, 0, 0);
        // With high dynamic range, Cesium decodes it by a power of 2.2.
        add(ball(), shown('emission', color, 2 ** ((2 * i - 4) / 2.2)), 2 * i - 6, 2, 2.2);
    }
    add(Cesium.BoxGeometry.fromDimensions({ dimensions: new Cesium.Cartesian3(40, 20, 0.1), vertexFormat }),
        shown('diffuse', Cesium.Color.WHITE, 0.2), 0, 0, -0.9);
    const ahead = Cesium.Cartesian3.subtract(inPlace(0, 0, 0.8), inPlace(0, -12, 2.5), new Cesium.Cartesian3());
    const down = Cesium.Cartesian3.subtract(inPlace(1, 2, -2), inPlace(0, 0, 0), new Cesium.Cartesian3());
    scene.light = new Cesium.DirectionalLight({ direction: Cesium.Cartesian3.normalize(down, down), intensity: 3 });
    scene.camera.frustum.near = 0.1;
    scene.camera.frustum.fov = Cesium.Math.toRadians(70);
    scene.camera.setView({
        destination: inPlace(0, -12, 2.5),
        orientation: {
            direction: Cesium.Cartesian3.normalize(ahead, ahead),
            up: Cesium.Matrix4.multiplyByPointAsVector(place, Cesium.Cartesian3.UNIT_Z, new Cesium.Cartesian3()),
        },
    });
    await drawn(scene, post);
}
