import {
  defaultChoices,
  optionsChanged,
  outdatedSides,
  type AppState,
  type AppStore,
  type MatchChoices,
  type PrepareChoices,
} from '../app-state';
import { sidesWithoutLabels } from '../colour/scan-parts';
import { byId } from '../dom';
import { count } from '../sentences';
import { letter } from '../side';

/** The choices about preparing and matching; they hold from the next match on. */
export function showOptions(store: AppStore): void {
  const form = byId('options', HTMLFormElement);
  const note = byId('options-note', HTMLElement);
  const given = byId('parts-given', HTMLOptionElement);
  const givenNote = byId('parts-note', HTMLElement);
  form.addEventListener('submit', (event) => event.preventDefault());
  form.addEventListener('change', () => {
    const chosen = new FormData(form);
    store.set({ prepareChoices: prepareChoices(chosen, store.get().prepareChoices), matchChoices: matchChoices(chosen) });
  });
  form.addEventListener('reset', () => {
    store.set(defaultChoices);
    // The form puts its fields back only after this event.
    queueMicrotask(() => numbers.forEach(({ name }) => refuse(name, null)));
  });
  for (const { name } of numbers) {
    byId(`option-${name}`, HTMLInputElement).addEventListener('input', () => refuse(name, refusalOf(name, store.get().prepareChoices)));
  }
  store.watch(['prepareChoices', 'matchChoices', 'landmarks', 'result', 'scans'], (state) => {
    const words = noteOf(state);
    if (note.textContent !== words) note.textContent = words;
    byId('match', HTMLButtonElement).classList.toggle('due', optionsChanged(state));
  });
  store.watch(['scans'], (state) => {
    const bare = sidesWithoutLabels(state);
    given.disabled = bare.length > 0;
    if (given.disabled && given.selected) {
      given.selected = false;
      store.set({ matchChoices: { ...state.matchChoices, parts: 'predicted' } });
    }
    givenNote.textContent = bare.length > 0 ? `${bare.map(letter).join(' and ')} came without labels, so no parts are given.` : '';
    givenNote.hidden = bare.length === 0;
  });
}

function noteOf(state: AppState): string {
  if (!optionsChanged(state)) return '';
  const again = outdatedSides(state);
  return again.length > 0
    ? `Match again to apply these; ${again.map(letter).join(' and ')} will be prepared anew first.`
    : 'Match again to apply these.';
}

/** Options that are numbers, their range and what the package takes when nothing is said. */
const numbers = [
  { name: 'points', least: 50, most: Infinity, usual: 5000 },
  { name: 'eigenpairs', least: 10, most: 1000, usual: 120 },
] as const;

type NumberName = (typeof numbers)[number]['name'];

/** Why what stands in a field is no number for it, or null. The number before stays in force. */
function refusalOf(name: NumberName, inForce: PrepareChoices): string | null {
  const input = byId(`option-${name}`, HTMLInputElement);
  const { least, most, usual } = numbers.find((number) => number.name === name) ?? numbers[0];
  const value = input.valueAsNumber;
  if (!input.validity.badInput && (input.value === '' || (Number.isInteger(value) && value >= least && value <= most))) return null;
  const range = most === Infinity ? `of at least ${count(least)}` : `from ${count(least)} to ${count(most)}`;
  return `This takes a whole number ${range}; ${count(inForce[name] ?? usual)} stays in force.`;
}

/** Says beside the field why its number is not taken. */
function refuse(name: NumberName, refusal: string | null): void {
  const place = byId(`refusal-${name}`, HTMLElement);
  byId(`option-${name}`, HTMLInputElement).setAttribute('aria-invalid', String(refusal !== null));
  place.textContent = refusal ?? '';
  place.hidden = refusal === null;
}

/** Empty fields and default entries are left to the package; a refused number leaves the one before in force. */
function prepareChoices(form: FormData, inForce: PrepareChoices): PrepareChoices {
  return {
    ...numeric(form, 'points', inForce),
    ...numeric(form, 'eigenpairs', inForce),
    ...(form.get('faces') === 'ignore' && { faces: 'ignore' as const }),
    ...(form.get('up') !== '' && { up: form.get('up') as NonNullable<PrepareChoices['up']> }),
    ...(form.get('laplacian') !== '' && { laplacian: form.get('laplacian') as NonNullable<PrepareChoices['laplacian']> }),
  };
}

function matchChoices(form: FormData): MatchChoices {
  return {
    refine: form.get('refine') as NonNullable<MatchChoices['refine']>,
    parts: form.get('parts') as NonNullable<MatchChoices['parts']>,
  };
}

function numeric(form: FormData, name: NumberName, inForce: PrepareChoices): PrepareChoices {
  if (refusalOf(name, inForce) !== null) return inForce[name] === undefined ? {} : { [name]: inForce[name] };
  const text = form.get(name);
  return typeof text === 'string' && text !== '' ? { [name]: Number(text) } : {};
}
