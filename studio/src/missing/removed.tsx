// The residual that the chosen effect would remove, over the photo and on the body, beside the
// residual there is.
import {useEffect, useRef} from 'preact/hooks';
import {diverging, sequential, shown, type Ramp, type Rgb} from '../colours';
import type {PhotoEntry} from '../document';
import {saveCsv} from '../download';
import {figure, spaced} from '../format';
import {fromBase64, picture, type Grid} from '../parts';
import {savePictures} from '../pictures';
import {chosenPhoto, run, step} from '../state';
import {Legend} from '../widgets';
import {gainOf} from '../compare/frames';
import {OnBody} from './on_body';
import {usePrediction, type Cells, type Prediction} from './prediction';

/** The smallest box of cells that count, with a margin of a cell or two: the whole body as far as it is seen. */
function boxOf(cells: Cells, now: Uint8Array): {left: number; top: number; columns: number; rows: number} {
  let [left, top, right, bottom] = [cells.columns, cells.rows, -1, -1];
  for (let y = 0, i = 0; y < cells.rows; ++y)
    for (let x = 0; x < cells.columns; ++x, ++i)
      if (now[i] > 0) [left, top, right, bottom] = [Math.min(left, x), Math.min(top, y), Math.max(right, x), Math.max(bottom, y)];
  if (right < 0) return {left: 0, top: 0, columns: cells.columns, rows: cells.rows};
  const margin = Math.ceil(0.06 * Math.max(right - left, bottom - top));
  [left, top] = [Math.max(0, left - margin), Math.max(0, top - margin)];
  return {left, top, columns: Math.min(cells.columns - 1, right + margin) - left + 1, rows: Math.min(cells.rows - 1, bottom + margin) - top + 1};
}

/** One scale for what there is and for what the effect changes [sigma]: the 90 % point of what there is.
 *  The few cells along an edge that a body has left would make all others pale. */
function scaleOf(cells: Cells, unit: number): number {
  const there = fromBase64(cells.bytes).slice(0, cells.columns * cells.rows).filter((code) => code > 0).sort();
  return Math.max(1, ((there[Math.floor(0.9 * (there.length - 1))] ?? 1) - 1) * unit);
}

/** Whether nothing in a photo would change. */
function unchanged(cells: Cells): boolean {
  const count = cells.columns * cells.rows;
  const bytes = fromBase64(cells.bytes);
  return bytes.subarray(count).every((code, i) => bytes[i] === 0 || code === 128);
}

type Layer = 'now' | 'removed';

/** The value at a pixel; cells reach beyond the last ones. */
const nearest = (photo: Grid, x: number, y: number): number =>
  photo.values[Math.min(photo.height - 1, Math.floor(y / photo.shrink)) * photo.width + Math.min(photo.width - 1, Math.floor(x / photo.shrink))];

/** The photo in grey, and over it the cells, the more opaque the more there is to show. */
function draw(canvas: HTMLCanvasElement, prediction: Prediction, cells: Cells, photo: Grid | null, layer: Layer, scale: number): void {
  const bytes = fromBase64(cells.bytes);
  const count = cells.columns * cells.rows;
  const now = bytes.subarray(0, count);
  const part = boxOf(cells, now);
  const size = prediction.cell_px;
  canvas.width = part.columns * size;
  canvas.height = part.rows * size;
  const context = canvas.getContext('2d')!;
  const pixels = context.createImageData(canvas.width, canvas.height);
  const gain = photo ? gainOf(photo) : 1;
  for (let y = 0, i = 0; y < canvas.height; ++y)
    for (let x = 0; x < canvas.width; ++x, ++i) {
      const column = part.left + Math.floor(x / size);
      const row = part.top + Math.floor(y / size);
      const grey = photo ? shown(nearest(photo, part.left * size + x, part.top * size + y) * gain) : 128;
      const code = bytes[row * cells.columns + column + (layer === 'now' ? 0 : count)];
      let colour: Rgb = [grey, grey, grey];
      if (code > 0) {
        const sigmas = (layer === 'now' ? code - 1 : 128 - code) * prediction.unit;
        const t = sigmas / scale;
        const over = layer === 'now' ? sequential(t) : diverging(t);
        const alpha = Math.min(0.85, 0.15 + Math.abs(t));
        colour = over.map((c, k) => Math.round(alpha * c + (1 - alpha) * colour[k])) as Rgb;
      }
      pixels.data.set([...colour, 255], 4 * i);
    }
  context.putImageData(pixels, 0, 0);
}

