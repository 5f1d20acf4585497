// Moves and turns the body in small steps as the camera sees it: `body: placement` of the capture.
import {signal} from '@preact/signals';
import {nudge, saving, type CameraEntry} from './capture';
import type {Body} from './body';
import type {Sight} from './projected';

/** How many pixels of the photo a length across the line of sight covers: over the body's own edges, those least foreshortened. */
function pxPerLength(of: Body, sight: Sight): number {
  let most = 0;
  for (let t = 0; t < of.count; ++t) {
    const [p, x] = [sight.corners.subarray(9 * t, 9 * t + 9), of.corners.subarray(9 * t, 9 * t + 9)];
    const seen = Math.hypot(p[3] - p[0], p[4] - p[1]), long = Math.hypot(x[3] - x[0], x[4] - x[1], x[5] - x[2]);
    if (Number.isFinite(seen) && long > 0) most = Math.max(most, seen / long);
  }
  return most || 1;
}

/** Step [px of the photo]. */
const px = signal(1);

const moves: [string, string, number[], number[], string][] = [
  ['←', 'Move left', [-1, 0, 0], [0, 0, 0], 'ArrowLeft'], ['→', 'Move right', [1, 0, 0], [0, 0, 0], 'ArrowRight'],
  ['↑', 'Move up', [0, -1, 0], [0, 0, 0], 'ArrowUp'], ['↓', 'Move down', [0, 1, 0], [0, 0, 0], 'ArrowDown'],
  ['⟲', 'Turn left', [0, 0, 0], [0, 0, -1], 'q'], ['⟳', 'Turn right', [0, 0, 0], [0, 0, 1], 'e'],
  ['nearer', 'Nearer', [0, 0, -1], [0, 0, 0], 'PageUp'], ['farther', 'Farther', [0, 0, 1], [0, 0, 0], 'PageDown'],
];

export function Nudge(props: {camera: CameraEntry; sight: Sight; of: Body}) {
  const {camera, sight, of} = props;
  const step = (move: number[], turn: number[]): void => {
    const scale = pxPerLength(of, sight), length = px.value / scale;
    // A turn moves the body's rim by about as much; the depth is seen less.
    const angle = (2 * length) / of.diagonal;
    void nudge(camera.name, move.map((x, i) => x * length * (i === 2 ? 4 : 1)), turn.map((x) => x * angle));
  };
  const keys = (event: KeyboardEvent): void => {
    const found = moves.find((one) => one[4] === event.key);
    if (!found || event.target instanceof HTMLSelectElement) return;
    event.preventDefault();
    if (!saving.value) step(found[2], found[3]);
  };
  return (
    <div class="nudge" role="group" aria-label="Move the body: arrow keys, q and e turn, page up and down for the depth" onKeyDown={keys}>
      <span>Move the body by</span>
      <select aria-label="Step" value={px.value} onChange={(e) => (px.value = Number(e.currentTarget.value))}>
        {[0.2, 1, 5, 25].map((n) => <option key={n} value={n}>{n} px</option>)}
      </select>
      {moves.map(([sign, says, move, turn]) =>
        <button key={says} aria-label={says} title={says} onClick={() => !saving.value && step(move, turn)}>{sign}</button>)}
    </div>
  );
}
