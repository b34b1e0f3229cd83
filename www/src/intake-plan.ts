import { arriving, outdatedSides, type AppState } from './app-state';
import type { ScanSource } from './scan-source';
import { letter, opposite, sides, type Side } from './side';

/** Which scans are to be prepared for which side, and what the user should know about it. */
export interface IntakePlan {
  readonly loads: readonly (readonly [side: Side, source: ScanSource])[];
  readonly remark: string | null;
}

/** The first of several scans goes to `side`, the second to the other one; a scan that is there already stays as it is. `remarks` are about what came with them and is no scan. */
export function planIntake(state: AppState, side: Side, sources: readonly ScanSource[], remarks: readonly string[] = []): IntakePlan {
  const [first, second, ...further] = sources;
  if (!first) return { loads: [], remark: remarks.join(' ') || 'There was no file in that. Drop the files of two scans.' };
  const wanted = [[side, first] as const, ...(second ? [[opposite(side), second] as const] : [])];
  const fresh = wanted.filter(([to, source]) => !isThere(state, to, source));
  const after = (to: Side): ScanSource | null =>
    wanted.find(([wantedSide]) => wantedSide === to)?.[1] ?? arriving(state, to) ?? state.scans[to]?.source ?? null;
  const sentences = [
    ...remarks,
    ...(second && further.length > 0 ? [`A match takes two scans: ${titles([first, second])} were taken, ${left(further)}.`] : []),
    ...wanted.filter((pair) => !fresh.includes(pair)).map(([to, source]) => `${source.title} is scan ${letter(to)} already.`),
    ...fresh.flatMap(([to, source]) => displaced(state, to, source)),
    ...(fresh.length > 0 && state.steps.match.status === 'running'
      ? [`The match under way was stopped; it begins anew with ${titles(fresh.map(([, source]) => source))}.`]
      : []),
    ...(fresh.length > 0 && after('a')?.identity === after('b')?.identity
      ? ['Both scans are the same file, so every point should find itself.']
      : []),
  ];
  return { loads: fresh, remark: sentences.length > 0 ? sentences.join(' ') : null };
}

/** A folder was among what was dropped. */
export const folderRemark = (name: string): string => `${name} is a folder; drop the files in it.`;

/** Whether the same file is on its way to a side already, or on show there as the options want it. */
function isThere(state: AppState, side: Side, source: ScanSource): boolean {
  const coming = arriving(state, side);
  if (coming) return coming.identity === source.identity;
  return state.scans[side]?.source.identity === source.identity && !outdatedSides(state).includes(side);
}

function displaced(state: AppState, side: Side, source: ScanSource): string[] {
  const coming = arriving(state, side);
  return coming ? [`${source.title} takes the place of ${coming.title}, which was still being prepared.`] : [];
}

const titles = (sources: readonly ScanSource[]): string => sources.map(({ title }) => title).join(' and ');

const left = (further: readonly ScanSource[]): string =>
  further.length === 1 ? `${further[0].title} was left out` : `${further.length} others were left out`;

/** Where a lone file goes that was dropped beside both sides: to the side that is still empty, else to B. */
export const emptySide = (state: AppState): Side => sides.find((side) => !state.scans[side] && !arriving(state, side)) ?? 'b';
