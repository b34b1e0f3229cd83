import { isBusy, stepNames, type AppState, type AppStore, type Step, type StepName } from '../app-state';
import { byId } from '../dom';
import { matchedCount } from '../match-direction';
import { count, seconds, stageWords } from '../sentences';
import { letter } from '../side';

/** How the page stands, in one word: for style sheets and for whoever drives the page. */
export type Standing = 'empty' | 'ready' | 'working' | 'matched' | 'cancelled' | 'failed';

export function standing(state: AppState): Standing {
  const statuses = stepNames.map((name) => state.steps[name].status);
  if (isBusy(state)) return 'working';
  if (statuses.includes('cancelled')) return 'cancelled';
  if (statuses.includes('failed') || (state.errors.match !== null && !state.result)) return 'failed';
  if (state.result) return 'matched';
  return state.scans.a && state.scans.b ? 'ready' : 'empty';
}

/** One line per step, the overall bar, and a sentence that screen readers hear when the stage changes. */
export function showProgress(store: AppStore): void {
  const status = byId('status', HTMLElement);
  const progress = byId('progress', HTMLProgressElement);
  store.watch(['steps', 'scans', 'result', 'errors', 'device'], (state) => {
    const words = statusWords(state);
    if (status.textContent !== words) status.textContent = words;
    status.dataset['state'] = standing(state);
    progress.value = overall(state);
    progress.classList.toggle('working', isBusy(state));
  });
  for (const name of stepNames) {
    const item = byId(`step-${name}`, HTMLElement);
    const stageName = item.querySelector('.stage-name') as HTMLElement;
    const bar = item.querySelector('.bar') as HTMLElement;
    store.watch(['steps', 'scans', 'result'], (state) => {
      const step = state.steps[name];
      item.dataset['status'] = step.status;
      stageName.textContent = stepWords(state, name);
      bar.style.setProperty('--done', String(shareDone(step)));
    });
  }
}

/** The stages in the order they come, for a bar that runs once from left to right over a step. */
const stagesOf = {
  prepare: ['read', 'sample', 'graph', 'laplacian', 'spectrum', 'features'],
  match: ['features', 'functional-map', 'refine', 'correspondence'],
} as const;

function stepFraction(name: StepName, step: Step): number {
  if (step.status === 'done') return 1;
  if (step.status !== 'running' || step.stage === null) return 0;
  const stages: readonly string[] = name === 'match' ? stagesOf.match : stagesOf.prepare;
  return (Math.max(0, stages.indexOf(step.stage)) + step.fraction) / stages.length;
}

const overall = ({ steps }: AppState): number =>
  stepNames.reduce((sum, name) => sum + stepFraction(name, steps[name]) / stepNames.length, 0);

/** The bar under a step shows its present stage. */
function shareDone(step: Step): number {
  if (step.status === 'done') return 1;
  return step.status === 'running' ? step.fraction : 0;
}

function stepWords(state: AppState, name: StepName): string {
  const step = state.steps[name];
  switch (step.status) {
    case 'running':
      return step.stage === null ? 'waiting for its turn' : stageWords[step.stage];
    case 'done': {
      const spent = name === 'match' ? state.result?.match.report.seconds : state.scans[name]?.shape.info.seconds;
      return spent ? seconds(Object.values(spent).reduce((sum, value) => sum + value, 0)) : 'done';
    }
    case 'failed':
      return 'failed';
    case 'cancelled':
      return 'cancelled';
    case 'waiting':
      return '';
  }
}

function statusWords(state: AppState): string {
  for (const name of stepNames) {
    const step = state.steps[name];
    if (step.status !== 'running') continue;
    const what = name === 'match' ? 'Matching' : `Preparing scan ${letter(name)}`;
    return step.stage === null ? `${what}…` : `${what}: ${stageWords[step.stage]}`;
  }
  switch (standing(state)) {
    case 'matched':
      return matchedWords(state);
    case 'cancelled':
      return state.result ? 'Cancelled; the result on show is the one before.' : 'Cancelled. Match starts again.';
    case 'failed':
      return state.result ? 'That did not work; the result on show is the one before.' : 'That did not work.';
    case 'ready':
      return 'Both scans are ready to be matched.';
    default:
      if (state.scans.a || state.scans.b) return `Now scan ${state.scans.a ? 'B' : 'A'}.`;
      return state.device ? 'Waiting for two scans.' : 'Starting…';
  }
}

function matchedWords({ result }: AppState): string {
  if (!result) return '';
  const { match } = result;
  return `${count(matchedCount(match))} of ${count(match.targetOf.length)} points of A have their point on B.`;
}
