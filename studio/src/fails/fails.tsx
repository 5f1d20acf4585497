// Verb 2: the body in space, coloured by what is wrong; small multiples by load case; bars.
import {signal} from '@preact/signals';
import {useEffect, useRef, useState} from 'preact/hooks';
import {diverging, gradient, notCounted, sequential, type Rgb} from '../colours';
import {saveCanvas, saveCsv, saveSideBySide, saveText} from '../download';
import {figure} from '../format';
import {chosenPhoto, run, step, theme, units, verb, wantedPixel} from '../state';
import {Buttons, Legend, Toolbar} from '../widgets';
import {FailureBars} from './bars';
import type {BodyScene, Look} from './scene';
import {examplesOf, quantities, quantityNames, reach, surface, type Quantity, type Surface} from './surface';
import {useScene} from './use_scene';
import {surfaceVtu} from './vtu';

const quantity = signal<Quantity>('residual');
const amount = signal(1);
const chosenExample = signal('');
const picked = signal(-1);

function unitOf(q: Quantity): string {
  if (q === 'residual') return 'σ of noise';
  if (q === 'strain') return 'largest principal Green strain';
  return q === 'von_mises' ? `${units.value.stress}, von Mises` : units.value.length;
}

/** Strain has a sign, the others do not. */
function scaleOf(q: Quantity): {colour: (t: number) => Rgb; signed: boolean} {
  return q === 'strain' ? {colour: diverging, signed: true} : {colour: sequential, signed: false};
}

function lookOf(s: Surface, q: Quantity, most: number, ghost: boolean): Look {
  const {colour} = scaleOf(q);
  const values = s.scalars[q];
  return {
    amount: amount.value,
    ghost,
    colour: (i) => (Number.isFinite(values[i]) ? colour(values[i] / most) : notCounted),
  };
}

function Thumbnails(props: {scene: BodyScene | null; surfaces: Map<string, Surface>; most: number}) {
  const refs = useRef(new Map<string, HTMLCanvasElement>());
  const {scene, surfaces, most} = props;
  useEffect(() => {
    if (!scene) return;
    let timer = 0;
    const draw = (): void => {
      for (const [name, canvas] of refs.current) {
        const s = surfaces.get(name);
        if (s) scene.thumbnail(s, lookOf(s, quantity.value, most, false), canvas);
      }
    };
    scene.onMove = () => {
      clearTimeout(timer);
      timer = window.setTimeout(draw, 150);
    };
    timer = window.setTimeout(draw, 30);
    return () => clearTimeout(timer);
  }, [scene, surfaces, most, quantity.value, amount.value, theme.value]);
  return (
    <div class="thumbnails" role="group" aria-label="Load cases">
      {[...surfaces.keys()].map((name) => (
        <button key={name} aria-pressed={chosenExample.value === name}
                onClick={() => (chosenExample.value = name)}>
          <canvas ref={(c) => {
            if (c) refs.current.set(name, c);
          }} aria-hidden="true" />
          <span>{name}</span>
        </button>
      ))}
      <span class="push" />
      <button class="quiet" aria-label="PNG of all load cases" onClick={() =>
        saveSideBySide('load-cases.png', [...surfaces.keys()].flatMap((name) => refs.current.get(name) ?? []))}>PNG</button>
    </div>
  );
}

function Picked(props: {s: Surface}) {
  const {s} = props;
  const node = picked.value;
  if (node < 0 || 3 * node >= s.rest.length)
    return <p class="note">Click a point of the body, or press <kbd>Enter</kbd> on it: its values, and every photo that sees it.</p>;
  const x = [0, 1, 2].map((i) => figure(s.rest[3 * node + i])).join(', ');
  const views = s.views.filter((view) => view.seen[node] > 0);
  return (
    <div class="picked">
      <p>Rest point ({x}) {units.value.length}</p>
      <ul>
        {quantities.map((q) => <li key={q}>{quantityNames[q]} <b>{figure(s.scalars[q][node])}</b> {q === 'strain' ? '' : unitOf(q)}</li>)}
      </ul>
      {views.length === 0 && <p>No photo sees it.</p>}
      {views.map((view) => (
        <button key={view.photo} onClick={() => {
          const index = run.value.photos.findIndex((p) => p.name === view.photo);
          if (index < 0) return;
          chosenPhoto.value = index;
          wantedPixel.value = {photo: view.photo, x: view.pixel[2 * node], y: view.pixel[2 * node + 1]};
          verb.value = 'compare';
        }}>{view.photo} ({Math.round(view.pixel[2 * node])}, {Math.round(view.pixel[2 * node + 1])})</button>
      ))}
    </div>
  );
}

