/** Linear RGB, each channel in [0, 1]: what the lights of the scene work in. */
export type LinearRgb = readonly [number, number, number];

/** Björn Ottosson's OKLab (2020): equal steps look equal. L in [0, 1], a (green–red) and b (blue–yellow) in about ±0.3. */
export function fromOklab(lightness: number, a: number, b: number): LinearRgb {
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    clamp(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
    clamp(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
    clamp(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s),
  ];
}

/** "#rrggbb" in sRGB to linear. */
export function fromHex(hex: string): LinearRgb {
  const channel = (k: number): number => decode(parseInt(hex.slice(2 * k + 1, 2 * k + 3), 16) / 255);
  return [channel(0), channel(1), channel(2)];
}

/** A channel as sRGB, in [0, 255]. */
export const toByte = (channel: number): number => Math.round(255 * encode(channel));

/** For style sheets and 2D canvases. */
export const toCss = (colour: LinearRgb): string => `rgb(${colour.map(toByte).join(' ')})`;

export const mix = (from: LinearRgb, to: LinearRgb, share: number): LinearRgb => [
  from[0] + (to[0] - from[0]) * share,
  from[1] + (to[1] - from[1]) * share,
  from[2] + (to[2] - from[2]) * share,
];

const clamp = (value: number): number => Math.min(1, Math.max(0, value));
const decode = (value: number): number => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
const encode = (value: number): number => (value <= 0.0031308 ? value * 12.92 : 1.055 * value ** (1 / 2.4) - 0.055);
