// Photo, model and residual of one photo as grids of numbers and as coloured pictures.
import {diverging, notCounted, shown, type Ramp, type Rgb} from '../colours';
import type {PhotoEntry, StepEntry} from '../document';
import {at, picture, type Grid} from '../parts';
import type {Box} from './viewport';

/** Residuals are shown from -8 to +8 standard deviations in every picture of every run. */
export const residualScale = 8;
export const residualRamp: Ramp = {
  title: 'residual, model − photo [σ of noise]',
  ends: [`−${residualScale}`, '0', `+${residualScale}`],
  scale: diverging,
  from: -1,
};

export interface Frames {
  photo: Grid | null;
  sigma: Grid | null;
  residual: Grid | null;
  entry: PhotoEntry;
}

export async function frames(entry: PhotoEntry, step: StepEntry | undefined): Promise<Frames> {
  const residual = step?.residuals[entry.name];
  const quiet = <T>(wanted: Promise<T> | undefined): Promise<T | null> =>
    wanted ? wanted.catch(() => null) : Promise.resolve(null);
  const [photo, sigma, left] = await Promise.all([
    quiet(entry.photo && picture(entry.photo)),
    quiet(entry.sigma && picture(entry.sigma)),
    quiet(residual && picture(residual)),
  ]);
  const size = left && entry.width === 0 ? {width: left.width * left.shrink, height: left.height * left.shrink} : {};
  return {photo, sigma, residual: left, entry: {...entry, ...size}};
}

export interface PixelValues {
  photo: number;
  model: number;
  residual: number;
  sigma: number;
}

export function sigmaAt(frames: Frames, x: number, y: number, intensity: number): number {
  const noise = frames.entry.noise;
  if (!noise) return frames.sigma ? at(frames.sigma, x, y) : NaN;
  const photons = noise.full_well > 0 ? Math.max(intensity, 0) / noise.full_well : 0;
  return noise.factor * Math.sqrt(noise.read ** 2 + photons);
}

/** The model's intensity is the photo plus residual times noise, as the residual is defined. */
export function valuesAt(frames: Frames, x: number, y: number): PixelValues {
  const photo = frames.photo ? at(frames.photo, x, y) : NaN;
  const residual = frames.residual ? at(frames.residual, x, y) : NaN;
  const sigma = sigmaAt(frames, x, y, photo);
  return {photo, residual, sigma, model: photo + residual * sigma};
}

export type Kind = 'photo' | 'model' | 'residual';

/** The 99.5 % point of the photo shows as white. */
export function gainOf(photo: Grid): number {
  const sorted = Float32Array.from(photo.values.filter((v) => Number.isFinite(v))).sort();
  return 1 / Math.max(1e-3, sorted[Math.floor(sorted.length * 0.995)] ?? 1);
}

/** The picture, or nothing where it is not there. */
export function paint(frames: Frames, kind: Kind): HTMLCanvasElement | null {
  const source = {photo: frames.photo, residual: frames.residual, model: frames.photo && frames.residual}[kind];
  if (!source) return null;
  const canvas = document.createElement('canvas');
  canvas.width = source.width;
  canvas.height = source.height;
  const context = canvas.getContext('2d')!;
  const pixels = context.createImageData(canvas.width, canvas.height);
  const gain = frames.photo ? gainOf(frames.photo) : 1;
  const grey = (v: number): Rgb => [shown(v * gain), shown(v * gain), shown(v * gain)];
  for (let y = 0, i = 0; y < source.height; ++y)
    for (let x = 0; x < source.width; ++x, ++i) {
      let colour = notCounted;
      if (kind === 'photo') colour = grey(source.values[i]);
      else if (kind === 'residual') {
        const r = frames.residual ? frames.residual.values[i] : NaN;
        if (!Number.isNaN(r)) colour = diverging(r / residualScale);
      } else {
        const {model} = valuesAt(frames, x * source.shrink, y * source.shrink);
        if (!Number.isNaN(model)) colour = grey(model);
      }
      pixels.data.set([...colour, 255], 4 * i);
    }
  context.putImageData(pixels, 0, 0);
  return canvas;
}

/** The smallest box around the pixels that count, with a margin; null: all or none of them. */
export function counted(frames: Frames): Box | null {
  const grid = frames.residual;
  if (!grid) return null;
  let [left, top, right, bottom] = [Infinity, Infinity, -1, -1];
  for (let y = 0, i = 0; y < grid.height; ++y)
    for (let x = 0; x < grid.width; ++x, ++i)
      if (!Number.isNaN(grid.values[i])) {
        left = Math.min(left, x);
        right = Math.max(right, x);
        top = Math.min(top, y);
        bottom = Math.max(bottom, y);
      }
  if (right < 0) return null;
  const margin = 0.06 * Math.max(right - left, bottom - top);
  const s = grid.shrink;
  return {
    left: Math.max(0, (left - margin) * s),
    top: Math.max(0, (top - margin) * s),
    right: Math.min(frames.entry.width - 1, (right + margin) * s),
    bottom: Math.min(frames.entry.height - 1, (bottom + margin) * s),
  };
}
