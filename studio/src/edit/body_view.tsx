// The body in space: turned by dragging, its faces picked by clicks, what holds and pulls it drawn.
import {useEffect, useMemo, useRef} from 'preact/hooks';
import {useScene} from '../fails/use_scene';
import type {Surface} from '../fails/surface';
import {theme} from '../state';
import {Toolbar} from '../widgets';
import {actsOf} from './acts';
import {body, bodyFault, colours, patches, type Body} from './body';
import {picked, region, shownCase} from './chosen';
import {Legend} from './legend';
import {pick} from './pick';
import {pairing, pendingPoint, pickPoint} from './pose';

/** Each triangle has corners of its own, so that it has a colour and a direction of its own. */
function surfaceOf(of: Body): Surface {
  const regions: Record<string, number[]> = {};
  for (const [name, triangles] of patches.value) regions[name] = triangles.flatMap((t) => [3 * t, 3 * t + 1, 3 * t + 2]);
  return {rest: of.corners, triangles: Uint32Array.from({length: 3 * of.count}, (_, i) => i), regions,
    displacement: new Float32Array(of.corners.length), scalars: {} as Surface['scalars'], views: []};
}

export function BodyView() {
  const canvas = useRef<HTMLCanvasElement>(null), letters = useRef<HTMLCanvasElement>(null);
  const {scene, fault} = useScene(canvas, letters);
  const surface = useMemo(() => (body.value ? surfaceOf(body.value) : null), [body.value, patches.value]);
  useEffect(() => {
    if (!scene || !surface || !body.value) return;
    scene.setBackground(getComputedStyle(document.body).getPropertyValue('--stage').trim());
    const of = colours(body.value, region.value, picked.value);
    scene.show(surface, {amount: 0, colour: (node) => of[Math.floor(node / 3)], ghost: false, acts: actsOf(shownCase.value)});
  }, [scene, surface, region.value, picked.value, shownCase.value, theme.value]);
  const taken = (node: number): void => {
    if (node < 0 || !body.value) return;
    if (!pairing.value) return pick(body.value, Math.floor(node / 3));
    scene!.mark(node);
    pickPoint(Array.from(body.value.corners.subarray(3 * node, 3 * node + 3)));
  };
  useEffect(() => {
    if (!pendingPoint.value) scene?.mark(-1);
  }, [scene, pendingPoint.value]);
  const pressed = useRef<[number, number] | null>(null);
  const click = (event: PointerEvent): void => {
    const from = pressed.current;
    if (!scene || !body.value || !from || Math.hypot(event.offsetX - from[0], event.offsetY - from[1]) > 4) return;
    taken(scene.pick(event.offsetX, event.offsetY));
  };
  const keys = (event: KeyboardEvent): void => {
    if (!scene || scene.key(event)) return;
    if (event.key !== 'Enter' || !body.value) return;
    taken(scene.pick(canvas.current!.clientWidth / 2, canvas.current!.clientHeight / 2));
    event.preventDefault();
  };
  return (
    <>
      <Toolbar>
        <button onClick={() => scene?.frame()}>Whole body</button>
        <span class="note">Drag to turn, click to pick faces. Keys: arrows, + − 0, Enter picks in the middle.</span>
      </Toolbar>
      <Legend />
      <div class="body3d">
        {(fault || bodyFault.value) && <p class="empty">{fault || bodyFault.value}</p>}
        <canvas ref={canvas} tabIndex={0} role="img" aria-label="The body: arrow keys turn it, + and - zoom, Enter picks the face in the middle"
                onPointerDown={(e) => (pressed.current = [e.offsetX, e.offsetY])} onPointerUp={click} onKeyDown={keys} />
        <canvas ref={letters} class="overlay" aria-hidden="true" />
      </div>
    </>
  );
}
