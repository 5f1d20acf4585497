// Verb 2: the body in space, coloured by what is wrong; small multiples by load case; bars.
import {signal} from '@preact/signals';
import {useEffect, useRef, useState} from 'preact/hooks';
import {diverging, notCounted, sequential, type Ramp} from '../colours';
import type {Act, StepEntry} from '../document';
import {saveCsv, saveText} from '../download';
import {figure, listed} from '../format';
import {savePictures} from '../pictures';
import {run, step, theme} from '../state';
import {Buttons, Legend, Toolbar} from '../widgets';
import {FailureBars} from './bars';
import type {BodyScene, Look} from './scene';
import {examplesOf, hasSign, quantitiesOf, quantityNames, reach, readable, unitOf, type Quantity, type Surface} from './surface';
import {Picked, picked} from './picked';
import {useScene} from './use_scene';
import {surfaceVtu} from './vtu';

const quantity = signal<Quantity>('residual');
const amount = signal(1);
const chosenExample = signal('');

const showActs = signal(true);
const actsIn = (example: string): Act[] => run.value.capture?.examples.find((e) => e.name === example)?.acts ?? [];

const titles: Partial<Record<Quantity, string>> = {
  strain: 'strain: largest principal one of Green’s, no unit',
  stiffness: 'fitted stiffness: factor over the material’s, minus 1',
  swelling: 'fitted swelling: change of length, no unit',
  beyond: 'addends beyond their control points, mean of the elements there',
};

function rampOf(q: Quantity, most: number): Ramp {
  const title = titles[q] ?? `${quantityNames[q]} [${unitOf(q)}]`;
  return hasSign(q)
    ? {title, ends: [`${figure(-most)} or less`, '0', `${figure(most)} or more`], scale: diverging, from: -1}
    : {title, ends: ['0', '', `${figure(most)} or more`], scale: sequential, from: 0};
}

function lookOf(s: Surface, q: Quantity, most: number, ghost: boolean, acts?: Act[]): Look {
  const {scale} = rampOf(q, most);
  const values = s.scalars[q];
  return {
    amount: amount.value,
    ghost,
    acts,
    colour: (i) => (Number.isFinite(values[i]) ? scale(values[i] / most) : notCounted),
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
        savePictures('load-cases.png', [...refs.current].map(([says, canvas]) => ({canvas, says})), [rampOf(quantity.value, most)])}>PNG</button>
    </div>
  );
}

function fieldsCsv(s: Surface, name: string): void {
  const told = quantitiesOf(s);
  const rows: unknown[][] = [['x', 'y', 'z', ...told]];
  for (let i = 0; i < s.rest.length / 3; ++i)
    rows.push([s.rest[3 * i], s.rest[3 * i + 1], s.rest[3 * i + 2], ...told.map((q) => s.scalars[q][i])]);
  saveCsv(`${name}-surface.csv`, rows);
}

/** The bodies of a step by load case, in the capture's order as far as it is known, and what is not there. */
function useSurfaces(now: StepEntry | undefined): {surfaces: Map<string, Surface>; fault: string} {
  const [surfaces, setSurfaces] = useState(new Map<string, Surface>());
  const [fault, setFault] = useState('');
  useEffect(() => {
    let current = true;
    if (!now) return;
    const names = examplesOf(now);
    const order = (run.value.capture?.examples ?? []).map((e) => e.name);
    names.sort((a, b) => order.indexOf(a) - order.indexOf(b));
    void readable(now, names).then(({all, lost}) => {
      if (!current) return;
      setSurfaces(all);
      if (!quantitiesOf([...all.values()][0]).includes(quantity.value)) quantity.value = 'residual';
      setFault(lost.length ? `The body in ${listed(lost)} cannot be read.` : '');
      if (!all.has(chosenExample.value)) {
        const by = now.metrics?.chi_by_example ?? {};
        chosenExample.value = [...all.keys()].sort((a, b) => (by[b] ?? 0) - (by[a] ?? 0))[0] ?? '';
      }
    });
    return () => {
      current = false;
    };
  }, [now]);
  return {surfaces, fault};
}

