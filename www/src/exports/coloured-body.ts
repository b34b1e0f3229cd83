import * as THREE from 'three';
import { GLTFExporter } from 'three/addons/exporters/GLTFExporter.js';
import { PLYExporter } from 'three/addons/exporters/PLYExporter.js';
import type { Scan } from '../app-state';
import { toByte } from '../colour/colour-space';
import { upright } from '../views/display-frame';

/**
 * A scan as binary PLY: the points in the order, place and unit they were read in, the faces if there are any, and a colour per
 * point as sRGB bytes. `colours`: linear RGB per point.
 */
export function bodyAsPly({ shape }: Scan, colours: Float32Array): Blob {
  const { positions, faces } = shape.geometry();
  const geometry = new THREE.BufferGeometry();
  const places = fitsFloat32(positions, shape.info.scale) ? Float32Array.from(positions) : positions;
  geometry.setAttribute('position', new THREE.BufferAttribute(places, 3));
  // Left to itself the exporter writes colours as floats, which other programs take for bytes.
  geometry.setAttribute('bytes', new THREE.BufferAttribute(Uint8Array.from(colours, toByte), 3));
  if (faces) geometry.setIndex(new THREE.BufferAttribute(faces, 1));
  const object = faces ? new THREE.Mesh(geometry) : new THREE.Points(geometry);
  const bytes = new PLYExporter().parse(object, () => undefined, {
    binary: true,
    littleEndian: true,
    customPropertyMapping: { bytes: ['red', 'green', 'blue'] },
  });
  if (!bytes) throw new Error('the scan could not be written as PLY');
  return new Blob([bytes], { type: 'application/octet-stream' });
}

/** Metres per unit of the scan. */
const metres = { m: 1, cm: 0.01, mm: 0.001 } as const;

/**
 * A scan as GLB. glTF is upright and in metres, so the node that holds the body turns and scales it; a scan of no clear unit or
 * upward axis stays as it is. Its points are kept around the node's origin, because glTF has no numbers finer than 32 bits.
 */
export async function bodyAsGlb({ shape, source }: Scan, colours: Float32Array): Promise<Blob> {
  const { positions, faces } = shape.geometry();
  const { unit, upAxis } = shape.info;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.computeBoundingBox();
  const centre = geometry.boundingBox?.getCenter(new THREE.Vector3()) ?? new THREE.Vector3();
  const around = Float32Array.from(positions, (value, k) => value - centre.getComponent(k % 3));
  geometry.setAttribute('position', new THREE.BufferAttribute(around, 3));
  geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3));
  if (faces) {
    geometry.setIndex(new THREE.BufferAttribute(faces, 1));
    geometry.computeVertexNormals();
  }
  const object = faces
    ? new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.85, side: THREE.DoubleSide }))
    : new THREE.Points(geometry, new THREE.MeshBasicMaterial({ vertexColors: true }));
  object.name = source.name;
  object.quaternion.copy(upright(upAxis));
  object.scale.setScalar(unit ? metres[unit] : 1);
  object.position.copy(centre).applyQuaternion(object.quaternion).multiply(object.scale);
  const bytes = await new GLTFExporter().parseAsync(object, { binary: true, trs: true });
  if (!(bytes instanceof ArrayBuffer)) throw new Error('the scan could not be written as GLB');
  return new Blob([bytes], { type: 'model/gltf-binary' });
}

/** Whether 32-bit numbers place the points to a millionth of the scan's size; far from the origin they do not. */
const fitsFloat32 = (positions: Float64Array, scale: number): boolean =>
  positions.every((value) => Math.abs(value - Math.fround(value)) < 1e-6 * scale);
