// One picture: draws, zooms, pans, and says which pixel is under the pointer.
import type {RefObject} from 'preact';
import {useEffect, useRef} from 'preact/hooks';
import {cursor, focus, pan, pixelAt, place, resolved, screenAt, zoom, type Size} from './viewport';

export interface Arrow {
  x: number;
  y: number;
  dx: number;
  dy: number;
}
export interface Layer {
  canvas: HTMLCanvasElement;
  shrink: number;
}
interface Props {
  title: string;
  photo: Size;
  layer: Layer | null;
  /** Drawn right of `split` (0..1 of the panel's width): swipe. */
  second?: Layer | null;
  split?: number;
  arrows?: Arrow[];
  gain?: number;
  /** Said over the panel where there is no picture. */
  absent?: string;
  /** Dragging the picture moves the edge of a swipe: anywhere while it fits, else near the edge. */
  onSplit?: (at: number) => void;
  onPick?: (x: number, y: number) => void;
}

function drawLayer(context: CanvasRenderingContext2D, panel: Size, photo: Size, layer: Layer): void {
  const {scale} = resolved(panel, photo);
  // The picture's corner is half a pixel above and left of the first pixel's centre.
  const [left, top] = screenAt(panel, photo, -0.5, -0.5);
  context.imageSmoothingEnabled = scale * layer.shrink < 1;
  context.drawImage(layer.canvas, left, top, layer.canvas.width * layer.shrink * scale,
    layer.canvas.height * layer.shrink * scale);
}

/** Longer arrows are cut, so that one bad cell does not cross the picture [px of the photo]. */
export const longest = 48;

function drawArrows(context: CanvasRenderingContext2D, panel: Size, photo: Size, arrows: Arrow[],
                    gain: number): void {
  for (const [width, colour] of [[3, '#0009'], [1.4, '#ffd400']] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    for (const a of arrows) {
      const [x, y] = screenAt(panel, photo, a.x, a.y);
      const length = gain * Math.hypot(a.dx, a.dy);
      const drawn = length > longest ? (gain * longest) / length : gain;
      const [u, v] = screenAt(panel, photo, a.x + drawn * a.dx, a.y + drawn * a.dy);
      const head = 0.3 * Math.hypot(u - x, v - y);
      const angle = Math.atan2(v - y, u - x);
      context.moveTo(x, y);
      context.lineTo(u, v);
      for (const turn of [2.6, -2.6]) {
        context.moveTo(u, v);
        context.lineTo(u + head * Math.cos(angle + turn), v + head * Math.sin(angle + turn));
      }
    }
    context.stroke();
  }
}

function drawCursor(context: CanvasRenderingContext2D, panel: Size, photo: Size): void {
  if (!cursor.value) return;
  const {scale} = resolved(panel, photo);
  const [x, y] = screenAt(panel, photo, cursor.value.x, cursor.value.y);
  const half = Math.max(4, scale / 2);
  for (const [width, colour] of [[3, '#000'], [1, '#fff']] as const) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.strokeRect(x - half, y - half, 2 * half, 2 * half);
  }
}

function render(canvas: HTMLCanvasElement, props: Props): void {
  const ratio = window.devicePixelRatio || 1;
  const panel = {width: canvas.clientWidth, height: canvas.clientHeight};
  canvas.width = Math.round(panel.width * ratio);
  canvas.height = Math.round(panel.height * ratio);
  const context = canvas.getContext('2d')!;
  context.scale(ratio, ratio);
  context.fillStyle = '#808080';
  context.fillRect(0, 0, panel.width, panel.height);
  if (props.layer) drawLayer(context, panel, props.photo, props.layer);
  if (props.second && props.split !== undefined) {
    const edge = props.split * panel.width;
    context.save();
    context.beginPath();
    context.rect(edge, 0, panel.width - edge, panel.height);
    context.clip();
    drawLayer(context, panel, props.photo, props.second);
    context.restore();
    context.fillStyle = '#ffd400';
    context.fillRect(edge - 1, 0, 2, panel.height);
  }
  if (props.arrows) drawArrows(context, panel, props.photo, props.arrows, props.gain ?? 1);
  drawCursor(context, panel, props.photo);
}

