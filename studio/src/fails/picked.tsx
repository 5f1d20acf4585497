// The picked point of the body: its values, and its surroundings in every photo that sees it.
import {signal} from '@preact/signals';
import {useEffect, useRef, useState} from 'preact/hooks';
import {frames, paint} from '../compare/frames';
import {figure} from '../format';
import {chosenPhoto, run, step, units, verb, wantedPixel} from '../state';
import {hasSign, quantitiesOf, quantityNames, unitOf, type Surface, type View} from './surface';

/** A node of the surface; -1: none. */
export const picked = signal(-1);

/** Half the width of what is shown of a photo [px], and its size on the page. */
const around = 20;
const shownSize = 74;

/** The photo and its residual around the point, which a ring marks. */
async function draw(canvas: HTMLCanvasElement, index: number, x: number, y: number): Promise<void> {
  const all = await frames(run.value.photos[index], step.value);
  const context = canvas.getContext('2d')!;
  context.fillStyle = '#808080';
  context.fillRect(0, 0, canvas.width, canvas.height);
  (['photo', 'residual'] as const).forEach((kind, k) => {
    const [source, painted] = [kind === 'photo' ? all.photo : all.residual, paint(all, kind)];
    if (!source || !painted) return;
    const [left, s] = [k * shownSize, source.shrink];
    context.imageSmoothingEnabled = false;
    context.drawImage(painted, (x + 0.5 - around) / s, (y + 0.5 - around) / s, (2 * around) / s, (2 * around) / s,
      left, 0, shownSize, shownSize);
    for (const [width, colour] of [[3, '#000'], [1.5, '#ffd400']] as const) {
      context.lineWidth = width;
      context.strokeStyle = colour;
      context.beginPath();
      context.arc(left + shownSize / 2, shownSize / 2, 8, 0, 7);
      context.stroke();
    }
  });
}

function Glimpse(props: {view: View; node: number}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const {view, node} = props;
  const [x, y] = [view.pixel[2 * node], view.pixel[2 * node + 1]];
  const index = run.value.photos.findIndex((p) => p.name === view.photo);
  useEffect(() => {
    if (index >= 0 && canvas.current) void draw(canvas.current, index, x, y);
  }, [index, x, y, step.value]);
  if (index < 0) return null;
  return (
    <button title="Show it in Compare" onClick={() => {
      chosenPhoto.value = index;
      wantedPixel.value = {photo: view.photo, x, y};
      verb.value = 'compare';
    }}>
      <canvas ref={canvas} width={2 * shownSize} height={shownSize} aria-hidden="true" />
      <span>{view.photo} ({Math.round(x)}, {Math.round(y)})</span>
    </button>
  );
}

const seeing = (s: Surface, node: number): View[] => s.views.filter((view) => view.seen[node] > 0);

/** The same point in the photos of the other load cases; they are read when they are asked for. */
function Elsewhere(props: {others: Surface[]; node: number}) {
  const [open, setOpen] = useState(false);
  const views = props.others.flatMap((s) => seeing(s, props.node));
  if (!views.length) return null;
  return (
    <details open={open} onToggle={(e) => setOpen(e.currentTarget.open)}>
      <summary>{views.length} photo{views.length > 1 ? 's' : ''} of other load cases see it</summary>
      {open && views.map((view) => <Glimpse key={view.photo} view={view} node={props.node} />)}
    </details>
  );
}

export function Picked(props: {s: Surface; others: Surface[]}) {
  const {s} = props;
  const node = picked.value;
  if (node < 0 || 3 * node >= s.rest.length)
    return <p class="note">Click a point of the body, or press <kbd>Enter</kbd> on it: its values, and every photo that sees it.</p>;
  const x = [0, 1, 2].map((i) => figure(s.rest[3 * node + i])).join(', ');
  const views = seeing(s, node);
  return (
    <div class="picked">
      <p>Rest point ({x}) {units.value.length}</p>
      <ul>
        {quantitiesOf(s).map((q) => <li key={q}>{quantityNames[q]} <b>{figure(s.scalars[q][node])}</b> {hasSign(q) ? '' : unitOf(q)}</li>)}
      </ul>
      {views.length === 0 ? <p>No photo of this load case sees it.</p> : <p>Photo and residual around it:</p>}
      {views.map((view) => <Glimpse key={view.photo} view={view} node={node} />)}
      <Elsewhere others={props.others} node={node} />
    </div>
  );
}