function Layered(props: {prediction: Prediction; entry: PhotoEntry; layer: Layer; scale: number; says: string}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const {prediction, entry, layer, scale} = props;
  useEffect(() => {
    let current = true;
    const cells = prediction.photos[entry.name];
    const photo = entry.photo ? picture(entry.photo) : Promise.resolve(null);
    void photo.then((photo) => {
      if (current && canvas.current && cells) draw(canvas.current, prediction, cells, photo, layer, scale);
    }, () => undefined);
    return () => {
      current = false;
    };
  }, [prediction, entry, layer, scale]);
  return (
    <div>
      <canvas ref={canvas} role="img" aria-label={props.says} />
      <p class="note">{props.says}</p>
    </div>
  );
}

const rampsOf = (most: number): Ramp[] => [
  {title: 'residual there is [σ of noise]', ends: ['0', '', `${figure(most)} or more`], scale: sequential, from: 0},
  {title: 'change by the effect [σ of noise]', ends: [`−${figure(most)}: removed`, '0', `+${figure(most)}: added`], scale: diverging, from: -1},
];

function cellsCsv(prediction: Prediction, name: string, effect: string): void {
  const {columns, rows, bytes: packed} = prediction.photos[name];
  const bytes = fromBase64(packed);
  const table: unknown[][] = [['x', 'y', 'residual_sigma', 'removed_sigma']];
  for (let i = 0; i < columns * rows; ++i)
    if (bytes[i] > 0)
      table.push([(i % columns) * prediction.cell_px, Math.floor(i / columns) * prediction.cell_px,
        (bytes[i] - 1) * prediction.unit, (bytes[columns * rows + i] - 128) * prediction.unit]);
  saveCsv(`${effect}-removes-${name}.csv`, table);
}

export function Removed(props: {effect: string}) {
  const box = useRef<HTMLElement>(null);
  const part = step.value?.fields[`removes-${props.effect}`];
  const prediction = usePrediction(part);
  const photos = run.value.photos.filter((p) => prediction?.photos[p.name]);
  const wanted = run.value.photos[chosenPhoto.value]?.name;
  const entry = photos.find((p) => p.name === wanted) ?? photos[0];
  if (!part) return <p class="note">What it would change is not drawn: too little speaks for it.</p>;
  if (!prediction || !entry) return null;
  const says = `what ${spaced(props.effect)} would change`;
  const scale = scaleOf(prediction.photos[entry.name], prediction.unit);
  const ramps = rampsOf(scale);
  return (
    <figure class="removed" ref={box}>
      <figcaption>
        <label>W{says.slice(1)} in{' '}
          <select value={entry.name} onChange={(e) => {
            chosenPhoto.value = run.value.photos.findIndex((p) => p.name === e.currentTarget.value);
          }}>
            {photos.map((p) => <option key={p.name} value={p.name}>{p.name}</option>)}
          </select>
        </label>
        <button class="quiet" onClick={() => cellsCsv(prediction, entry.name, props.effect)}>CSV</button>
        <button class="quiet" onClick={() => savePictures(`${props.effect}-removes-${entry.name}.png`,
          [...box.current!.querySelectorAll('.pair > div')].map((part) => (
            {canvas: part.querySelector('canvas')!, says: part.querySelector('p')!.textContent ?? ''})), ramps)}>PNG</button>
      </figcaption>
      <div class="pair">
        <Layered prediction={prediction} entry={entry} layer="now" scale={scale} says="the residual there is" />
        <Layered prediction={prediction} entry={entry} layer="removed" scale={scale} says={says} />
        <OnBody prediction={prediction} scale={scale} example={entry.example}
                says={`${says}, on the body in ${entry.example}`} />
      </div>
      <div class="legends">{ramps.map((ramp) => <Legend key={ramp.title} ramp={ramp} />)}</div>
      {unchanged(prediction.photos[entry.name]) && <p class="note">Nothing would change in this photo: choose another one above.</p>}
      <p class="note">Both scales are the same: nine tenths of the residual there is lie within.</p>
    </figure>
  );
}
