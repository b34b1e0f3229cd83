// Takes the README's picture: the built page with two sample bodies matched. `npm run picture`.
import path from 'node:path';
import { ensureChromium } from './chromium.mjs';
import { main, root, say } from './run.mjs';
import { serveSite } from './serve.mjs';
import { buildSite } from './site.mjs';

const PAIR = ['woman-striding.ply', 'man-standing.ply'];

await main(import.meta, async () => {
  await buildSite();
  const { chromium } = await import('playwright-core');
  const { address, close } = await serveSite({ port: 0 });
  const args = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
  const browser = await chromium.launch({ executablePath: ensureChromium().browser, args, chromiumSandbox: false });
  try {
    const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: 'light' });
    await page.goto(address);
    await page.setInputFiles('#file-a', path.join(root, 'www/public/samples', PAIR[0]));
    await page.setInputFiles('#file-b', path.join(root, 'www/public/samples', PAIR[1]));
    await page.waitForFunction(() => window.geose?.match, undefined, { timeout: 180_000 });
    await page.hover('#view-a', { position: { x: 210, y: 250 } });
    await page.waitForTimeout(500);
    const picture = path.join(root, 'www/picture.png');
    await page.screenshot({ path: picture });
    say(picture);
  } finally {
    await browser.close();
    await close();
  }
});
