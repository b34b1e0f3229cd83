import type { Fallback, Match, Stage } from 'geose-fmap';
import type { AppState, AppStore } from '../app-state';
import { byId, create } from '../dom';
import { asSentence, capital, count, counted, seconds, stageWords } from '../sentences';
import { letter, sides } from '../side';
import { table } from './table';

/** What ran where and for how long. */
export function showReport(store: AppStore): void {
  const place = byId('report', HTMLElement);
  store.watch(['scans', 'result'], (state) => place.replaceChildren(...timePart(state), ...runPart(state)));
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

function runPart({ scans, result }: AppState): Node[] {
  const prepared = sides.flatMap((side) => fallbackSentence(`scan ${letter(side)}`, scans[side]?.shape.info.fallback ?? null));
  const sentences = [...prepared, ...(result ? matchSentences(result.match) : [])];
  return sentences.map((textContent) => create('p', { className: 'facts', textContent }));
}

const fallbackSentence = (what: string, fallback: Fallback | null): string[] =>
  fallback ? [asSentence(`${what} went on with the CPU while ${stageWords[fallback.stage]}: ${fallback.reason}`)] : [];

function matchSentences({ report }: Match): string[] {
  const { device, fallback, gpu, peakMemoryBytes, weights } = report;
  return [
    device === 'webgpu' ? 'Matched on WebGPU.' : 'Matched on the CPU.',
    ...fallbackSentence('the match', fallback),
    ...(gpu.dispatches > 0
      ? [`The GPU ran ${count(gpu.dispatches)} shaders, on ${counted(gpu.uploads, 'upload')}, for ${counted(gpu.downloads, 'download')}.`]
      : []),
    `At most ${count(Math.round(peakMemoryBytes / 1e6))} MB were in use.`,
    ...(weights ? [`Weights ${weights.name}, version ${weights.version}.`] : []),
  ];
}
