// What a suite spends its time on: the seconds of its steps and tests, and a table of the slowest.
import { existsSync, readFileSync } from 'node:fs';

/** Steps and tests since the table was last taken: `{ name, seconds, processor }`; `processor` is null where it is not known. */
let costs = [];

/** Clock ticks per second in /proc: the same on every Linux. */
const TICKS = 100;

/** Notes a step or a test. */
export function note(name, seconds, processor = null) {
  costs.push({ name, seconds, processor });
}

/** Runs one step of a suite and notes what it took, also when it fails. */
export async function step(name, action) {
  const elapsed = stopwatch();
  try {
    return await action();
  } finally {
    const { seconds, processor } = elapsed();
    note(name, seconds, processor);
  }
}

/** Starts to measure; what it returns tells the seconds since then, on the clock and of all processors together. */
export function stopwatch() {
  const [started, before] = [performance.now(), processorSeconds()];
  return () => ({ seconds: (performance.now() - started) / 1000, processor: before === null ? null : processorSeconds() - before });
}

/** Hands over what was noted, and starts anew. */
export function takeCosts() {
  const taken = costs;
  costs = [];
  return taken;
}

/** The `count` slowest as lines of a table, slowest first; what took less than half a second is left out. */
export function slowest(taken, count = 10) {
  const slow = taken.filter(({ seconds }) => seconds >= 0.5).sort((left, right) => right.seconds - left.seconds);
  return slow.slice(0, count).map((cost) => `${cost.seconds.toFixed(1).padStart(8)} s  ${cost.name}${ofProcessor(cost)}`);
}

/** In words; nothing where it is not known. */
export const ofProcessor = ({ processor }) => (processor === null ? '' : `, ${Math.round(processor)} s of processor`);

/** Seconds of processor time that this process and the ended programs it ran have had; null where there is no /proc. */
function processorSeconds() {
  const file = '/proc/self/stat';
  if (!existsSync(file)) return null;
  // Behind the program's name, which may hold spaces: utime, stime, cutime and cstime are fields 14 to 17.
  const fields = readFileSync(file, 'latin1')
    .replace(/^.*\) /s, '')
    .split(' ');
  return fields.slice(11, 15).reduce((sum, ticks) => sum + Number(ticks), 0) / TICKS;
}
