// SPDX-License-Identifier: Apache-2.0
// postprocessing: an effect in the last pass of its composer.
import { EffectComposer, EffectPass, RenderPass } from 'postprocessing';
import * as THREE from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';

export const version = `postprocessing, three.js r${THREE.REVISION}`;

export function install(Effect, { renderer, scene, camera }) {
    const composer = new EffectComposer(renderer, { frameBufferType: THREE.HalfFloatType });
    const effect = new Effect();
    composer.addPass(new RenderPass(scene, camera));
    composer.addPass(new EffectPass(camera, effect));
    return { composer, effect };
}
export const set = ({ effect }, name, value) => { effect.uniforms.get(name).value = value; };

const drawn = async (canvas, scene, camera, use, post) => {
    const renderer = new THREE.WebGLRenderer({ canvas, preserveDrawingBuffer: true });
    if (scene.environmentIntensity < 1) {
        scene.environment = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment()).texture;
    }
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
    await drawn(canvas, scene, camera, use, post);
}

// Spheres of all hues, lamps up to 256 times white.
export async function room(canvas, use, post) {
    const scene = new THREE.Scene();
    scene.environmentIntensity = 0.3;
    const add = (geometry, material, ...position) => {
        const mesh = new THREE.Mesh(geometry, material);
        mesh.position.set(...position);
        scene.add(mesh);
    };
    const ball = new THREE.SphereGeometry(0.8, 64, 32);
    for (let i = 0; i < 7; i++) {
        const color = new THREE.Color().setHSL(i / 7, 1, 0.5);
        add(ball, new THREE.MeshStandardMaterial({ color, metalness: i % 2, roughness: 0.15 + 0.1 * i }), 2 * i - 6, 0, 0);
        add(ball, new THREE.MeshBasicMaterial({ color: color.clone().multiplyScalar(2 ** (2 * i - 4)) }), 2 * i - 6, 2.2, -2);
        const lamp = new THREE.PointLight(color, 40);
        lamp.position.set(2 * i - 6, 1.5, 3);
        scene.add(lamp);
    }
    add(new THREE.BoxGeometry(40, 0.1, 20), new THREE.MeshStandardMaterial({ color: 0x808080, roughness: 0.4 }), 0, -0.9, 0);
    const camera = new THREE.PerspectiveCamera(45, canvas.width / canvas.height, 0.1, 100);
    camera.position.set(0, 2.5, 12);
    camera.lookAt(0, 0.8, 0);
    await drawn(canvas, scene, camera, use, post);
}
