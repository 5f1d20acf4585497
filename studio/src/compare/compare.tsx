// Verb 1: photo, model and residual of every example and camera.
import {signal} from '@preact/signals';
import type {RefObject} from 'preact';
import {useEffect, useRef} from 'preact/hooks';
import type {PhotoEntry, StepEntry} from '../document';
import {saveCsv} from '../download';
import {Ask} from '../facts/glossary';
import {figure} from '../format';
import {savePictures} from '../pictures';
import {chosenPhoto, figuresOf, other, run, step, units, wantedPixel} from '../state';
import {Buttons, Legend, Toolbar} from '../widgets';
import {counted, residualRamp, valuesAt, type Kind} from './frames';
import {Panel} from './panel';
import {PhotoList} from './photo_list';
import {leastMotion, useShown, type Shown} from './shown';
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

/** Values of the shown step, and the residual of the one it is compared with. */
function readout(shown: Shown | null, second: Shown | null): string {
  const pixel = cursor.value;
  if (!shown || !pixel) return 'Point at a pixel, or move the cross with the arrow keys.';
  const v = valuesAt(shown.frames, pixel.x, pixel.y);
  if (Number.isNaN(v.residual))
    return `(${pixel.x}, ${pixel.y})  photo ${figure(v.photo, 4)}  ·  this pixel does not count`;
  const sigmas = (r: number): string => (Number.isNaN(r) ? 'does not count' : `${r.toFixed(2).replace('-', '−')} σ`);
  const beside = second && other.value
    ? `  ·  ${other.value.folder}: ${sigmas(valuesAt(second.frames, pixel.x, pixel.y).residual)}` : '';
  return `(${pixel.x}, ${pixel.y})  photo ${figure(v.photo, 4)}  model ${figure(v.model, 4)}  ` +
    `residual ${figure(v.model - v.photo, 3)} = ${sigmas(v.residual)}  (σ ${figure(v.sigma, 3)})${beside}`;
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

/** What counts, in the middle of every panel. */
function fitAll(shown: Shown | null): void {
  focus.value = shown ? counted(shown.frames) : null;
  place.value = {scale: 0, x: 0, y: 0};
}

/** Arrow keys move the cross, + and - zoom, 0 fits. */
function keys(event: KeyboardEvent, entry: PhotoEntry, shown: Shown | null, area: HTMLElement): void {
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
    const panel = area.querySelector('canvas')!;
    const size = {width: panel.clientWidth, height: panel.clientHeight};
    if (cursor.value && event.key === '+' && place.value.scale === 0)
      place.value = {scale: resolved(size, entry).scale, ...cursor.value};
    zoom(size, entry, event.key === '+' ? 1.5 : 1 / 1.5, size.width / 2, size.height / 2);
  } else if (event.key === '0') fitAll(shown);
  else return;
  event.preventDefault();
}

/** What can be alternated between: the last two only where there is another step. */
const offeredPairs = (): string[] => Object.keys(pairs).filter((name) => other.value || !name.endsWith('both steps'));
const chosenPair = (): string => (offeredPairs().includes(pair.value) ? pair.value : offeredPairs()[0]);

function Tools(props: {entry: PhotoEntry; shown: Shown | null; area: RefObject<HTMLDivElement>}) {
  const {entry, shown, area} = props;
  const apart = layout.value === 'side by side';
  return (
    <Toolbar>
      <Buttons label="Layout" values={layouts} chosen={layout} />
      {!apart && <Buttons label="Pictures" values={offeredPairs()} chosen={pair} />}
      {layout.value === 'swipe' && (
        <label>Swipe <input type="range" min="0" max="1" step="0.01" value={split.value}
          onInput={(e) => (split.value = Number(e.currentTarget.value))} /></label>
      )}
      {apart && <label><input type="checkbox" checked={showArrows.value}
        onChange={(e) => (showArrows.value = e.currentTarget.checked)} /> arrows</label>}
      <button onClick={() => fitAll(shown)}>Fit</button>
      <button onClick={() => {
        focus.value = null;
        place.value = {scale: 0, x: 0, y: 0};
        area.current?.focus();  // where 0 fits again
      }}>Whole</button>
      <button onClick={() => (place.value = {scale: 1, x: entry.width / 2, y: entry.height / 2})}>1:1</button>
      <span class="push" />
      <button onClick={() => shown && pixelCsv(shown)}>CSV</button>
      <button onClick={() => savePictures(`${entry.name}${shown?.arrows.length && apart && showArrows.value ? `-arrows-${figure(shown.gain)}-times-as-long` : ''}.png`, [...area.current!.querySelectorAll('.panel')].map((panel) => (
        {canvas: panel.querySelector('canvas')!, says: panel.querySelector('figcaption')!.textContent ?? ''})), [residualRamp])}>PNG</button>
    </Toolbar>
  );
}

