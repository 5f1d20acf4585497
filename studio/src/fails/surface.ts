// The body's surface of one step and example, as the program wrote it (estimation/output/page_data.h).
import type {StepEntry} from '../document';
import {keysOf} from '../format';
import {units} from '../state';
import {array, field, type StoredArray} from '../parts';

interface StoredBody {
  rest: StoredArray;
  triangles: [number, number, number][];
  regions: Record<string, number[]>;
}
interface StoredExample {
  displacement: StoredArray;
  residual: StoredArray;
  gap: StoredArray;
  strain: StoredArray;
  von_mises: StoredArray;
  stiffness?: StoredArray;  // what effects have put into the model
  swelling?: StoredArray;
  beyond?: StoredArray;  // addends of an additive material beyond their control points
  views: {photo: string; pixel: StoredArray; seen: StoredArray}[];
}
export interface View {
  photo: string;
  pixel: Float32Array;
  seen: Float32Array;
}
export interface Surface {
  rest: Float32Array;
  triangles: Uint32Array;
  regions: Record<string, number[]>;
  displacement: Float32Array;
  /** By name; NaN where no photo tells, empty what the step does not have. */
  scalars: Record<Quantity, Float32Array>;
  views: View[];
}

export const quantityNames = {
  residual: 'residual',
  gap: 'residual displacement',
  strain: 'strain',
  von_mises: 'stress',
  displacement: 'displacement',
  stiffness: 'stiffness change',
  swelling: 'swelling',
  beyond: 'beyond control points',
};
export type Quantity = keyof typeof quantityNames;
const quantities = keysOf(quantityNames);

/** Strains and fitted fields, over 1. */
export function hasSign(q: Quantity): boolean {
  return q === 'strain' || q === 'stiffness' || q === 'swelling';
}

/** Those that the step tells of. */
export function quantitiesOf(s: Surface | undefined): Quantity[] {
  return quantities.filter((q) => s && s.scalars[q].length > 0);
}

export function unitOf(q: Quantity): string {
  if (q === 'residual') return 'σ of noise';
  if (hasSign(q)) return '1';
  if (q === 'beyond') return 'addends';
  return q === 'von_mises' ? `${units.value.stress}, von Mises` : units.value.length;
}

/** Lengths of vectors in a row. */
export function norms(vectors: Float32Array): Float32Array {
  const out = new Float32Array(vectors.length / 3);
  for (let i = 0; i < out.length; ++i)
    out[i] = Math.hypot(vectors[3 * i], vectors[3 * i + 1], vectors[3 * i + 2]);
  return out;
}

export function examplesOf(step: StepEntry | undefined): string[] {
  return Object.keys(step?.fields ?? {})
    .filter((key) => key.startsWith('example-'))
    .map((key) => key.slice('example-'.length));
}

export async function surface(step: StepEntry, example: string): Promise<Surface> {
  const [body, state] = await Promise.all([
    field<StoredBody>(step.fields['body']),
    field<StoredExample>(step.fields['example-' + example]),
  ]);
  const displacement = array(state.displacement);
  const none = new Float32Array();
  return {
    rest: array(body.rest),
    triangles: new Uint32Array(body.triangles.flat()),
    regions: body.regions,
    displacement,
    scalars: {
      residual: array(state.residual),
      gap: norms(array(state.gap)),
      strain: array(state.strain),
      von_mises: array(state.von_mises),
      displacement: norms(displacement),
      stiffness: state.stiffness ? array(state.stiffness) : none,
      swelling: state.swelling ? array(state.swelling) : none,
      beyond: state.beyond ? array(state.beyond) : none,
    },
    views: state.views.map((view) => ({
      photo: view.photo,
      pixel: array(view.pixel),
      seen: array(view.seen),
    })),
  };
}

/** The bodies that can be read, and the names of the others: one damaged file hides no other. */
export async function readable(step: StepEntry, names: string[]): Promise<{all: Map<string, Surface>; lost: string[]}> {
  const read = await Promise.allSettled(names.map((name) => surface(step, name)));
  const all = new Map<string, Surface>();
  read.forEach((one, i) => one.status === 'fulfilled' && all.set(names[i], one.value));
  return {all, lost: names.filter((name) => !all.has(name))};
}

/** 99 % point of the absolute values: one bad node does not set the scale. */
export function reach(values: Float32Array[]): number {
  const all: number[] = [];
  for (const list of values) for (const v of list) if (Number.isFinite(v)) all.push(Math.abs(v));
  all.sort((a, b) => a - b);
  return all.length ? all[Math.floor(0.99 * (all.length - 1))] || 1e-12 : 1;
}
