// Finds where the body lies: by its outline, or by pairs of a point of the body and the pixel that shows it.
import {signal} from '@preact/signals';
import {figure} from '../format';
import {Said} from '../widgets';
import {ask, capture, draft, pulse, refusal, saving} from './capture';
import {stage} from './chosen';

export interface Pair {
  camera: string;
  pixel: [number, number];
  point: number[];
}
export const pairs = signal<Pair[]>([]);
/** Clicks pick pairs, no faces. */
export const pairing = signal(false);
/** A point of the body whose pixel is not picked yet. */
export const pendingPoint = signal<number[] | null>(null);

export function pickPoint(point: number[]): void {
  pendingPoint.value = point;
  stage.value = 'photo';
}
export function pickPixel(camera: string, x: number, y: number): void {
  if (!pendingPoint.value) return;
  pairs.value = [...pairs.value, {camera, pixel: [x, y], point: pendingPoint.value}];
  pendingPoint.value = null;
}

async function place(list: Pair[]): Promise<void> {
  try {
    pulse.value = await (await ask('place', {seen: capture.value!.pulse.mark, pairs: list})).json();
  } catch (error) {
    refusal.value = (error as Error).message;
  }
}

const pointText = (v: number[]): string => `(${v.map((x) => figure(x)).join(', ')})`;

function PairList() {
  const all = pairs.value, pending = pendingPoint.value;
  return (
    <div class="pairs-picked">
      <p class="note" role="status">{pending ? `The point ${pointText(pending)}: now click where a photo shows it.`
        : 'Click a point of the body in space, then the pixel that shows it in a photo. Three pairs at least, better six.'}
        {' '}{!pending && stage.value === 'photo' && <button onClick={() => (stage.value = 'body')}>Next point</button>}</p>
      <ol>{all.map((pair, i) => (
        <li key={i}>{pair.camera} ({pair.pixel.join(', ')}) shows {pointText(pair.point)}{' '}
          <button class="quiet" aria-label={`Remove pair ${i + 1}`} onClick={() => (pairs.value = all.filter((_, k) => k !== i))}>Remove</button></li>))}</ol>
    </div>
  );
}

export function Pose() {
  const job = pulse.value?.place;
  const busy = job?.state === 'running', off = busy || saving.value || draft.value !== null;
  return (
    <div class="pose" role="group" aria-label="Find the pose">
      {busy ? <><span role="status">Finding the pose …</span> <button onClick={() => void ask('stop', {})}>Stop</button></> : <>
        <span>Find the pose</span>
        <button disabled={off} onClick={() => void place([])}>by the outline</button>
        <button aria-pressed={pairing.value} onClick={() => {
          pairing.value = !pairing.value;
          pendingPoint.value = null;
          if (pairing.value) stage.value = 'body';
        }}>by pairs …</button>
        {pairing.value && <button class="primary" disabled={off || pairs.value.length < 3} onClick={() => void place(pairs.value)}>Place by {pairs.value.length} pairs</button>}
      </>}
      {job && job.message && !busy && <p class={'note ' + job.state} role="status"><Said text={job.message} /></p>}
      {pairing.value && <PairList />}
    </div>
  );
}