function SideBySide(props: {entry: PhotoEntry; shown: Shown | null; second: Shown | null}) {
  const {entry, shown, second} = props;
  const chi = (of: StepEntry | undefined): string => figure(figuresOf(of, entry)?.chi);
  // One gain for both steps; the shown one's, unless there is nothing left in it.
  const common = {photo: entry, gain: (shown?.arrows.length ? shown : second ?? shown)?.gain};
  const layer = (of: Shown | null, kind: Kind) => ({layer: of?.layers[kind] ?? null, absent: absent(of, kind)});
  return <>
    <Panel title={`photo · ${entry.example} ${entry.camera}`} {...layer(shown, 'photo')} {...common} />
    <Panel title="model" {...layer(shown, 'model')} {...common} />
    <Panel title={`residual${other.value ? ' of ' + step.value!.folder : ''}, RMS ${chi(step.value)}`} {...layer(shown, 'residual')}
           arrows={showArrows.value ? shown?.arrows : undefined} {...common} />
    {other.value && <Panel title={`residual of ${other.value.folder}, RMS ${chi(other.value)}`} {...layer(second, 'residual')}
                           arrows={showArrows.value ? second?.arrows : undefined} {...common} />}
  </>;
}

/** Why a picture that was looked for is not there. */
function absent(of: Shown | null, kind: Kind): string | undefined {
  if (!of || of.layers[kind]) return undefined;
  return kind !== 'residual' && !of.frames.photo ? 'The photo is not here.' : 'Its residual is not here.';
}

/** Swipe or blink between two pictures. */
function Alternating(props: {entry: PhotoEntry; shown: Shown | null; second: Shown | null}) {
  const {entry, shown, second} = props;
  const [a, b] = pairs[chosenPair()];
  const then = a === b ? second : shown;
  const names = a === b ? [`${a} of ${step.value?.folder}`, `${b} of ${other.value?.folder}`] : [a, b];
  const missing = absent(shown, a) ?? absent(then, b);
  const [first, last] = [shown?.layers[a] ?? null, then?.layers[b] ?? null];
  if (layout.value === 'swipe')
    return <Panel title={names.join(' | ')} photo={entry} layer={first} second={last} split={split.value} absent={missing}
                  onSplit={(at) => (split.value = at)} />;
  return <Panel title={names[blinkOn.value ? 1 : 0]} photo={entry} layer={blinkOn.value ? last : first} absent={missing} />;
}

function ArrowLegend(props: {shown: Shown | null; second: Shown | null}) {
  const {shown, second} = props;
  const flow = shown?.flow;
  if (!flow || layout.value !== 'side by side') return null;
  const rms = `rms ${figure(flow.rms_px)} px = ${figure(flow.rms_px * flow.length_per_px)} ${units.value.length}`;
  if (!shown.arrows.length && !second?.arrows.length)
    return <span class="arrow-legend">no arrows: the displacement that would remove the residual is {rms}, below {leastMotion} px</span>;
  return <span class="arrow-legend">
    arrows: the displacement that would remove the residual, {figure(shown.arrows.length ? shown.gain : second?.gain)} times as long;
    {' '}{rms}; the longest are cut{other.value && !(shown.arrows.length && second?.arrows.length) && `; none where rms is below ${leastMotion} px`}
  </span>;
}

function useLooks(shown: Shown | null, entry: PhotoEntry | undefined): void {
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
}

export function Compare() {
  const index = Math.min(chosenPhoto.value, run.value.photos.length - 1);
  const shown = useShown(index, step.value);
  const second = useShown(index, other.value);
  const area = useRef<HTMLDivElement>(null);
  const listed = run.value.photos[index];
  // A photo that the capture does not tell of has the size of its residual.
  const entry = listed?.width === 0 ? (shown ?? second)?.frames.entry ?? {...listed, width: 1, height: 1} : listed;
  useLooks(shown, entry);
  if (!entry)
    return <p class="empty">There is no photo to show. {run.value.faults.join('. ')}</p>;
  return (
    <div class="compare">
      <PhotoList />
      <div class="stage">
        <Tools entry={entry} shown={shown} area={area} />
        <div class="panels" ref={area} tabIndex={0} role="group" onKeyDown={(event) => keys(event, entry, shown, area.current!)}
             aria-label="Pictures: arrow keys move the cross, + and - zoom, 0 fits">
          {layout.value === 'side by side' ? <SideBySide entry={entry} shown={shown} second={other.value ? second : null} />
            : <Alternating entry={entry} shown={shown} second={second} />}
        </div>
        <p class="readout" role="status" id="readout">{readout(shown, second)}</p>
        <div class="legends">
          <Legend ramp={residualRamp} /><Ask word="sigma" />
          <ArrowLegend shown={shown} second={other.value ? second : null} />
          <span class="swatch">grey: does not count</span>
        </div>
      </div>
    </div>
  );
}
