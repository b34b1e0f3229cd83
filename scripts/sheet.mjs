// Draws a labelled mesh, such as the bodies of `bodies sheet`, as a picture: `node scripts/sheet.mjs bodies.ply bodies.png`.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { ensureChromium } from './chromium.mjs';
import { main, root, say } from './run.mjs';

const PAGE = `<!doctype html><style>body { margin: 0 }</style>
<script type="importmap">{ "imports": { "three": "/three/build/three.module.js" } }</script>
<script type="module">
  import * as THREE from 'three';
  import { PLYLoader } from '/three/examples/jsm/loaders/PLYLoader.js';
  const loader = new PLYLoader();
  loader.setCustomPropertyNameMapping({ label: ['label'] });
  const geometry = loader.parse(await (await fetch('/mesh.ply')).arrayBuffer());
  geometry.computeVertexNormals();
  geometry.computeBoundingBox();
  const { min, max } = geometry.boundingBox;
  const labels = geometry.getAttribute('label');
  const colours = new Float32Array(3 * labels.count);
  // Left sides warm, right sides cold.
  const hue = (part) => (part < 2 ? 0.28 + 0.12 * part : (part % 2 ? 0.52 : 0.0) + 0.022 * (part >> 1));
  for (let i = 0; i < labels.count; i++) new THREE.Color().setHSL(hue(labels.getX(i)), 0.45, 0.6).toArray(colours, 3 * i);
  geometry.setAttribute('color', new THREE.BufferAttribute(colours, 3));
  const scene = new THREE.Scene();
  scene.background = new THREE.Color('white');
  scene.add(new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.8 })));
  scene.add(new THREE.HemisphereLight('white', 'gray', 1.2));
  const sun = new THREE.DirectionalLight('white', 2);
  sun.position.set(1, 2, 3);
  scene.add(sun);
  const margin = 0.1;
  const camera = new THREE.OrthographicCamera(min.x - margin, max.x + margin, max.y + margin, min.y - margin, 0, 20);
  camera.position.z = 10;
  const width = 1800;
  const renderer = new THREE.WebGLRenderer({ antialias: true });
  renderer.setSize(width, Math.round((width * (camera.top - camera.bottom)) / (camera.right - camera.left)));
  document.body.append(renderer.domElement);
  renderer.render(scene, camera);
  window.drawn = true;
</script>`;

await main(import.meta, async () => {
  const [mesh, picture] = process.argv.slice(2);
  const { chromium } = await import('playwright-core');
  const args = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
  const browser = await chromium.launch({ executablePath: ensureChromium().browser, args, chromiumSandbox: false });
  try {
    const page = await browser.newPage({ viewport: { width: 1800, height: 1000 } });
    await page.route('http://sheet.localhost/**', (route) => {
      const { pathname } = new URL(route.request().url());
      if (pathname === '/') return route.fulfill({ contentType: 'text/html', body: PAGE });
      if (pathname === '/mesh.ply') return route.fulfill({ body: readFileSync(mesh) });
      const body = readFileSync(path.join(root, 'node_modules', pathname));
      return route.fulfill({ contentType: 'text/javascript', body });
    });
    await page.goto('http://sheet.localhost/');
    await page.waitForFunction(() => window.drawn, undefined, { timeout: 60_000 });
    await page.locator('canvas').screenshot({ path: picture });
    say(picture);
  } finally {
    await browser.close();
  }
});
