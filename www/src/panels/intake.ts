import type { AppStore } from '../app-state';
import { byId, create } from '../dom';
import { gather } from '../gltf-files';
import { emptySide, folderRemark, planIntake } from '../intake-plan';
import { samplePair, type Samples } from '../samples';
import { fromAddress, type ScanSource } from '../scan-source';
import { sides, type Side } from '../side';

/** The ways in: dropping, choosing a file, picking a sample. */
export function takeScans(
  store: AppStore,
  load: (loads: readonly (readonly [Side, ScanSource])[]) => void,
  samples: Promise<Samples>,
): void {
  /** Without a side a lone scan goes where there is room. */
  const take = (side: Side | null, sources: readonly ScanSource[], remarks: readonly string[] = []): void => {
    const { loads, remark } = planIntake(store.get(), side ?? (sources.length > 1 ? 'a' : emptySide(store.get())), sources, remarks);
    store.set({ remark });
    if (loads.length > 0) load(loads);
  };
  const takeFiles = async (side: Side | null, files: readonly File[]): Promise<void> => {
    const { sources, remarks } = await gather(files);
    take(side, sources, remarks);
  };
  const takeDropped = (side: Side | null, { files, folders }: Dropped): void => {
    if (files.length === 0 && folders[0]) store.set({ remark: folderRemark(folders[0]) });
    else void takeFiles(side, files);
  };
  for (const side of sides) {
    const input = byId(`file-${side}`, HTMLInputElement);
    input.multiple = true;
    input.addEventListener('change', () => {
      if (input.files?.length) void takeFiles(side, [...input.files]);
      // The same file again is a wish, too: without this the browser would not tell.
      input.value = '';
    });
    for (const id of [`drop-${side}`, `view-${side}`]) acceptDrops(byId(id, HTMLElement), (dropped) => takeDropped(side, dropped));
  }
  // Beside the two zones, too: nothing ever replaces the page itself.
  acceptDrops(document.documentElement, (dropped) => takeDropped(null, dropped));
  void samples.then((list) => offerSamples(store, take, list));
}

/** What came with a drop; folders are told apart because they read like broken files. */
interface Dropped {
  readonly files: readonly File[];
  readonly folders: readonly string[];
}

function droppedWith(transfer: DataTransfer | null): Dropped {
  const files = [...(transfer?.files ?? [])];
  const entries = [...(transfer?.items ?? [])].map((item) => item.webkitGetAsEntry());
  const folders = entries.flatMap((entry) => (entry?.isDirectory ? [entry.name] : []));
  return { files: files.filter(({ name }) => !folders.includes(name)), folders };
}

/** Two files on one side fill both, the first one A's if dropped on A. */
function acceptDrops(zone: HTMLElement, take: (dropped: Dropped) => void): void {
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
    take(droppedWith(event.dataTransfer));
  });
}

function offerSamples(store: AppStore, take: (side: Side, sources: readonly ScanSource[]) => void, { samples, parts }: Samples): void {
  const sources = new Map(samples.map(({ file, title }) => [file, fromAddress(`./samples/${file}`, title, parts)]));
  // They are small: with all of them here the page shows what it can do without a network, too.
  setTimeout(() => void Promise.allSettled([...sources.values()].map((source) => source.data())), 2000);
  for (const side of sides) {
    const menu = byId(`sample-${side}`, HTMLSelectElement);
    menu.append(create('option', { value: '', textContent: 'Samples' }));
    menu.append(...samples.map((sample) => create('option', { value: sample.file, textContent: sample.title })));
    menu.disabled = samples.length === 0;
    menu.addEventListener('change', () => {
      const source = sources.get(menu.value);
      if (source) take(side, [source]);
    });
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
  button.addEventListener('click', () =>
    take(
      'a',
      pair.flatMap(({ file }) => sources.get(file) ?? []),
    ),
  );
}
