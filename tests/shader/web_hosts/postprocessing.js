// SPDX-License-Identifier: Apache-2.0
// postprocessing: an effect in the last pass of its composer.
import { EffectComposer, EffectPass, RenderPass } from 'postprocessing';
import * as THREE from 'three';
import { room as roomOf } from '/three_room.js';

export const version = `postprocessing, three.js r${THREE.REVISION}`;

export function install(Effect, { renderer, scene, camera }) {
    const composer = new EffectComposer(renderer, { frameBufferType: THREE.HalfFloatType });
    const effect = new Effect();
    composer.addPass(new RenderPass(scene, camera));
    composer.addPass(new EffectPass(camera, effect));
    return { composer, effect };
}
export const set = ({ effect }, name, value) => { effect.uniforms.get(name).value = value; };

const drawn = async (canvas, make, use, post) => {
    const renderer = new THREE.WebGLRenderer({ canvas, preserveDrawingBuffer: true });
    const [scene, camera] = make(renderer);
    const { composer } = await use({ renderer, scene, camera });
    // A linear filter mixes a little of the neighbors into a pixel, and a neighbor may be a billion times as bright.
    for (const { texture } of [composer.inputBuffer, composer.outputBuffer]) {
        texture.minFilter = texture.magFilter = THREE.NearestFilter;
    }
    composer.render();
    await post();
    renderer.dispose();
    renderer.forceContextLoss();
};

export async function picture(canvas, light, use, post) {
    const map = new THREE.DataTexture(light, canvas.width, canvas.height, THREE.RGBAFormat, THREE.FloatType);
    map.needsUpdate = true;
    const scene = new THREE.Scene();
    scene.add(new THREE.Mesh(new THREE.PlaneGeometry(2, 2), new THREE.MeshBasicMaterial({ map })));
    const camera = new THREE.OrthographicCamera();
    camera.position.z = 1;
    await drawn(canvas, () => [scene, camera], use, post);
}

export async function room(canvas, use, post) {
    await drawn(canvas, (renderer) => roomOf(renderer, canvas.width / canvas.height), use, post);
}
