// A browser, a server that hands out the files of a folder, and the page that runs the customer's program.
import { createReadStream, readFileSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import path from 'node:path';
import { chromium } from 'playwright-core';
import { ensureChromium, switches } from '../../scripts/chromium.mjs';

const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.wasm': 'application/wasm' };
const read = (name) => readFileSync(new URL(name, import.meta.url), 'utf8');

/** The files of a page that runs the program. `from` is how it imports the package, `options` the text of the matcher's options. */
export const page = ({ from = 'geose-fmap', options = '{}' } = {}) => ({
  'index.html': '<!doctype html><link rel="icon" href="data:,"><script type="module" src="./main.js"></script>\n',
  'bodies.mjs': read('bodies.mjs'),
  'customer.mjs': read('customer.mjs'),
  'main.js': `
    import { Matcher } from ${JSON.stringify(from)};
    import { run } from './customer.mjs';
    window.outcome = await run(Matcher, ${options}).catch((error) => ({ error: \`\${error.code}: \${error.message}\` }));
  `,
});

/** Serves `folder` on a port of its own; `headers` go with every answer and `types` changes what an ending is said to be. */
export async function serve(folder, { headers = {}, types = {} } = {}) {
  const typeOf = { ...TYPES, ...types };
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url, 'http://any');
    const file = path.join(folder, decodeURIComponent(pathname === '/' ? '/index.html' : pathname));
    if (!statSync(file, { throwIfNoEntry: false })?.isFile()) return response.writeHead(404, headers).end();
    response.writeHead(200, { 'content-type': typeOf[path.extname(file)] ?? 'application/octet-stream', ...headers });
    return createReadStream(file).pipe(response);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  const close = () => new Promise((resolve) => server.close(resolve).closeAllConnections());
  return { origin: `http://127.0.0.1:${server.address().port}`, close };
}

/** Starts the browser, with `more` switches; whoever calls it closes it. */
export const launch = (more = []) => chromium.launch({ executablePath: ensureChromium().browser, args: [...switches, ...more] });

/** Opens the page and waits for its outcome; also tells which addresses were asked for and what the page complained of. */
export async function visit(browser, url) {
  const context = await browser.newContext();
  const requests = [];
  const complaints = [];
  context.on('request', (request) => requests.push(request.url()));
  context.on('weberror', (error) => complaints.push(error.error().message));
  context.on('console', (message) => message.type() === 'error' && complaints.push(message.text()));
  try {
    const tab = await context.newPage();
    await tab.goto(url);
    const outcome = await tab.waitForFunction(() => window.outcome, null, { timeout: 120_000 });
    return { outcome: await outcome.jsonValue(), requests, complaints };
  } catch (error) {
    throw new Error([error.message, ...complaints].join('\n'), { cause: error });
  } finally {
    await context.close();
  }
}
