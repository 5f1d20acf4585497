// PNG of figures that say what they show: with titles, legends and units.
import {css, type Ramp} from './colours';
import {saveCanvas} from './download';

interface Sheet {
  canvas: HTMLCanvasElement;
  context: CanvasRenderingContext2D;
  ink: string;
}
/** A canvas at twice the size of `width` x `height`, with the page's colours and its letters. */
function sheet(width: number, height: number): Sheet {
  const canvas = document.createElement('canvas');
  canvas.width = 2 * width;
  canvas.height = 2 * height;
  const context = canvas.getContext('2d')!;
  const style = getComputedStyle(document.body);
  context.scale(2, 2);
  context.fillStyle = style.backgroundColor;
  context.fillRect(0, 0, width, height);
  context.font = `13px ${style.fontFamily}`;
  context.textBaseline = 'middle';
  const ink = style.color;
  context.fillStyle = ink;
  return {canvas, context, ink};
}

/** Horizontal bars; `mark` is a line across them. */
export function saveBars(name: string, title: string, rows: {name: string; value: number}[], mark?: number): void {
  const {canvas, context, ink} = sheet(480, 34 + 22 * rows.length + (mark === undefined ? 0 : 22));
  const style = getComputedStyle(document.body);
  const most = Math.max(mark ?? 0, ...rows.map((r) => r.value || 0), 1e-12);
  context.fillText(title, 10, 15);
  rows.forEach((row, i) => {
    const y = 40 + 22 * i;
    context.fillStyle = ink;
    context.fillText(row.name, 10, y, 120);
    context.fillText(Number.isFinite(row.value) ? row.value.toPrecision(3) : '–', 425, y);
    context.fillStyle = style.getPropertyValue('--bar');
    context.fillRect(140, y - 6, (270 * Math.max(0, row.value || 0)) / most, 12);
    context.fillStyle = style.getPropertyValue('--mark');
    if (mark !== undefined) context.fillRect(140 + (270 * mark) / most, y - 9, 2, 18);
  });
  context.fillStyle = ink;
  if (mark !== undefined) context.fillText(`line: the noise floor, ${mark.toPrecision(3)}`, 140, 40 + 22 * rows.length);
  saveCanvas(name, canvas);
}

/** Measured values with their 95 % and the model's, on one scale. */
export function savePairs(name: string, title: string, pairs: {name: string; measured: number; half: number; model: number}[]): void {
  const {canvas, context, ink} = sheet(560, 62 + 22 * pairs.length);
  const style = getComputedStyle(document.body);
  const [bar, mark, line] = ['--bar', '--mark', '--line'].map((c) => style.getPropertyValue(c));
  const ends = pairs.flatMap((p) => [p.measured - p.half, p.measured + p.half, p.model, 0]);
  const [low, high] = [Math.min(...ends), Math.max(...ends)];
  const at = (v: number): number => 170 + (230 * (v - low)) / (high - low || 1);
  const dot = (x: number, y: number, colour: string, hollow: boolean): void => {
    context.strokeStyle = context.fillStyle = colour;
    context.lineWidth = 2;
    context.beginPath();
    context.arc(x, y, hollow ? 5 : 4, 0, 7);
    if (hollow) context.stroke();
    else context.fill();
  };
  context.fillText(title, 10, 15);
  context.fillStyle = line;
  context.fillRect(at(0), 28, 1, 22 * pairs.length);
  pairs.forEach((p, i) => {
    const y = 40 + 22 * i;
    context.fillStyle = ink;
    context.fillText(p.name, 10, y, 150);
    context.fillText(`${p.measured.toPrecision(3)} / ${p.model.toPrecision(3)}`, 420, y);
    context.fillStyle = bar;
    context.fillRect(at(p.measured - p.half), y - 1, at(p.measured + p.half) - at(p.measured - p.half), 2);
    dot(at(p.measured), y, bar, false);
    dot(at(p.model), y, mark, true);
  });
  const y = 46 + 22 * pairs.length;
  dot(20, y, bar, false);
  dot(220, y, mark, true);
  context.fillStyle = ink;
  context.fillText('measured, with ± 1.96 σ', 30, y);
  context.fillText('model', 230, y);
  saveCanvas(name, canvas);
}

/** A chart with its title above and what its lines are below. */
export function saveChart(name: string, title: string, chart: HTMLCanvasElement,
                          lines: {label: string; colour: string}[]): void {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [chart.width / ratio, chart.height / ratio];
  const {canvas, context, ink} = sheet(width, height + 34 + 20 * lines.length);
  context.fillText(title, 10, 15);
  context.drawImage(chart, 0, 26, width, height);
  lines.forEach((line, i) => {
    const y = height + 40 + 20 * i;
    context.fillStyle = line.colour;
    context.fillRect(20, y - 2, 24, 4);
    context.fillStyle = ink;
    context.fillText(line.label, 52, y);
  });
  saveCanvas(name, canvas);
}

function drawRamp(to: Sheet, ramp: Ramp, left: number, top: number): void {
  const {context, ink} = to;
  const width = 230;
  for (let i = 0; i < width; ++i) {
    context.fillStyle = css(ramp.scale(ramp.from + ((1 - ramp.from) * i) / (width - 1)));
    context.fillRect(left + i, top + 18, 1.5, 10);
  }
  context.fillStyle = ink;
  context.fillText(ramp.title, left, top + 8);
  (['left', 'center', 'right'] as const).forEach((align, k) => {
    context.textAlign = align;
    context.fillText(ramp.ends[k], left + (k * width) / 2, top + 38);
  });
  context.textAlign = 'left';
}

/** Pictures of one height side by side, what each shows above it, and their scales below. */
export function savePictures(name: string, pictures: {canvas: HTMLCanvasElement; says: string}[], ramps: Ramp[]): void {
  const shown = pictures.filter((p) => p.canvas.width > 0 && p.canvas.height > 0);
  const height = Math.max(1, ...shown.map((p) => p.canvas.height));
  const widths = shown.map((p) => (p.canvas.width * height) / p.canvas.height + 8);
  const total = Math.max(widths.reduce((sum, w) => sum + w, 8), 270 * ramps.length + 10);
  const to = sheet(total, height + 90);
  let left = 8;
  shown.forEach((picture, i) => {
    to.context.fillText(picture.says, left, 14, widths[i] - 8);
    to.context.drawImage(picture.canvas, left, 28, widths[i] - 8, height);
    left += widths[i];
  });
  ramps.forEach((ramp, i) => drawRamp(to, ramp, 10 + 270 * i, height + 38));
  saveCanvas(name, to.canvas);
}
