import { fromHex, mix, type LinearRgb } from './colour-space';

/** Okabe and Ito's eight colours for all kinds of colour vision, black left out (it swallows the shading). */
const hues = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#d55e00', '#56b4e9', '#f0e442'].map(fromHex);
const unsided = ['#8c8c8c', '#c9c2b4', '#6d7f92'].map(fromHex);

/**
 * One colour per part name. Left and right of the same part share a hue, the right one darker, so that a flip is seen at once;
 * parts without a side are grey. Where no name has a side, each has a hue, and dark ones follow when the hues are used up.
 */
export function partPalette(names: readonly string[]): LinearRgb[] {
  const stems = [...new Set(names.filter(hasSide).map(stem))];
  if (stems.length === 0) return names.map((_, k) => shade(k, Math.floor(k / hues.length) % 2 === 1));
  const middle = names.filter((name) => !hasSide(name));
  return names.map((name) => {
    if (!hasSide(name)) return unsided[middle.indexOf(name) % unsided.length];
    return shade(stems.indexOf(stem(name)), /\b(right|r)\b/i.test(words(name)));
  });
}

const shade = (k: number, dark: boolean): LinearRgb =>
  dark ? mix(hues[k % hues.length], [0, 0, 0], 0.55) : mix(hues[k % hues.length], [1, 1, 1], 0.12);
const hasSide = (name: string): boolean => /\b(left|right|l|r)\b/i.test(words(name));
const words = (name: string): string => name.replaceAll(/[_.-]/g, ' ');
const stem = (name: string): string =>
  words(name)
    .replaceAll(/\b(left|right|l|r)\b/gi, '')
    .trim();
