import { optionsChanged, type AppStore, type MatchChoices, type PrepareChoices } from '../app-state';
import { byId } from '../dom';

/** The choices about preparing and matching; they hold from the next match on. */
export function showOptions(store: AppStore): void {
  const form = byId('options', HTMLFormElement);
  const note = byId('options-note', HTMLElement);
  form.addEventListener('submit', (event) => event.preventDefault());
  form.addEventListener('change', () => {
    if (!form.reportValidity()) return;
    const chosen = new FormData(form);
    store.set({ prepareChoices: prepareChoices(chosen), matchChoices: matchChoices(chosen) });
  });
  store.watch(['prepareChoices', 'matchChoices', 'landmarks', 'result', 'scans'], (state) => {
    note.textContent = optionsChanged(state) ? 'Match again to apply these.' : '';
    byId('match', HTMLButtonElement).classList.toggle('due', optionsChanged(state));
  });
}

/** Empty fields and default entries are left to the package. */
function prepareChoices(form: FormData): PrepareChoices {
  return {
    ...numeric(form, 'points'),
    ...numeric(form, 'eigenpairs'),
    ...(form.get('faces') === 'ignore' && { faces: 'ignore' as const }),
    ...(form.get('up') !== '' && { up: form.get('up') as NonNullable<PrepareChoices['up']> }),
    ...(form.get('laplacian') !== '' && { laplacian: form.get('laplacian') as NonNullable<PrepareChoices['laplacian']> }),
  };
}

function matchChoices(form: FormData): MatchChoices {
  return {
    refine: form.get('refine') as NonNullable<MatchChoices['refine']>,
    ...(form.get('parts') !== '' && { parts: form.get('parts') as NonNullable<MatchChoices['parts']> }),
  };
}

function numeric<Name extends 'points' | 'eigenpairs'>(form: FormData, name: Name): { [key in Name]?: number } {
  const text = form.get(name);
  return typeof text === 'string' && text !== '' ? ({ [name]: Number(text) } as { [key in Name]: number }) : {};
}
