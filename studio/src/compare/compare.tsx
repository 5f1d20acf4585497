// Verb 1: photo, model and residual of every example and camera.
import {signal} from '@preact/signals';
import {useEffect, useRef, useState} from 'preact/hooks';
import type {StepEntry} from '../document';
import {saveCsv} from '../download';
import {figure} from '../format';
import {array, field, type StoredArray} from '../parts';
import {savePictures} from '../pictures';
import {chosenPhoto, figuresOf, floor, other, run, step, units, wantedPixel} from '../state';
import {Buttons, Legend, Toolbar} from '../widgets';
import {counted, frames, paint, residualRamp, valuesAt, type Frames, type Kind} from './frames';
import {Panel, type Arrow, type Layer} from './panel';
import {cursor, focus, place, resolved, zoom} from './viewport';

const layouts = ['side by side', 'swipe', 'blink'] as const;
const layout = signal<(typeof layouts)[number]>('side by side');
const showArrows = signal(true);
const split = signal(0.5);
const blinkOn = signal(false);
/** What swipe and blink alternate between; the last two between the shown step and the other. */
const pairs: Record<string, [Kind, Kind]> = {
  'photo | model': ['photo', 'model'],
  'photo | residual': ['photo', 'residual'],
  'model | residual': ['model', 'residual'],
  'residuals of both steps': ['residual', 'residual'],
  'models of both steps': ['model', 'model'],
};
const pair = signal('photo | model');

interface Flow {
  cell_px: number;
  rms_px: number;
  length_per_px: number;
  cells: StoredArray;
}

interface Shown {
  frames: Frames;
  layers: Record<Kind, Layer>;
  flow: Flow | null;
  arrows: Arrow[];
  gain: number;
}

function arrowsOf(flow: Flow | null): {arrows: Arrow[]; gain: number} {
  if (!flow) return {arrows: [], gain: 1};
  const cells = array(flow.cells);
  const arrows: Arrow[] = [];
  for (let i = 0; i < cells.length; i += 5)
    if (cells[i + 4] > 0)
      arrows.push({x: cells[i], y: cells[i + 1], dx: cells[i + 2], dy: cells[i + 3]});
  const lengths = arrows.map((a) => Math.hypot(a.dx, a.dy)).sort((a, b) => a - b);
  const large = Math.max(1e-3, lengths[Math.floor(0.9 * lengths.length)] ?? 1);
  const wanted = (1.5 * flow.cell_px) / large;
  const decade = 10 ** Math.floor(Math.log10(wanted));
  return {arrows, gain: ([5, 2, 1].find((s) => s * decade <= wanted) ?? 1) * decade};
}

async function load(index: number, of: StepEntry | undefined): Promise<Shown | null> {
  const entry = run.value.photos[index];
  if (!entry) return null;
  const all = await frames(entry, of);
  const layer = (kind: Kind): Layer => ({
    canvas: paint(all, kind),
    shrink: (kind === 'photo' ? all.photo : (all.residual ?? all.photo))?.shrink ?? 1,
  });
  const name = of?.fields[`photo-${entry.name}`];
  const flow = name ? await field<Flow>(name).catch(() => null) : null;
  return {
    frames: all,
    layers: {photo: layer('photo'), model: layer('model'), residual: layer('residual')},
    flow,
    ...arrowsOf(flow),
  };
}

function useShown(index: number, of: StepEntry | undefined): Shown | null {
  const [shown, setShown] = useState<Shown | null>(null);
  useEffect(() => {
    let current = true;
    void load(index, of).then((value) => current && setShown(value));
    return () => {
      current = false;
    };
  }, [index, of]);
  return shown;
}

