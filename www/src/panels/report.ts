import type { Match, Stage } from 'geose-fmap';
import type { AppState, AppStore } from '../app-state';
import { byId, create } from '../dom';
import { asSentence, capital, count, counted, seconds, stageWords } from '../sentences';
import { table } from './table';

/** What ran where and for how long. */
export function showReport(store: AppStore): void {
  const place = byId('report', HTMLElement);
  const device = byId('device', HTMLElement);
  store.watch(['device'], (state) => {
    device.textContent = state.device ? deviceName(state.device.kind) : '';
    device.title = state.device?.reason ?? '';
  });
  store.watch(['device', 'scans', 'result'], (state) => place.replaceChildren(...timePart(state), ...devicePart(state)));
}

const deviceName = (kind: 'cpu' | 'webgpu'): string => (kind === 'webgpu' ? 'Runs on WebGPU' : 'Runs on the CPU');

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