function fieldsCsv(s: Surface, name: string): void {
  const rows: unknown[][] = [['x', 'y', 'z', ...quantities]];
  for (let i = 0; i < s.rest.length / 3; ++i)
    rows.push([s.rest[3 * i], s.rest[3 * i + 1], s.rest[3 * i + 2], ...quantities.map((q) => s.scalars[q][i])]);
  saveCsv(`${name}-surface.csv`, rows);
}

export function Fails() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const {scene, fault: sceneFault} = useScene(canvas);
  const [surfaces, setSurfaces] = useState(new Map<string, Surface>());
  const [fault, setFault] = useState('');
  const notHere = examplesOf(step.value).length ? '' : `The body of this step is not here. ${run.value.reduction ?? ''}`;
  const now = step.value;

  useEffect(() => {
    let current = true;
    if (!now) return;
    const names = examplesOf(now);
    // The capture's order, as far as it is known.
    const order = (run.value.capture?.examples ?? []).map((e) => e.name);
    names.sort((a, b) => order.indexOf(a) - order.indexOf(b));
    void Promise.all(names.map(async (name) => [name, await surface(now, name)] as const)).then(
      (all) => {
        if (!current) return;
        setSurfaces(new Map(all));
        if (!names.includes(chosenExample.value)) {
          const by = now.metrics?.chi_by_example ?? {};
          chosenExample.value = [...names].sort((a, b) => (by[b] ?? 0) - (by[a] ?? 0))[0] ?? '';
        }
      },
      (error: Error) => current && setFault(error.message));
    return () => {
      current = false;
    };
  }, [now]);

  const q = quantity.value;
  const most = reach([...surfaces.values()].map((s) => s.scalars[q]));
  const shown = surfaces.get(chosenExample.value);
  useEffect(() => {
    if (!scene || !shown) return;
    scene.setBackground(getComputedStyle(document.body).getPropertyValue('--stage').trim() || '#ffffff');
    scene.show(shown, lookOf(shown, q, most, amount.value > 0));
    scene.mark(picked.value);
  }, [scene, shown, q, most, amount.value, theme.value]);
  useEffect(() => scene?.mark(picked.value), [scene, picked.value]);

  if (!now) return <p class="empty">No step is finished yet.</p>;
  const scale = scaleOf(q);
  const keys = (event: KeyboardEvent): void => {
    if (!scene || scene.key(event) || event.key !== 'Enter') return;
    picked.value = scene.pick(scene.canvas.clientWidth / 2, scene.canvas.clientHeight / 2);
    event.preventDefault();
  };
  return (
    <div class="fails">
      <div class="stage">
        <Toolbar>
          <Buttons label="Colour by" values={quantities} chosen={quantity} names={quantityNames} />
          <label>deformed × {amount.value.toFixed(1)} <input type="range" min="0" max="5" step="0.1" value={amount.value}
            onInput={(e) => (amount.value = Number(e.currentTarget.value))} /></label>
          <button onClick={() => scene?.frame()}>Fit</button>
          <span class="push" />
          <button onClick={() => shown && fieldsCsv(shown, chosenExample.value)}>CSV</button>
          <button onClick={() => canvas.current && saveCanvas(`${chosenExample.value}-body.png`, canvas.current)}>PNG</button>
          <button onClick={() => shown && saveText(`${chosenExample.value}-surface.vtu`, surfaceVtu(shown), 'application/xml')}>VTU</button>
        </Toolbar>
        <div class="body3d">
          {(sceneFault || fault || notHere) && <p class="empty">{sceneFault || fault || notHere}</p>}
          <canvas ref={canvas} tabIndex={0} role="img" onKeyDown={keys}
            aria-label={`The body in example ${chosenExample.value}, coloured by ${quantityNames[q]}; arrow keys turn it, + and - zoom, Enter picks the middle`}
            onClick={(e) => scene && (picked.value = scene.pick(e.offsetX, e.offsetY))} />
          <Legend title={`${quantityNames[q]} [${unitOf(q)}]`} from={scale.signed ? figure(-most) : '0'}
            middle={scale.signed ? '0' : ''} to={figure(most)}
            background={gradient(scale.colour, scale.signed ? -1 : 0, 1)} />
        </div>
        <Thumbnails scene={scene} surfaces={surfaces} most={most} />
      </div>
      <aside>
        {shown && <Picked s={shown} />}
        <FailureBars step={now} />
      </aside>
    </div>
  );
}