const sizeOf = (canvas: HTMLCanvasElement): Size => ({width: canvas.clientWidth, height: canvas.clientHeight});

interface Drag {
  x: number;
  y: number;
  moved: boolean;
  swipes: boolean;
}
/** Dragging pans or swipes, two fingers zoom, and the pixel under the pointer is told to all panels. */
function usePointer(ref: RefObject<HTMLCanvasElement>, props: Props) {
  const drag = useRef<Drag | null>(null);
  const fingers = useRef(new Map<number, {x: number; y: number}>());
  const dragged = (canvas: HTMLCanvasElement, from: Drag, now: {x: number; y: number}): void => {
    const [dx, dy] = [now.x - from.x, now.y - from.y];
    if (Math.hypot(dx, dy) <= 2 && !from.moved) return;
    if (from.swipes) props.onSplit!(Math.min(1, Math.max(0, now.x / canvas.clientWidth)));
    else pan(sizeOf(canvas), props.photo, dx, dy);
    drag.current = {...from, ...now, moved: true};
  };
  const onPointerMove = (event: PointerEvent): void => {
    const canvas = ref.current!;
    const now = {x: event.offsetX, y: event.offsetY};
    const before = fingers.current.get(event.pointerId);
    if (before && fingers.current.size === 2) {
      const [still] = [...fingers.current].filter(([id]) => id !== event.pointerId);
      const distance = (p: {x: number; y: number}): number => Math.hypot(p.x - still[1].x, p.y - still[1].y);
      zoom(sizeOf(canvas), props.photo, distance(now) / Math.max(1, distance(before)), now.x, now.y);
    } else if (drag.current) dragged(canvas, drag.current, now);
    if (before) fingers.current.set(event.pointerId, now);
    const pixel = pixelAt(sizeOf(canvas), props.photo, now.x, now.y);
    const inside = pixel.x >= 0 && pixel.y >= 0 && pixel.x < props.photo.width && pixel.y < props.photo.height;
    cursor.value = inside ? pixel : null;
  };
  const onPointerDown = (event: PointerEvent): void => {
    const canvas = ref.current!;
    canvas.setPointerCapture(event.pointerId);
    const now = {x: event.offsetX, y: event.offsetY};
    fingers.current.set(event.pointerId, now);
    const fromEdge = Math.abs(now.x - (props.split ?? 0) * canvas.clientWidth);
    const swipes = !!props.onSplit && (place.value.scale === 0 || fromEdge < 24);
    drag.current = {...now, moved: false, swipes};
  };
  const onPointerUp = (event: PointerEvent): void => {
    fingers.current.delete(event.pointerId);
    if (drag.current && !drag.current.moved && cursor.value)
      props.onPick?.(cursor.value.x, cursor.value.y);
    drag.current = null;
  };
  return {onPointerMove, onPointerDown, onPointerUp, onPointerCancel: onPointerUp};
}

export function Panel(props: Props) {
  const ref = useRef<HTMLCanvasElement>(null);
  // Read here, so that the panel is drawn again whenever either changes.
  void place.value;
  void cursor.value;
  void focus.value;

  useEffect(() => {
    if (ref.current) render(ref.current, props);
  });
  useEffect(() => {
    const canvas = ref.current!;
    const watch = new ResizeObserver(() => {
      place.value = {...place.value};
    });
    watch.observe(canvas);
    const wheel = (event: WheelEvent): void => {
      event.preventDefault();
      zoom(sizeOf(canvas), props.photo, Math.exp(-0.0015 * event.deltaY), event.offsetX, event.offsetY);
    };
    canvas.addEventListener('wheel', wheel, {passive: false});
    return () => {
      watch.disconnect();
      canvas.removeEventListener('wheel', wheel);
    };
  }, [props.photo.width, props.photo.height]);
  const pointer = usePointer(ref, props);
  return (
    <figure class="panel">
      <figcaption>{props.title}</figcaption>
      {props.absent && <p class="absent">{props.absent}</p>}
      <canvas
        ref={ref}
        role="img"
        aria-label={`${props.title}, ${props.photo.width} by ${props.photo.height} pixels`}
        {...pointer}
        onDblClick={() => (place.value = {scale: 0, x: 0, y: 0})}
      />
    </figure>
  );
}
