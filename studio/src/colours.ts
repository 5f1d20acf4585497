// Colour scales. Diverging: blue - white - red (ends of ColorBrewer's RdBu, safe for colour-blind
// eyes), straight in OKLab (Ottosson 2020) from either end to white, hence even in lightness and
// centred at zero. Sequential: viridis (van der Walt, Smith 2015), by its anchors.
export type Rgb = [number, number, number];

const linear = (c: number): number => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const gamma = (c: number): number =>
  c <= 0.0031308 ? 12.92 * c : 1.055 * Math.max(c, 0) ** (1 / 2.4) - 0.055;

function toLab([r, g, b]: Rgb): Rgb {
  const [R, G, B] = [linear(r / 255), linear(g / 255), linear(b / 255)];
  const l = Math.cbrt(0.4122214708 * R + 0.5363325363 * G + 0.0514459929 * B);
  const m = Math.cbrt(0.2119034982 * R + 0.6806995451 * G + 0.1073969566 * B);
  const s = Math.cbrt(0.0883024619 * R + 0.2817188376 * G + 0.6299787005 * B);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function fromLab([L, a, b]: Rgb): Rgb {
  const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (L - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const out = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return out.map((c) => Math.round(255 * Math.min(1, Math.max(0, gamma(c))))) as Rgb;
}

function table(anchors: Rgb[]): Rgb[] {
  const labs = anchors.map(toLab);
  return Array.from({length: 256}, (_, i) => {
    const t = (i / 255) * (labs.length - 1);
    const k = Math.min(labs.length - 2, Math.floor(t));
    return fromLab(labs[k].map((v, c) => v + (t - k) * (labs[k + 1][c] - v)) as Rgb);
  });
}

const divergingTable = table([
  [33, 102, 172],
  [247, 247, 247],
  [178, 24, 43],
]);
const sequentialTable = table([
  [68, 1, 84],
  [71, 44, 122],
  [59, 81, 139],
  [44, 113, 142],
  [33, 144, 141],
  [39, 173, 129],
  [92, 200, 99],
  [170, 220, 50],
  [253, 231, 37],
]);

/** t in -1..1. */
export function diverging(t: number): Rgb {
  return divergingTable[Math.round(127.5 * (1 + Math.min(1, Math.max(-1, t))))];
}
/** t in 0..1. */
export function sequential(t: number): Rgb {
  return sequentialTable[Math.round(255 * Math.min(1, Math.max(0, t)))];
}
export const notCounted: Rgb = [140, 140, 140];

/** Intensity to what a screen shows (sRGB). */
export function shown(intensity: number): number {
  return Math.round(255 * gamma(Math.min(1, Math.max(0, intensity))));
}

export function css([r, g, b]: Rgb): string {
  return `rgb(${r} ${g} ${b})`;
}

/** A scale of colours with what it says: `from` -1 or 0 to 1. */
export interface Ramp {
  title: string;
  ends: [string, string, string];
  scale: (t: number) => Rgb;
  from: number;
}

/** Background of a legend. */
export function gradient(ramp: Ramp): string {
  const stops = Array.from({length: 17}, (_, i) => css(ramp.scale(ramp.from + ((1 - ramp.from) * i) / 16)));
  return `linear-gradient(to right, ${stops.join(', ')})`;
}
