// Letters over a drawn body: axes, a bar for its lengths, and what its marks stand for.
import {Vector3, type PerspectiveCamera} from 'three';
import {figure} from '../format';
import type {Marks} from './marks';

const axes: [string, Vector3, string][] = [
  ['x', new Vector3(1, 0, 0), '#c0392b'], ['y', new Vector3(0, 1, 0), '#1e8449'], ['z', new Vector3(0, 0, 1), '#2471a3'],
];

/** 1, 2 or 5 times a power of ten, at most `most`. */
function round(most: number): number {
  const decade = 10 ** Math.floor(Math.log10(most));
  return ([5, 2, 1].find((s) => s * decade <= most) ?? 1) * decade;
}

interface Place {
  width: number;
  height: number;
  ink: string;
  paper: string;
}

function letters(context: CanvasRenderingContext2D, place: Place, text: string, x: number, y: number, colour: string): void {
  context.lineWidth = 4;
  context.lineJoin = 'round';
  context.strokeStyle = place.paper;
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
}

/** The rest axes as the camera sees them, in the lower right corner. */
function drawAxes(context: CanvasRenderingContext2D, place: Place, camera: PerspectiveCamera): void {
  const [cx, cy, size] = [place.width - 46, place.height - 74, 26];
  context.lineWidth = 2;
  for (const [name, axis, colour] of axes) {
    const seen = axis.clone().transformDirection(camera.matrixWorldInverse);
    const [x, y] = [cx + size * seen.x, cy - size * seen.y];
    context.strokeStyle = colour;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(cx, cy);
    context.lineTo(x, y);
    context.stroke();
    letters(context, place, name, cx + 1.35 * size * seen.x - 3, cy - 1.35 * size * seen.y, colour);
  }
}

/** `perLength`: px of a length in the middle of the body. */
function drawScale(context: CanvasRenderingContext2D, place: Place, perLength: number, unit: string): void {
  const length = round(110 / perLength);
  const [right, y, width] = [place.width - 16, place.height - 14, length * perLength];
  context.fillStyle = place.ink;
  context.fillRect(right - width, y, width, 3);
  context.fillRect(right - width, y - 4, 2, 11);
  context.fillRect(right - 2, y - 4, 2, 11);
  context.textAlign = 'center';
  letters(context, place, `${figure(length)} ${unit}`, right - width / 2, y - 11, place.ink);
  context.textAlign = 'left';
}

/** Beside its mark, below what stands there already. */
function drawLabels(context: CanvasRenderingContext2D, place: Place, camera: PerspectiveCamera, labels: Marks['labels']): void {
  const taken: number[] = [];
  for (const {at, text, colour} of labels) {
    const seen = at.clone().project(camera);
    const width = context.measureText(text).width;
    const x = Math.max(6, Math.min(place.width - width - 6, (0.5 + 0.5 * seen.x) * place.width + 8));
    let y = Math.max(12, Math.min(place.height - 12, (0.5 - 0.5 * seen.y) * place.height));
    while (taken.some((other) => Math.abs(other - y) < 15)) y += 15;
    taken.push(y);
    letters(context, place, text, x, y, '#' + colour.toString(16).padStart(6, '0'));
  }
}

export function drawOverlay(canvas: HTMLCanvasElement, camera: PerspectiveCamera, perLength: number, unit: string,
                            labels: Marks['labels']): void {
  const ratio = window.devicePixelRatio || 1;
  const style = getComputedStyle(document.body);
  const place: Place = {width: canvas.clientWidth, height: canvas.clientHeight,
    ink: style.getPropertyValue('--ink').trim(), paper: style.getPropertyValue('--stage').trim()};
  canvas.width = Math.round(place.width * ratio);
  canvas.height = Math.round(place.height * ratio);
  const context = canvas.getContext('2d')!;
  context.scale(ratio, ratio);
  context.font = `12px ${style.fontFamily}`;
  context.textBaseline = 'middle';
  drawAxes(context, place, camera);
  drawScale(context, place, perLength, unit);
  drawLabels(context, place, camera, labels);
}
