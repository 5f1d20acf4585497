// The body over a photo: a wrong pose is seen. Clicks pick faces, small steps move the body.
import {signal} from '@preact/signals';
import {useEffect, useRef, useState} from 'preact/hooks';
import {Panel, type Layer} from '../compare/panel';
import {cursor, focus, pixelAt, place, resolved, zoom} from '../compare/viewport';
import {loadColour, supportColour} from '../fails/marks';
import {figure} from '../format';
import {Toolbar} from '../widgets';
import {actsOf} from './acts';
import {body, bodyFault, colours, middleOf, patches, type Body} from './body';
import {ask, capture, pulse, type CameraEntry, type CasePhoto} from './capture';
import {chooseCamera, picked, region, shownCamera, shownCase} from './chosen';
import {Legend, pairColour} from './legend';
import {Nudge} from './nudge';
import {pairing, pairs, pickPixel} from './pose';
import {pick} from './pick';
import {Overlay, pixelNear, sightOf, triangleAt, type Sight} from './projected';

const show = {outline: signal(true), wire: signal(false), faces: signal(false), marks: signal(true)};
const opacity = signal(0.8);
const swipe = signal(0);
const blinking = signal(false);
const hidden = signal(false);

/** The newest value of what is fetched by a key; until it is there, the one before of the same `of`; null: none. */
function useFetched<T>(of: string, key: string, get: () => Promise<T>): {value: T | null; fault: string} {
  const [got, set] = useState<{of: string; value: T | null; fault: string}>({of: '', value: null, fault: ''});
  useEffect(() => {
    let wanted = true;
    if (key)
      get().then((value) => wanted && set({of, value, fault: ''}))
        .catch((error: Error) => wanted && set({of, value: null, fault: error.message}));
    return () => void (wanted = false);
  }, [key]);
  return key && got.of === of ? got : {value: null, fault: ''};
}

async function pictureOf(example: string, camera: string): Promise<ImageBitmap> {
  const reply = await ask(`photo?example=${encodeURIComponent(example)}&camera=${encodeURIComponent(camera)}`);
  return createImageBitmap(await reply.blob());
}

/** A line with a dark rim, so that it is seen on any photo. */
function stroke(context: CanvasRenderingContext2D, colour: string, width: number, draw: () => void): void {
  for (const [w, c] of [[width + 2, '#000a'], [width, colour]] as const) {
    context.lineWidth = w;
    context.strokeStyle = c;
    context.beginPath();
    draw();
    context.stroke();
  }
}

/** Supports and loads, as the camera sees them. `factor`: canvas px for one of the photo. */
function drawMarks(context: CanvasRenderingContext2D, shown: Body, sight: Sight, factor: number): void {
  const unit = context.canvas.width / 100;
  for (const act of actsOf(shownCase.value)) {
    const triangles = patches.value.get(act.region) ?? [];
    if (!triangles.length) continue;
    const {at, out} = middleOf(shown, triangles);
    const pixel = pixelNear(shown, sight, at);
    const point = (x: ArrayLike<number>): [number, number] => pixel(x).map((c) => (c + 0.5) * factor) as [number, number];
    const load = act.force !== undefined || act.pressure !== undefined;
    const colour = '#' + (load ? loadColour : supportColour).toString(16).padStart(6, '0');
    const along = act.force ?? act.move ?? (act.pressure ? out.map((x) => -Math.sign(act.pressure!) * x) : null);
    const [x, y] = point(at);
    if (!along) {
      stroke(context, colour, 0.35 * unit, () => context.arc(x, y, 0.9 * unit, 0, 7));
      continue;
    }
    const size = (0.22 * shown.diagonal) / Math.hypot(...along);
    const pulls = along.reduce((sum, a, i) => sum + a * out[i], 0) >= 0;
    const tip = at.map((c, i) => c + (pulls ? size * along[i] : 0));
    const [from, to] = [point(tip.map((c, i) => c - size * along[i])), point(tip)];
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    const angle = Math.atan2(to[1] - from[1], to[0] - from[0]), head = Math.min(1.6 * unit, 0.4 * length);
    stroke(context, colour, 0.4 * unit, () => {
      if (length < 0.6 * unit) return context.arc(x, y, 0.7 * unit, 0, 7);  // it goes along the line of sight
      context.moveTo(...from);
      context.lineTo(...to);
      for (const turn of [2.6, -2.6]) {
        context.moveTo(...to);
        context.lineTo(to[0] + head * Math.cos(angle + turn), to[1] + head * Math.sin(angle + turn));
      }
    });
  }
}

