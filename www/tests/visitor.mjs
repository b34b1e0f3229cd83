// What a visitor of the page does and sees, for tests in a real browser.
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

/** The samples that ship with the page. */
export const samples = fileURLToPath(new URL('../public/samples/', import.meta.url));

/** Long enough for a match on two busy cores. */
export const matchTimeout = 120_000;

export const matched = (on) => on.waitForFunction(() => window.geose.state() === 'matched', null, { timeout: matchTimeout });

/** A real drop event with real files: names among the samples, or name and bytes. */
export async function drop(on, selector, files) {
  const given = await Promise.all(
    files.map(async (file) => {
      const { name, bytes } = typeof file === 'string' ? { name: file, bytes: await readFile(join(samples, file)) } : file;
      return { name, base64: bytes.toString('base64') };
    }),
  );
  const transfer = await on.evaluateHandle((list) => {
    const data = new DataTransfer();
    for (const { name, base64 } of list) {
      // One file is the same each time only if it is as old.
      data.items.add(new File([Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0))], name, { lastModified: 0 }));
    }
    return data;
  }, given);
  for (const type of ['dragenter', 'dragover', 'drop']) await on.dispatchEvent(selector, type, { dataTransfer: transfer });
}

/** The pixels of both views once what was asked for is drawn. */
export async function stageOf(on) {
  await on.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return on.locator('#stage').screenshot();
}

/** What a button saves. */
export async function exported(on, button, encoding) {
  const [download] = await Promise.all([on.waitForEvent('download'), on.click(button)]);
  return readFile(await download.path(), encoding);
}
