import * as THREE from 'three';
import { MeshBVH, PointsBVH } from 'three-mesh-bvh';
import type { Scan } from '../app-state';
import { cloudMaterial } from './cloud-material';
import { displayFrame, drawnFaces, type DisplayFrame } from './display-frame';

/** A scan as it is drawn: a shaded mesh, or a cloud of round points. */
export interface Body extends DisplayFrame {
  readonly object: THREE.Mesh | THREE.Points;
  /** Boxes in boxes around the faces of a mesh or the points of a cloud, so that pointing need not look at all of them. */
  readonly tree: MeshBVH | PointsBVH;
  /** Lets `paint` write linear RGB per point, each in [0, 1], and shows it. */
  repaint(paint: (colours: Float32Array) => void): void;
  /** Tells a cloud how many pixels a length of 1 takes at distance 1. */
  setPixelScale(pixels: number): void;
  dispose(): void;
}

/** Faces are drawn wherever the scan has some and they were not to be ignored; a large mesh may have been matched as a cloud. */
export function createBody(scan: Scan): Body {
  const frame = displayFrame(scan);
  const faces = drawnFaces(scan);
  const colours = new Float32Array(frame.positions.length).fill(0.5);
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(frame.positions, 3));
  const colourAttribute = new THREE.BufferAttribute(colours, 3);
  geometry.setAttribute('color', colourAttribute);
  const material = faces
    ? new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.85, metalness: 0, side: THREE.DoubleSide })
    : cloudMaterial(frame.spacing);
  if (faces) {
    geometry.setIndex(new THREE.BufferAttribute(faces, 1));
    geometry.computeVertexNormals();
  }
  const object = faces ? new THREE.Mesh(geometry, material) : new THREE.Points(geometry, material);
  object.frustumCulled = false;
  return {
    ...frame,
    object,
    // Both put the geometry's index into the order of the tree; which point is which does not change.
    tree: faces ? new MeshBVH(geometry) : new PointsBVH(geometry),
    repaint(paint) {
      paint(colours);
      colourAttribute.needsUpdate = true;
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
