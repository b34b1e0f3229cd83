import type { AppStore } from '../app-state';
import { byId, create } from '../dom';
import { samplePair, type Sample } from '../samples';
import { fromAddress, fromFile, type ScanSource } from '../scan-source';
import { opposite, sides, type Side } from '../side';

/** The ways in: dropping, choosing a file, picking a sample. */
export function takeScans(store: AppStore, load: (side: Side, source: ScanSource) => void, samples: Promise<readonly Sample[]>): void {
  const take = (side: Side, files: readonly File[]): void => {
    const [first, second] = files;
    if (first) load(side, fromFile(first));
    if (second) load(opposite(side), fromFile(second));
  };
  for (const side of sides) {
    const input = byId(`file-${side}`, HTMLInputElement);
    input.multiple = true;
    input.addEventListener('change', () => {
      take(side, [...(input.files ?? [])]);
      // The same file again is a wish, too: without this the browser would not tell.
      input.value = '';
    });
    for (const id of [`drop-${side}`, `view-${side}`]) acceptDrops(byId(id, HTMLElement), (files) => take(side, files));
  }
  // Beside the two zones a lone file goes where there is room; nothing ever replaces the page itself.
  acceptDrops(document.documentElement, (files) => take(files.length < 2 && store.get().scans.a ? 'b' : 'a', files));
  void samples.then((list) => offerSamples(store, load, list));
}

/** Two files on one side fill both, the first one A's if dropped on A. */
function acceptDrops(zone: HTMLElement, take: (files: readonly File[]) => void): void {
  let depth = 0;
  const highlight = (): void => void zone.classList.toggle('over', depth > 0);
  zone.addEventListener('dragenter', (event) => {
    event.preventDefault();
    depth++;
    highlight();
  });
  zone.addEventListener('dragleave', () => {
    depth--;
    highlight();
  });
  zone.addEventListener('dragover', (event) => event.preventDefault());
  zone.addEventListener('drop', (event) => {
    depth = 0;
    highlight();
    if (event.defaultPrevented) return;
    event.preventDefault();
    take([...(event.dataTransfer?.files ?? [])]);
  });
}

function offerSamples(store: AppStore, load: (side: Side, source: ScanSource) => void, samples: readonly Sample[]): void {
  const sources = new Map(samples.map(({ file, title }) => [file, fromAddress(`./samples/${file}`, title)]));
  const loadSample = (side: Side, file: string | undefined): void => {
    const source = sources.get(file ?? '');
    if (source) load(side, source);
  };
  // They are small: with all of them here the page shows what it can do without a network, too.
  setTimeout(() => void Promise.allSettled([...sources.values()].map((source) => source.data())), 2000);
  for (const side of sides) {
    const menu = byId(`sample-${side}`, HTMLSelectElement);
    menu.append(create('option', { value: '', textContent: 'Samples' }));
    menu.append(...samples.map((sample) => create('option', { value: sample.file, textContent: sample.title })));
    menu.disabled = samples.length === 0;
    menu.addEventListener('change', () => loadSample(side, menu.value));
    // The menu names the sample on show, and only that.
    store.watch(['scans'], ({ scans }) => {
      const shown = scans[side]?.source;
      menu.value = shown && sources.get(shown.name) === shown ? shown.name : '';
    });
  }
  const button = byId('sample-pair', HTMLButtonElement);
  const pair = samplePair(samples);
  button.hidden = pair === null;
  if (!pair) return;
  button.addEventListener('click', () => {
    loadSample('a', pair[0].file);
    loadSample('b', pair[1].file);
  });
}
