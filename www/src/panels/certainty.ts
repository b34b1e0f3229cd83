import type { AppState, AppStore } from '../app-state';
import { certaintyOf, type Certainty } from '../certainty';
import { byId, create } from '../dom';
import { capital, lengthOn, percent } from '../sentences';
import { coded } from './coded';

/** How sure the match is of itself, and what the package warns of. */
export function showCertainty(store: AppStore): void {
  const place = byId('certainty', HTMLElement);
  const section = byId('section-certainty', HTMLElement);
  store.watch(['result'], (state) => {
    section.hidden = state.result === null;
    place.replaceChildren(...certaintyPart(state), ...warningPart(state));
  });
}

function certaintyPart({ result, scans }: AppState): Node[] {
  if (!result || !scans.a) return [];
  const certainty = certaintyOf(result.match, scans.a);
  const unit = lengthOn(scans.a.shape.info);
  const words = [`${found(certainty)} ${doubt(certainty)}`, ...(certainty.astray ? [cycle(certainty.astray, unit)] : [])];
  return words.map((textContent) => create('p', { className: 'verdict', textContent }));
}

const found = ({ points, matched }: Certainty): string =>
  matched === points ? 'Every point of A has its point on B.' : `${percent(matched / points)} of A’s points have a point on B.`;

function doubt({ matched, doubted }: Certainty): string {
  if (matched === 0) return '';
  return doubted === 0
    ? 'None of them is below 0.5 confidence.'
    : `${capital(percent(doubted / matched))} of them are below 0.5 confidence.`;
}

/** Within 2 % of √area, a few centimetres on a person, is about what one sees; four times that is another place on the body. */
function cycle({ half, most }: NonNullable<Certainty['astray']>, length: (share: number) => string): string {
  const middle = `half of A’s points end ${half === 0 ? 'exactly' : `at most ${length(half)} from`} where they began`;
  const rest = `nine in ten ${most === 0 ? 'do' : `at most ${length(most)} from there`}`;
  const verdict = most <= 0.02 ? 'agree' : most <= 0.08 ? 'mostly agree' : 'disagree in places';
  return `Taken to B and back, ${middle}, ${rest}: the two directions ${verdict}.`;
}

function warningPart({ result }: AppState): Node[] {
  const warnings = result?.match.report.warnings ?? [];
  if (warnings.length === 0) return [];
  const list = create('ul', { className: 'warnings' });
  list.append(...warnings.map((warning) => coded('li', warning)));
  return [list];
}
