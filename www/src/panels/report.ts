import type { Match, PreparedShape, Stage } from 'geose-fmap';
import type { AppState, AppStore } from '../app-state';
import { byId, create } from '../dom';
import { asSentence, count, counted, seconds, stageWords } from '../sentences';
import { letter, sides } from '../side';
import { matchedCount } from '../match-direction';

/** What ran where, for how long, on what, and what was repaired or doubted on the way. */
export function showReport(store: AppStore): void {
  const place = byId('report', HTMLElement);
  const device = byId('device', HTMLElement);
  store.watch(['device'], (state) => {
    device.textContent = state.device ? deviceName(state.device.kind) : '';
    device.title = state.device?.reason ?? '';
  });
  store.watch(['device', 'scans', 'result'], (state) => {
    const parts = [...confidencePart(state), ...warningPart(state), ...scanPart(state), ...timePart(state), ...devicePart(state)];
    place.replaceChildren(...parts);
  });
}

const deviceName = (kind: 'cpu' | 'webgpu'): string => (kind === 'webgpu' ? 'Runs on WebGPU' : 'Runs on the CPU');

function confidencePart({ result }: AppState): Node[] {
  if (!result) return [];
  const { match } = result;
  const found = matchedCount(match);
  const share = found === match.targetOf.length ? 'All' : `${((100 * found) / match.targetOf.length).toFixed(1)} %`;
  const median = match.confidence.slice().sort()[match.confidence.length >> 1];
  const sure = `${share} of A is matched; median confidence ${median.toFixed(2)}.`;
  return [create('p', { className: 'verdict', textContent: sure })];
}

function warningPart({ result }: AppState): Node[] {
  if (!result || result.match.report.warnings.length === 0) return [];
  const list = create('ul', { className: 'warnings' });
  list.append(...result.match.report.warnings.map((warning) => create('li', { textContent: asSentence(warning) })));
  return [list];
}

function scanPart({ scans }: AppState): Node[] {
  const shapes = sides.flatMap((side) => {
    const scan = scans[side];
    return scan ? [{ side, shape: scan.shape }] : [];
  });
  if (shapes.length === 0) return [create('p', { className: 'facts', textContent: 'Nothing to tell yet.' })];
  const rows: [string, (shape: PreparedShape) => string][] = [
    ['Kind', ({ info }) => info.kind],
    ['Points', ({ info }) => count(info.points)],
    ['Faces', ({ info }) => count(info.faces)],
    ['Pieces', ({ info }) => count(info.pieces)],
    ['Points used', ({ info }) => count(info.pointsUsed)],
    ['Unit', ({ info }) => info.unit ?? 'not clear'],
    ['√area', ({ info }) => info.scale.toPrecision(3)],
    ['Up', ({ info }) => info.upAxis ?? 'not clear'],
    ['Laplacian', ({ info }) => info.laplacian],
    ['Eigenpairs', ({ info }) => count(info.eigenpairs)],
  ];
  const scansTable = table(
    'The scans',
    ['', ...shapes.map(({ side }) => letter(side))],
    rows.map(([name, value]) => [name, ...shapes.map(({ shape }) => value(shape))]),
  );
  const repairs = shapes.flatMap(({ side, shape }) =>
    shape.repairs.map((repair) => create('li', { textContent: `${letter(side)}: ${asSentence(repair.message)}` })),
  );
  if (repairs.length === 0) return [scansTable, create('p', { className: 'facts', textContent: 'Nothing had to be repaired.' })];
  return [scansTable, create('h3', { textContent: 'Repaired' }), create('ul', { className: 'repairs' }, ...repairs)];
}

function timePart({ scans, result }: AppState): Node[] {
  const columns = [
    ['A', scans.a?.shape.info.seconds],
    ['B', scans.b?.shape.info.seconds],
    ['Match', result?.match.report.seconds],
  ] as const;
  const shown = columns.filter(([, spent]) => spent !== undefined);
  if (shown.length === 0) return [];
  const stages = (Object.keys(stageWords) as Stage[]).filter((stage) => shown.some(([, spent]) => spent?.[stage] !== undefined));
  const cell = (value: number | undefined): string => (value === undefined ? '' : seconds(value));
  const rows = stages.map((stage) => [capital(stageWords[stage]), ...shown.map(([, spent]) => cell(spent?.[stage]))]);
  const total = shown.map(([, spent]) => cell(Object.values(spent ?? {}).reduce((sum, value) => sum + value, 0)));
  return [table('Time', ['', ...shown.map(([name]) => name)], [...rows, ['Together', ...total]])];
}

function devicePart({ device, result }: AppState): Node[] {
  if (!device) return [];
  const adapter = device.adapter === undefined ? '' : ` (${device.adapter})`;
  const sentences = [`${deviceName(device.kind)}${adapter}. ${asSentence(device.reason)}`, ...(result ? runSentences(result.match) : [])];
  return [create('h3', { textContent: 'Device' }), ...sentences.map((textContent) => create('p', { className: 'facts', textContent }))];
}

function runSentences({ report }: Match): string[] {
  const { fallback, gpu, peakMemoryBytes, weights } = report;
  return [
    ...(fallback ? [asSentence(`while ${stageWords[fallback.stage]} it went on with the CPU: ${fallback.reason}`)] : []),
    ...(gpu.dispatches > 0 ? [`${counted(gpu.dispatches, 'dispatch').replace('dispatchs', 'dispatches')} on the GPU.`] : []),
    `At most ${count(Math.round(peakMemoryBytes / 1e6))} MB were in use.`,
    ...(weights ? [`Weights ${weights.name}, version ${weights.version}.`] : []),
  ];
}

function table(caption: string, head: readonly string[], rows: readonly (readonly string[])[]): HTMLTableElement {
  const cells = (row: readonly string[], header: boolean): HTMLTableRowElement => {
    const line = create('tr');
    row.forEach((text, k) => {
      const cell = create(header || k === 0 ? 'th' : 'td', { textContent: text });
      if (text !== '' && (header || k === 0)) cell.setAttribute('scope', header ? 'col' : 'row');
      line.append(cell);
    });
    return line;
  };
  return create(
    'table',
    {},
    create('caption', { textContent: caption }),
    create('thead', {}, cells(head, true)),
    create('tbody', {}, ...rows.map((row) => cells(row, false))),
  );
}

const capital = (text: string): string => text.charAt(0).toUpperCase() + text.slice(1);