/** Every example and camera, with chi and what is left in it. */
function PhotoList() {
  const list = run.value.photos;
  return (
    <ul class="photos" role="listbox" aria-label="Photos" tabIndex={0}
        aria-activedescendant={`photo-${chosenPhoto.value}`}
        onKeyDown={(event) => {
          const by = {ArrowDown: 1, ArrowUp: -1, ArrowRight: 1, ArrowLeft: -1}[event.key];
          if (!by) return;
          event.preventDefault();
          chosenPhoto.value = (chosenPhoto.value + by + list.length) % list.length;
        }}>
      {list.map((photo, i) => {
        const told = figuresOf(step.value, photo);
        const then = figuresOf(other.value, photo);
        const over = told ? told.chi / floor.value.chi : 0;
        return (
          <li key={photo.name} id={`photo-${i}`} role="option" aria-selected={i === chosenPhoto.value}
              onClick={() => (chosenPhoto.value = i)}>
            <span class="name">{photo.example}<small> {photo.camera}{photo.use === 'validate' ? ' · held out' : ''}</small></span>
            <span class="value">{figure(told?.chi)}{then && ` → ${figure(then.chi)}`}</span>
            <span class="bar" style={{width: `${Math.min(100, (100 * Math.log2(1 + over)) / 4)}%`}} />
          </li>
        );
      })}
    </ul>
  );
}

function readout(shown: Shown | null): string {
  const pixel = cursor.value;
  if (!shown || !pixel) return 'Point at a pixel, or move the cross with the arrow keys.';
  const v = valuesAt(shown.frames, pixel.x, pixel.y);
  if (Number.isNaN(v.residual))
    return `(${pixel.x}, ${pixel.y})  photo ${figure(v.photo, 4)}  ·  this pixel does not count`;
  return `(${pixel.x}, ${pixel.y})  photo ${figure(v.photo, 4)}  model ${figure(v.model, 4)}  ` +
    `residual ${figure(v.model - v.photo, 3)} = ${v.residual.toFixed(2).replace('-', '−')} σ  ` +
    `(σ ${figure(v.sigma, 3)})`;
}

/** Photo, model, residual and noise of all pixels that count around the cross, or of all. */
function pixelCsv(shown: Shown): void {
  const {width, height, name} = shown.frames.entry;
  const rows: unknown[][] = [['x', 'y', 'photo', 'model', 'residual_sigma', 'sigma']];
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const v = valuesAt(shown.frames, x, y);
      if (!Number.isNaN(v.residual))
        rows.push([x, y, v.photo.toFixed(5), v.model.toFixed(5), v.residual.toFixed(3), v.sigma.toFixed(6)]);
    }
  saveCsv(`${name}.csv`, rows);
}

