import * as THREE from 'three';
import type { Scan } from '../app-state';
import { cloudMaterial } from './cloud-material';
import { displayFrame, type DisplayFrame } from './display-frame';

/** A scan as it is drawn: a shaded mesh, or a cloud of round points. */
export interface Body extends DisplayFrame {
  readonly object: THREE.Mesh | THREE.Points;
  /** Linear RGB per point, each in [0, 1]. */
  paint(colours: Float32Array): void;
  /** Tells a cloud how many pixels a length of 1 takes at distance 1. */
  setPixelScale(pixels: number): void;
  dispose(): void;
}

/** Faces are drawn wherever the scan has some, unless they were to be ignored; a large mesh may have been matched as a cloud. */
export function createBody({ shape, choices }: Scan): Body {
  const { positions, faces } = shape.geometry();
  const frame = displayFrame(positions, shape.info);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(frame.positions, 3));
  geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(positions.length).fill(0.5), 3));
  const isMesh = faces !== null && choices.faces !== 'ignore';
  const material = isMesh
    ? new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.85, metalness: 0, side: THREE.DoubleSide })
    : cloudMaterial(frame.spacing);
  if (isMesh) {
    geometry.setIndex(new THREE.BufferAttribute(faces, 1));
    geometry.computeVertexNormals();
  }
  const object = isMesh ? new THREE.Mesh(geometry, material) : new THREE.Points(geometry, material);
  object.frustumCulled = false;
  return {
    ...frame,
    object,
    paint(colours) {
      const attribute = geometry.getAttribute('color') as THREE.BufferAttribute;
      (attribute.array as Float32Array).set(colours);
      attribute.needsUpdate = true;
    },
    setPixelScale(pixels) {
      if (material instanceof THREE.ShaderMaterial) material.uniforms['pixelScale'].value = pixels;
    },
    dispose() {
      geometry.dispose();
      material.dispose();
    },
  };
}