function Tools(props: {scene: BodyScene | null; shown: Surface | undefined; ramp: Ramp}) {
  const {scene, shown} = props;
  return (
    <Toolbar>
      <Buttons label="Colour by" values={quantitiesOf(shown)} chosen={quantity} names={quantityNames} />
      <label>deformed × {amount.value.toFixed(1)} <input type="range" min="0" max="5" step="0.1" value={amount.value}
        onInput={(e) => (amount.value = Number(e.currentTarget.value))} /></label>
      <label><input type="checkbox" checked={showActs.value}
        onChange={(e) => (showActs.value = e.currentTarget.checked)} /> supports and loads</label>
      <button onClick={() => scene?.frame()}>Fit</button>
      <span class="push" />
      <button class="quiet" onClick={() => shown && fieldsCsv(shown, chosenExample.value)}>CSV</button>
      <button class="quiet" onClick={() => scene && savePictures(`${chosenExample.value}-body.png`, [{canvas: scene.picture(), says: chosenExample.value}], [props.ramp])}>PNG</button>
      <button class="quiet" onClick={() => shown && saveText(`${chosenExample.value}-surface.vtu`, surfaceVtu(shown), 'application/xml')}>VTU</button>
    </Toolbar>
  );
}

export function Fails() {
  const canvas = useRef<HTMLCanvasElement>(null), overlay = useRef<HTMLCanvasElement>(null);
  const {scene, fault: sceneFault} = useScene(canvas, overlay);
  const notHere = examplesOf(step.value).length ? '' : `The body of this step is not here. ${run.value.reduction ?? ''}`;
  const now = step.value;
  const {surfaces, fault} = useSurfaces(now);

  const q = quantity.value;
  const most = reach([...surfaces.values()].map((s) => s.scalars[q]));
  const shown = surfaces.get(chosenExample.value);
  useEffect(() => {
    if (!scene || !shown) return;
    scene.setBackground(getComputedStyle(document.body).getPropertyValue('--stage').trim() || '#ffffff');
    scene.show(shown, lookOf(shown, q, most, amount.value > 0, showActs.value ? actsIn(chosenExample.value) : []));
    scene.mark(picked.value);
  }, [scene, shown, q, most, amount.value, showActs.value, theme.value]);
  useEffect(() => scene?.mark(picked.value), [scene, picked.value]);

  if (!now) return <p class="empty">No step is finished yet.</p>;
  const ramp = rampOf(q, most);
  const keys = (event: KeyboardEvent): void => {
    if (!scene || scene.key(event) || event.key !== 'Enter') return;
    picked.value = scene.pick(scene.canvas.clientWidth / 2, scene.canvas.clientHeight / 2);
    event.preventDefault();
  };
  return (
    <div class="fails">
      <div class="stage">
        <Tools scene={scene} shown={shown} ramp={ramp} />
        <div class="body3d">
          {(sceneFault || fault || notHere) && <p class="empty">{sceneFault || fault || notHere}</p>}
          <canvas ref={canvas} tabIndex={0} role="img" onKeyDown={keys}
            aria-label={`The body in load case ${chosenExample.value}, coloured by ${quantityNames[q]}; arrow keys turn it, + and - zoom, Enter picks the middle`}
            onClick={(e) => scene && (picked.value = scene.pick(e.offsetX, e.offsetY))} />
          <canvas ref={overlay} class="overlay" aria-hidden="true" />
          <Legend ramp={ramp} />
        </div>
        <Thumbnails scene={scene} surfaces={surfaces} most={most} />
      </div>
      <aside>
        {shown && <Picked s={shown} others={[...surfaces.values()].filter((s) => s !== shown)} />}
        <FailureBars step={now} />
      </aside>
    </div>
  );
}
