import * as THREE from 'three';

/** Round points that are shaded like small balls, so much wider than the gap between neighbours that the surface closes. */
export function cloudMaterial(spacing: number): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    vertexColors: true,
    uniforms: { spacing: { value: spacing }, pixelScale: { value: 1 } },
    vertexShader: /* glsl */ `
      uniform float spacing;
      uniform float pixelScale;
      varying vec3 vColour;
      void main() {
        vColour = color;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        gl_PointSize = clamp(1.45 * spacing * pixelScale / gl_Position.w, 2.0, 24.0);
      }`,
    fragmentShader: /* glsl */ `
      varying vec3 vColour;
      void main() {
        vec2 offset = 2.0 * gl_PointCoord - 1.0;
        float squared = dot(offset, offset);
        if (squared > 1.0) discard;
        gl_FragColor = vec4(vColour * (0.55 + 0.45 * sqrt(1.0 - squared)), 1.0);
        #include <colorspace_fragment>
      }`,
  });
}