/** Picked pixels, with the numbers of their pairs. */
function drawPairs(context: CanvasRenderingContext2D, camera: string, factor: number): void {
  const arm = context.canvas.width / 100;
  context.font = `${2.4 * arm}px sans-serif`;
  pairs.value.forEach((pair, i) => {
    if (pair.camera !== camera) return;
    const [x, y] = pair.pixel.map((c) => (c + 0.5) * factor);
    stroke(context, pairColour, 0.25 * arm, () => {
      context.moveTo(x - arm, y);
      context.lineTo(x + arm, y);
      context.moveTo(x, y - arm);
      context.lineTo(x, y + arm);
    });
    context.fillStyle = pairColour;
    context.fillText(String(i + 1), x + 0.6 * arm, y - 0.6 * arm);
  });
}

/** Photo, and photo with the body over it, so fine that lines are thin. */
function useLayers(photo: ImageBitmap | null, camera: CameraEntry | undefined, sight: Sight | null): {plain: Layer | null; over: Layer | null} {
  const overlay = useRef<Overlay | null>(null);
  useEffect(() => () => overlay.current?.dispose(), []);
  const [layers, set] = useState<{plain: Layer | null; over: Layer | null}>({plain: null, over: null});
  const looks = [show.outline.value, show.wire.value, show.faces.value, show.marks.value, opacity.value];
  useEffect(() => {
    if (!camera) return set({plain: null, over: null});
    const [width, height] = camera.size;
    const factor = 1600 / Math.max(width, height);
    const make = (paint?: (context: CanvasRenderingContext2D) => void): Layer => {
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [Math.round(width * factor), Math.round(height * factor)];
      const context = canvas.getContext('2d')!;
      context.fillStyle = '#606468';
      context.fillRect(0, 0, canvas.width, canvas.height);
      context.imageSmoothingEnabled = factor < 1;
      if (photo) context.drawImage(photo, 0, 0, canvas.width, canvas.height);
      paint?.(context);
      return {canvas, shrink: 1 / factor};
    };
    const plain = make();
    if (!body.value || !sight) return set({plain, over: null});
    overlay.current ??= new Overlay();
    const look = {outline: show.outline.value, wire: show.wire.value, faces: show.faces.value,
      colours: colours(body.value, region.value, picked.value)};
    const drawn = overlay.current.draw(body.value, sight, look, camera.size, factor);
    set({plain, over: make((context) => {
      context.globalAlpha = opacity.value;
      context.drawImage(drawn, 0, 0);
      context.globalAlpha = 1;
      if (show.marks.value) drawMarks(context, body.value!, sight, factor);
      if (pairing.value) drawPairs(context, camera.name, factor);
    })});
  }, [pairs.value, pairing.value, photo, camera?.stamp, sight, body.value, picked.value, region.value, shownCase.value, patches.value, ...looks]);
  return layers;
}

function Tools(props: {photos: CasePhoto[]}) {
  const cameras = capture.value?.cameras ?? [];
  const toggle = (name: keyof typeof show, says: string) => (
    <label><input type="checkbox" checked={show[name].value} onChange={(e) => (show[name].value = e.currentTarget.checked)} /> {says}</label>);
  useEffect(() => {
    if (!blinking.value) return void (hidden.value = false);
    const timer = setInterval(() => (hidden.value = !hidden.value), 600);
    return () => clearInterval(timer);
  }, [blinking.value]);
  return (
    <Toolbar>
      <label>Camera <select value={shownCamera.value?.name} onChange={(e) => chooseCamera(e.currentTarget.value)}>
        {cameras.map(({name}) => <option key={name} value={name}>{name}{props.photos.some((p) => p.camera === name) ? '' : ' (no photo)'}</option>)}
      </select></label>
      {toggle('outline', 'outline')}{toggle('wire', 'wire')}{toggle('faces', 'faces')}{toggle('marks', 'loads')}
      <label>Opacity <input type="range" min="0" max="1" step="0.05" value={opacity.value}
        onInput={(e) => (opacity.value = Number(e.currentTarget.value))} /></label>
      <label>Swipe <input type="range" min="0" max="1" step="0.01" value={swipe.value}
        onInput={(e) => (swipe.value = Number(e.currentTarget.value))} /></label>
      <button aria-pressed={blinking.value} onClick={() => (blinking.value = !blinking.value)}>Blink</button>
      <button onClick={() => (place.value = {scale: 0, x: 0, y: 0})}>Fit</button>
    </Toolbar>
  );
}

