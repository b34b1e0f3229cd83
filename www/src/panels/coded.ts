import type { Repair, Warning } from 'geose-fmap';
import { create } from '../dom';
import { asSentence } from '../sentences';

/** A repair or a warning as its sentence, with its stable code, as `data-code`, for whoever reads the page by program. */
export function coded<Name extends 'li' | 'p'>(name: Name, { code, message }: Repair | Warning): HTMLElementTagNameMap[Name] {
  const element = create(name);
  element.textContent = asSentence(message);
  element.dataset['code'] = code;
  return element;
}
