// SPDX-License-Identifier: Apache-2.0
// A scene of three.js: lamps of many colors, up to 256 times white, on a floor and on spheres of all kinds.
import * as THREE from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';

export function room(renderer, aspect) {
    const scene = new THREE.Scene();
    scene.environment = new THREE.PMREMGenerator(renderer).fromScene(new RoomEnvironment()).texture;
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
    add(new THREE.PlaneGeometry(60, 30), new THREE.MeshStandardMaterial({ color: 0x404858 }), 0, 0, -8);
    const camera = new THREE.PerspectiveCamera(45, aspect, 0.1, 100);
    camera.position.set(0, 2.5, 12);
    camera.lookAt(0, 0.8, 0);
    return [scene, camera];
}