/** Arrow keys move the cross, Enter picks what is below it. */
function keys(event: KeyboardEvent, camera: CameraEntry, area: HTMLElement, onPick: (x: number, y: number) => void): void {
  const steps: Record<string, [number, number]> = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
  const [width, height] = camera.size;
  const canvas = area.querySelector('canvas')!;
  const panel = {width: canvas.clientWidth, height: canvas.clientHeight};
  const by = steps[event.key];
  if (by) {
    const from = cursor.value ?? {x: width >> 1, y: height >> 1};
    const far = event.shiftKey ? 10 : 1;
    cursor.value = {x: Math.min(width - 1, Math.max(0, from.x + far * by[0])), y: Math.min(height - 1, Math.max(0, from.y + far * by[1]))};
  } else if (event.key === 'Enter' && cursor.value) onPick(cursor.value.x, cursor.value.y);
  else if (event.key === '+' || event.key === '-') {
    const at = cursor.value ?? pixelAt(panel, {width, height}, panel.width / 2, panel.height / 2);
    if (event.key === '+' && place.value.scale === 0) place.value = {scale: resolved(panel, {width, height}).scale, ...at};
    zoom(panel, {width, height}, event.key === '+' ? 1.5 : 1 / 1.5, panel.width / 2, panel.height / 2);
  } else if (event.key === '0') place.value = {scale: 0, x: 0, y: 0};
  else return;
  event.preventDefault();
}

function Overlap(props: {camera: string}) {
  const told = (pulse.value?.check.cameras ?? []).find((one) => one.camera === props.camera);
  if (!told || told.overlap === null) return null;
  return <span> · outlines overlap by {figure(told.overlap)}</span>;
}

export function PhotoView() {
  const camera = shownCamera.value, shown = shownCase.value;
  const photo = shown?.photos.find((one) => one.camera === camera?.name);
  const fetched = useFetched(`${shown?.name} ${photo?.camera}`, photo && shown ? `${shown.name} ${photo.stamp}` : '', () => pictureOf(shown!.name, photo!.camera));
  const seen = useFetched(`${camera?.name} ${body.value?.count}`, camera && body.value ? `${camera.stamp} ${capture.value?.body}` : '', () => sightOf(body.value!, camera!.name));
  const layers = useLayers(fetched.value, camera, seen.value);
  const area = useRef<HTMLDivElement>(null);
  useEffect(() => {
    focus.value = null;
    place.value = {scale: 0, x: 0, y: 0};
  }, [camera?.name]);
  if (!camera) return <p class="empty">The capture has no camera that can be read. <code>hookeye import</code> and <code>hookeye calibrate</code> make some.</p>;
  const onPick = (x: number, y: number): void => {
    if (pairing.value) pickPixel(camera.name, x, y);
    else if (seen.value && body.value) pick(body.value, triangleAt(seen.value, x, y));
  };
  const over = hidden.value ? null : layers.over;
  const absent = !photo ? `${shown?.name ?? 'The capture'} has no photo of ${camera.name}.` : fetched.fault || seen.fault || bodyFault.value || undefined;
  return (
    <>
      <Tools photos={shown?.photos ?? []} />
      <Legend lines={show} />
      <div class="panels" ref={area} tabIndex={0} role="group" onKeyDown={(event) => keys(event, camera, area.current!, onPick)}
           aria-label="Photo: arrow keys move the cross, Enter picks the face below it, + and - zoom, 0 fits">
        <Panel title={`${shown?.name ?? ''} · ${camera.name}`} photo={{width: camera.size[0], height: camera.size[1]}} layer={over && swipe.value === 0 ? over : layers.plain}
               second={over} split={over && swipe.value > 0 ? swipe.value : undefined} absent={absent} onPick={onPick}
               onSplit={swipe.value > 0 ? (at) => (swipe.value = at) : undefined} />
      </div>
      <p class="note" id="readout">The body at rest over the photo{shown && !shown.rest ? ', which shows it loaded' : ''}.<Overlap camera={camera.name} /></p>
      {seen.value && body.value && <Nudge camera={camera} sight={seen.value} of={body.value} />}
    </>
  );
}
