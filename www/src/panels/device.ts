import type { Device } from 'geose-fmap';
import { isBusy, type AppStore } from '../app-state';
import { byId } from '../dom';
import type { DeviceChoice } from '../matcher';
import { asSentence } from '../sentences';
import type { Session } from '../session';

/** The device in use, why, and the choice of another. */
export function showDevice(store: AppStore, session: Session): void {
  const [choice, note] = [byId('device-choice', HTMLSelectElement), byId('device-note', HTMLElement)];
  const masthead = byId('device', HTMLElement);
  choice.addEventListener('change', () => void session.use(choice.value as DeviceChoice));
  store.watch(['device', 'deviceChoice', 'steps'], (state) => {
    const { device, deviceChoice } = state;
    choice.value = deviceChoice;
    choice.disabled = isBusy(state);
    masthead.textContent = device ? shortly(device) : '';
    const words = device
      ? `${shortly(device)}${device.adapter ? ` (${device.adapter})` : ''}. ${asSentence(device.reason)}`
      : 'Opening it; a graphics card is tested against the CPU first.';
    if (note.textContent !== words) note.textContent = words;
  });
}

const shortly = ({ kind }: Device): string => (kind === 'webgpu' ? 'Runs on WebGPU' : 'Runs on the CPU');