export function Compare() {
  const index = Math.min(chosenPhoto.value, run.value.photos.length - 1);
  const shown = useShown(index, step.value);
  const second = useShown(index, other.value);
  const area = useRef<HTMLDivElement>(null);
  const entry = run.value.photos[index];

  useEffect(() => {
    if (layout.value !== 'blink') return;
    const timer = setInterval(() => (blinkOn.value = !blinkOn.value), 600);
    return () => clearInterval(timer);
  }, [layout.value]);
  useEffect(() => {
    focus.value = shown ? counted(shown.frames) : null;
  }, [shown]);
  useEffect(() => {
    const wanted = wantedPixel.value;
    if (!wanted || !entry || wanted.photo !== entry.name) return;
    cursor.value = {x: Math.round(wanted.x), y: Math.round(wanted.y)};
    place.value = {scale: 4, x: wanted.x, y: wanted.y};
    wantedPixel.value = null;
  }, [entry, wantedPixel.value]);

  if (!entry)
    return <p class="empty">There is no photo to show. {run.value.faults.join('. ')}</p>;

  const keys = (event: KeyboardEvent): void => {
    const steps: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1],
    };
    const by = steps[event.key];
    if (by) {
      const from = cursor.value ?? {x: entry.width >> 1, y: entry.height >> 1};
      const far = event.shiftKey ? 10 : 1;
      const clamp = (v: number, most: number): number => Math.min(most - 1, Math.max(0, v));
      cursor.value = {x: clamp(from.x + far * by[0], entry.width), y: clamp(from.y + far * by[1], entry.height)};
      if (place.value.scale > 0) place.value = {...place.value, ...cursor.value};
    } else if (event.key === '+' || event.key === '-') {
      const panel = area.current!.querySelector('canvas')!;
      const size = {width: panel.clientWidth, height: panel.clientHeight};
      if (cursor.value && event.key === '+' && place.value.scale === 0)
        place.value = {scale: resolved(size, entry).scale, ...cursor.value};
      zoom(size, entry, event.key === '+' ? 1.5 : 1 / 1.5, size.width / 2, size.height / 2);
    } else if (event.key === '0') place.value = {scale: 0, x: 0, y: 0};
    else return;
    event.preventDefault();
  };

  const offered = Object.keys(pairs).filter((name) => other.value || !name.endsWith('both steps'));
  const chosenPair = offered.includes(pair.value) ? pair.value : offered[0];
  const [a, b] = pairs[chosenPair];
  const first = shown?.layers[a] ?? null;
  const then = (a === b ? second : shown)?.layers[b] ?? null;
  const names = a === b ? [`${a} of ${step.value?.folder}`, `${b} of ${other.value?.folder}`] : [a, b];
  const chi = (of: StepEntry | undefined): string =>
    figure(figuresOf(of, entry)?.chi);
  const arrows = showArrows.value ? shown?.arrows : undefined;
  const common = {photo: entry, gain: shown?.gain};
  return (
    <div class="compare">
      <PhotoList />
      <div class="stage">
        <Toolbar>
          <Buttons label="Layout" values={layouts} chosen={layout} />
          {layout.value !== 'side by side' && <Buttons label="Pictures" values={offered} chosen={pair} />}
          {layout.value === 'swipe' && (
            <label>Swipe <input type="range" min="0" max="1" step="0.01" value={split.value}
              onInput={(e) => (split.value = Number(e.currentTarget.value))} /></label>
          )}
          <label><input type="checkbox" checked={showArrows.value}
            onChange={(e) => (showArrows.value = e.currentTarget.checked)} /> arrows</label>
          <button onClick={() => (place.value = {scale: 0, x: 0, y: 0})}>Fit</button>
          <button onClick={() => {
            focus.value = null;
            place.value = {scale: 0, x: 0, y: 0};
          }}>Whole</button>
          <button onClick={() => (place.value = {scale: 1, x: entry.width / 2, y: entry.height / 2})}>1:1</button>
          <span class="push" />
          <button onClick={() => shown && pixelCsv(shown)}>CSV</button>
          <button onClick={() => savePictures(`${entry.name}.png`, [...area.current!.querySelectorAll('.panel')].map((panel) => (
            {canvas: panel.querySelector('canvas')!, says: panel.querySelector('figcaption')!.textContent ?? ''})), [residualRamp])}>PNG</button>
        </Toolbar>
        <div class="panels" ref={area} tabIndex={0} role="group" onKeyDown={keys}
             aria-label="Pictures: arrow keys move the cross, + and - zoom, 0 fits">
          {layout.value === 'side by side' && <>
            <Panel title={`photo · ${entry.example} ${entry.camera}`} layer={shown?.layers.photo ?? null} {...common} />
            <Panel title="model" layer={shown?.layers.model ?? null} {...common} />
            <Panel title={`residual${other.value ? ' of ' + step.value!.folder : ''} · χ ${chi(step.value)}`} layer={shown?.layers.residual ?? null} arrows={arrows} {...common} />
            {other.value && <Panel title={`residual of ${other.value.folder} · χ ${chi(other.value)}`}
              layer={second?.layers.residual ?? null} arrows={showArrows.value ? second?.arrows : undefined} {...common} />}
          </>}
          {layout.value === 'swipe' && <Panel title={names.join(' | ')} layer={first} second={then} split={split.value} {...common} />}
          {layout.value === 'blink' && <Panel title={names[blinkOn.value ? 1 : 0]} layer={blinkOn.value ? then : first} {...common} />}
        </div>
        <p class="readout" role="status" id="readout">{readout(shown)}</p>
        <div class="legends">
          <Legend ramp={residualRamp} />
          {shown?.flow && <span class="arrow-legend">
            arrows: the displacement that would remove the residual, {figure(shown.gain)} times as long;
            rms {figure(shown.flow.rms_px)} px = {figure(shown.flow.rms_px * shown.flow.length_per_px)} {units.value.length}; the longest are cut
          </span>}
          <span class="swatch">grey: does not count</span>
        </div>
      </div>
    </div>
  );
}
