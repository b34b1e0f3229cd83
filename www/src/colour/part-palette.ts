import { fromHex, mix, type LinearRgb } from './colour-space';

/** Okabe and Ito's eight colours for all kinds of colour vision, black left out (it swallows the shading). */
const hues = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#d55e00', '#56b4e9', '#f0e442'].map(fromHex);
const unsided = ['#8c8c8c', '#c9c2b4', '#6d7f92'].map(fromHex);

/**
 * One colour per part name. Left and right of the same part share a hue, the right one darker, so that a flip is seen at once;
 * parts without a side are grey.
 */
export function partPalette(names: readonly string[]): LinearRgb[] {
  const sided = /\b(left|right|l|r)\b/i;
  const stems = [...new Set(names.filter((name) => sided.test(words(name))).map(stem))];
  let plain = 0;
  return names.map((name) => {
    if (!sided.test(words(name)) && stems.length > 0) return unsided[plain++ % unsided.length];
    const hue = hues[(stems.length > 0 ? stems.indexOf(stem(name)) : plain++) % hues.length];
    return /\b(right|r)\b/i.test(words(name)) ? mix(hue, [0, 0, 0], 0.55) : mix(hue, [1, 1, 1], 0.12);
  });
}

const words = (name: string): string => name.replaceAll(/[_.-]/g, ' ');
const stem = (name: string): string =>
  words(name)
    .replaceAll(/\b(left|right|l|r)\b/gi, '')
    .trim();
