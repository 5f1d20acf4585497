// The residual that the chosen effect would remove, over the photo and on the body.
import {useEffect, useRef, useState} from 'preact/hooks';
import {diverging, notCounted, sequential} from '../colours';
import {figure, spaced} from '../format';
import {array, field, type StoredArray} from '../parts';
import {chosenPhoto, run, step} from '../state';
import {residualScale} from '../compare/frames';

/** photo-cells of every photo: column, row, residual now [sigma rms, signed by its change]. */
interface Prediction {
  cell_px: number;
  photos: Record<string, {cells: StoredArray}>;
}

/** Cells: x, y of the corner [px], root mean square residual now, the same with the effect. */
function draw(canvas: HTMLCanvasElement, prediction: Prediction, name: string): void {
  const entry = run.value.photos.find((p) => p.name === name);
  const told = prediction.photos[name];
  if (!entry || !told) return;
  const cells = array(told.cells);
  canvas.width = Math.ceil(entry.width / prediction.cell_px);
  canvas.height = Math.ceil(entry.height / prediction.cell_px);
  const context = canvas.getContext('2d')!;
  context.fillStyle = `rgb(${notCounted.join(' ')})`;
  context.fillRect(0, 0, canvas.width, canvas.height);
  for (let i = 0; i < cells.length; i += 4) {
    const fall = cells[i + 3] - cells[i + 2];
    context.fillStyle = `rgb(${diverging(fall / residualScale).join(' ')})`;
    context.fillRect(cells[i], cells[i + 1], 1, 1);
  }
}
void sequential;

export function Removed(props: {effect: string}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [prediction, setPrediction] = useState<Prediction | null>(null);
  const part = step.value?.fields[`removes-${props.effect}`];
  useEffect(() => {
    let current = true;
    setPrediction(null);
    if (part) void field<Prediction>(part).then((p) => current && setPrediction(p), () => undefined);
    return () => {
      current = false;
    };
  }, [part]);
  const names = Object.keys(prediction?.photos ?? {});
  const wanted = run.value.photos[chosenPhoto.value]?.name;
  const name = wanted && names.includes(wanted) ? wanted : names[0];
  useEffect(() => {
    if (canvas.current && prediction && name) draw(canvas.current, prediction, name);
  }, [prediction, name]);
  if (!prediction || !name) return null;
  return (
    <figure class="removed">
      <figcaption>Residual that {spaced(props.effect)} would remove in {name}</figcaption>
      <canvas ref={canvas} role="img" aria-label={`Residual that ${props.effect} would remove in ${name}`} />
      <p class="note">blue: removed, red: added, up to {figure(residualScale)} σ (root mean square of a cell)</p>
    </figure>
  );
}
