// What is shown of one photo and one step: the pictures, and the arrows over them.
import {useEffect, useState} from 'preact/hooks';
import type {StepEntry} from '../document';
import {array, field, type StoredArray} from '../parts';
import {run} from '../state';
import {frames, paint, type Frames, type Kind} from './frames';
import type {Arrow, Layer} from './panel';

interface Flow {
  cell_px: number;
  rms_px: number;
  length_per_px: number;
  cells: StoredArray;
}

export interface Shown {
  frames: Frames;
  layers: Record<Kind, Layer | null>;
  flow: Flow | null;
  /** None where what is left is too little to be more than noise. */
  arrows: Arrow[];
  gain: number;
}

/** Below this the arrows would have to be drawn a thousand times as long, and show noise [px]. */
export const leastMotion = 0.02;

function arrowsOf(flow: Flow | null): {arrows: Arrow[]; gain: number} {
  if (!flow || flow.rms_px < leastMotion) return {arrows: [], gain: 1};
  const cells = array(flow.cells);
  const arrows: Arrow[] = [];
  for (let i = 0; i < cells.length; i += 5)
    if (cells[i + 4] > 0)
      arrows.push({x: cells[i], y: cells[i + 1], dx: cells[i + 2], dy: cells[i + 3]});
  const lengths = arrows.map((a) => Math.hypot(a.dx, a.dy)).sort((a, b) => a - b);
  const large = Math.max(1e-3, lengths[Math.floor(0.9 * lengths.length)] ?? 1);
  const wanted = (1.5 * flow.cell_px) / large;
  const decade = 10 ** Math.floor(Math.log10(wanted));
  return {arrows, gain: ([5, 2, 1].find((s) => s * decade <= wanted) ?? 1) * decade};
}

async function load(index: number, of: StepEntry | undefined): Promise<Shown | null> {
  const entry = run.value.photos[index];
  if (!entry) return null;
  const all = await frames(entry, of);
  const layer = (kind: Kind): Layer | null => {
    const canvas = paint(all, kind);
    return canvas && {canvas, shrink: (kind === 'photo' ? all.photo : all.residual)?.shrink ?? 1};
  };
  const name = of?.fields[`photo-${entry.name}`];
  const flow = name ? await field<Flow>(name).catch(() => null) : null;
  return {
    frames: all,
    layers: {photo: layer('photo'), model: layer('model'), residual: layer('residual')},
    flow,
    ...arrowsOf(flow),
  };
}

export function useShown(index: number, of: StepEntry | undefined): Shown | null {
  const [shown, setShown] = useState<Shown | null>(null);
  useEffect(() => {
    let current = true;
    void load(index, of).then((value) => current && setShown(value));
    return () => {
      current = false;
    };
  }, [index, of]);
  return shown;
}

