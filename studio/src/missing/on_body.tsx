// The residual that an effect would remove, on the body: every node takes the mean over the photos
// that see it.
import {useEffect, useRef, useState} from 'preact/hooks';
import {diverging, notCounted} from '../colours';
import {surface, type Surface} from '../fails/surface';
import {useScene} from '../fails/use_scene';
import {fromBase64} from '../parts';
import {step, theme} from '../state';
import type {Prediction} from './prediction';

/** What would be left less what there is [sigma]: negative where the effect removes; NaN: unseen. */
export function changeOnNodes(s: Surface, prediction: Prediction): Float32Array {
  const nodes = s.rest.length / 3;
  const [was, left, count] = [new Float32Array(nodes), new Float32Array(nodes), new Float32Array(nodes)];
  for (const view of s.views) {
    const cells = prediction.photos[view.photo];
    if (!cells) continue;
    const bytes = fromBase64(cells.bytes);
    const cell = (pixel: number): number => Math.floor(Math.round(pixel) / prediction.cell_px);
    for (let i = 0; i < nodes; ++i) {
      const [column, row] = [cell(view.pixel[2 * i]), cell(view.pixel[2 * i + 1])];
      const inside = column >= 0 && row >= 0 && column < cells.columns && row < cells.rows;
      if (!view.seen[i] || !inside) continue;
      const at = row * cells.columns + column;
      if (bytes[at] === 0) continue;
      const now = (bytes[at] - 1) * prediction.unit;
      const removed = (bytes[cells.columns * cells.rows + at] - 128) * prediction.unit;
      was[i] += now ** 2;
      left[i] += (now - removed) ** 2;
      count[i] += 1;
    }
  }
  return count.map((n, i) => (n > 0 ? Math.sqrt(left[i] / n) - Math.sqrt(was[i] / n) : NaN));
}

export function OnBody(props: {prediction: Prediction; scale: number; example: string; says: string}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const {scene, fault} = useScene(canvas);
  const [body, setBody] = useState<Surface | null>(null);
  const now = step.value;
  useEffect(() => {
    let current = true;
    if (now) void surface(now, props.example).then((s) => current && setBody(s), () => undefined);
    return () => {
      current = false;
    };
  }, [now, props.example]);
  useEffect(() => {
    if (!scene || !body) return;
    const change = changeOnNodes(body, props.prediction);
    scene.setBackground(getComputedStyle(document.body).getPropertyValue('--stage').trim() || '#ffffff');
    scene.show(body, {
      amount: 1,
      ghost: false,
      colour: (i) => (Number.isFinite(change[i]) ? diverging(change[i] / props.scale) : notCounted),
    });
  }, [scene, body, props.prediction, props.scale, theme.value]);
  return (
    <div class="on-body">
      <canvas ref={canvas} tabIndex={0} role="img" aria-label={`${props.says}; arrow keys turn the body, + and - zoom`}
              onKeyDown={(event) => scene?.key(event)} />
      <p class="note">{fault || props.says}</p>
    </div>
  );
}
