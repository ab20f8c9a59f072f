// SPDX-License-Identifier: Apache-2.0
// Babylon.js: materials that map tones themselves, and a post-process that does.
import { FreeCamera } from '@babylonjs/core/Cameras/freeCamera.js';
import { Constants } from '@babylonjs/core/Engines/constants.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import { HemisphericLight } from '@babylonjs/core/Lights/hemisphericLight.js';
import { PointLight } from '@babylonjs/core/Lights/pointLight.js';
import { PBRMaterial } from '@babylonjs/core/Materials/PBR/pbrMaterial.js';
import { RawTexture } from '@babylonjs/core/Materials/Textures/rawTexture.js';
import { Color3, Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { CreateBox } from '@babylonjs/core/Meshes/Builders/boxBuilder.js';
import { CreatePlane } from '@babylonjs/core/Meshes/Builders/planeBuilder.js';
import { CreateSphere } from '@babylonjs/core/Meshes/Builders/sphereBuilder.js';
import { ImageProcessingPostProcess } from '@babylonjs/core/PostProcesses/imageProcessingPostProcess.js';
import { Scene } from '@babylonjs/core/scene.js';

export const version = `Babylon.js ${Engine.Version}`;

export const install = (use, { scene }) => use(scene);

const sceneOf = (canvas) => {
    const scene = new Scene(new Engine(canvas, false, { preserveDrawingBuffer: true }));
    scene.clearColor = new Color4(0, 0, 0, 1);
    return scene;
};

const drawn = async (scene, post) => {
    await scene.whenReadyAsync();
    scene.render();
    await post();
    scene.getEngine().dispose();
};

export async function picture(canvas, light, use, post, isPipeline) {
    const scene = sceneOf(canvas);
    const camera = new FreeCamera('camera', new Vector3(0, 0, -1), scene);
    camera.mode = FreeCamera.ORTHOGRAPHIC_CAMERA;
    [camera.orthoLeft, camera.orthoRight, camera.orthoBottom, camera.orthoTop] = [-0.5, 0.5, -0.5, 0.5];
    const material = new PBRMaterial('light', scene);
    material.unlit = true;
    material.albedoTexture = RawTexture.CreateRGBATexture(light, canvas.width, canvas.height, scene, false, false,
        Constants.TEXTURE_NEAREST_SAMPLINGMODE, Constants.TEXTURETYPE_FLOAT);
    material.albedoTexture.gammaSpace = false;
    CreatePlane('picture', { size: 1 }, scene).material = material;
    await use({ scene });
    if (isPipeline) {
        new ImageProcessingPostProcess('shown', 1, camera, Constants.TEXTURE_NEAREST_SAMPLINGMODE, scene.getEngine(), false,
            Constants.TEXTURETYPE_HALF_FLOAT);
    }
    await drawn(scene, post);
}

// Spheres of all hues, lamps up to 256 times white.
export async function room(canvas, use, post) {
    const scene = sceneOf(canvas);
    await use({ scene });
    const camera = new FreeCamera('camera', new Vector3(0, 2.5, -12), scene);
    camera.setTarget(new Vector3(0, 0.8, 0));
    new HemisphericLight('sky', new Vector3(0, 1, 0), scene).intensity = 0.3;
    const ball = (x, y, z, change) => {
        const mesh = CreateSphere('ball', { diameter: 1.6 }, scene);
        mesh.position.set(x, y, z);
        mesh.material = new PBRMaterial('ball', scene);
        change(mesh.material);
    };
    for (let i = 0; i < 7; i++) {
        const color = Color3.FromHSV(360 * i / 7, 1, 1);
        ball(2 * i - 6, 0, 0, (material) => {
            Object.assign(material, {
                albedoColor: color, metallic: 0, roughness: 0.15 + 0.1 * i, maxSimultaneousLights: 8,
            });
        });
        ball(2 * i - 6, 2.2, 2, (material) => {
            Object.assign(material, { unlit: true, albedoColor: color.scale(2 ** (2 * i - 4)) });
        });
        const lamp = new PointLight('lamp', new Vector3(2 * i - 6, 1.5, -3), scene);
        Object.assign(lamp, { diffuse: color, intensity: 40 });
    }
    const floor = CreateBox('floor', { width: 40, height: 0.1, depth: 20 }, scene);
    floor.position.y = -0.9;
    floor.material = new PBRMaterial('floor', scene);
    Object.assign(floor.material, {
        albedoColor: new Color3(0.2, 0.2, 0.2), metallic: 0, roughness: 0.4, maxSimultaneousLights: 8,
    });
    await drawn(scene, post);
}
