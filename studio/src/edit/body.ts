// The body's surface as triangles that can be picked, and which of them a region has.
import {computed, signal} from '@preact/signals';
import {fromBase64} from '../parts';
import {ask, capture, type RegionEntry} from './capture';

export interface Body {
  /** Corners of each triangle, nine numbers. */
  corners: Float32Array;
  normals: Float32Array;
  middles: Float32Array;
  triangles: Uint32Array;
  /** Triangle of the file. */
  parent: Int32Array;
  groups: Record<string, number[]>;
  ofFile: boolean;
  /** Over each edge of a triangle the next one; -1: none. */
  beside: Int32Array;
  diagonal: number;
  count: number;
}

const numbers = (text: string): ArrayBuffer => fromBase64(text).buffer as ArrayBuffer;

function neighbours(triangles: Uint32Array): Int32Array {
  const over = new Map<number, number>();
  const beside = new Int32Array(triangles.length).fill(-1);
  for (let k = 0; k < triangles.length; ++k) {
    const [a, b] = [triangles[k], triangles[k % 3 === 2 ? k - 2 : k + 1]];
    const key = Math.min(a, b) * 4294967296 + Math.max(a, b);
    const other = over.get(key);
    if (other === undefined) over.set(key, k);
    else [beside[k], beside[other]] = [Math.floor(other / 3), Math.floor(k / 3)];
  }
  return beside;
}

export function decoded(told: {rest: string; triangles: string; parent: string; groups: Record<string, number[]>; of_file: boolean}): Body {
  const rest = new Float32Array(numbers(told.rest)), triangles = new Uint32Array(numbers(told.triangles));
  const count = triangles.length / 3;
  const corners = new Float32Array(9 * count), normals = new Float32Array(3 * count), middles = new Float32Array(3 * count);
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let t = 0; t < count; ++t) {
    for (let k = 0; k < 3; ++k)
      for (let c = 0; c < 3; ++c) {
        const x = rest[3 * triangles[3 * t + k] + c];
        corners[9 * t + 3 * k + c] = x;
        middles[3 * t + c] += x / 3;
        low[c] = Math.min(low[c], x);
        high[c] = Math.max(high[c], x);
      }
    const p = corners.subarray(9 * t, 9 * t + 9);
    const [u, v] = [[p[3] - p[0], p[4] - p[1], p[5] - p[2]], [p[6] - p[0], p[7] - p[1], p[8] - p[2]]];
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...n) || 1;
    normals.set(n.map((x) => x / length), 3 * t);
  }
  return {corners, normals, middles, triangles, parent: new Int32Array(numbers(told.parent)), groups: told.groups, ofFile: told.of_file,
    beside: neighbours(triangles), diagonal: Math.hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]), count};
}

export const body = signal<Body | null>(null);
export const bodyFault = signal('');
let shownStamp = '';
/** Fetches the body anew where its files are others. */
export async function refreshBody(): Promise<void> {
  const stamp = capture.value?.body ?? '';
  if (!capture.value || stamp === shownStamp) return;
  shownStamp = stamp;
  try {
    const told = await (await ask('body')).json();
    if (stamp !== shownStamp) return;
    body.value = decoded(told);
    bodyFault.value = '';
  } catch (error) {
    body.value = null;
    bodyFault.value = (error as Error).message;
  }
}

const dot = (a: ArrayLike<number>, b: ArrayLike<number>): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

function holds({box, sphere, halfspace}: RegionEntry, x: number, y: number, z: number): boolean {
  if (box) return x >= box[0][0] && x <= box[1][0] && y >= box[0][1] && y <= box[1][1] && z >= box[0][2] && z <= box[1][2];
  if (sphere) return Math.hypot(x - sphere.center[0], y - sphere.center[1], z - sphere.center[2]) <= sphere.radius;
  return halfspace !== undefined && dot([x, y, z], halfspace.normal) >= dot(halfspace.point, halfspace.normal);
}

/** Triangles of the shown body that lie in a region: by their middles. */
export function patch(of: Body, region: RegionEntry): number[] {
  const out: number[] = [];
  const listed = region.faces ? new Set(region.faces) : region.group ? new Set(of.groups[region.group] ?? []) : null;
  for (let t = 0; t < of.count; ++t) {
    if (listed ? listed.has(of.parent[t]) : holds(region, of.middles[3 * t], of.middles[3 * t + 1], of.middles[3 * t + 2])) out.push(t);
  }
  return out;
}

/** Of all regions, once for each text and body. */
export const patches = computed<Map<string, number[]>>(() => {
  const out = new Map<string, number[]>();
  if (body.value) for (const one of capture.value?.regions ?? []) out.set(one.name, patch(body.value, one));
  return out;
});

/** The faces that go on from a triangle without an edge sharper than `degrees`, around bends up to three times as much in all:
 *  triangles of the file. */
export function smoothPatch(of: Body, from: number, degrees: number): number[] {
  const [least, leastInAll] = [degrees, Math.min(180, 3 * degrees)].map((d) => Math.cos((d * Math.PI) / 180));
  const normal = (t: number): Float32Array => of.normals.subarray(3 * t, 3 * t + 3);
  const [seen, waiting, out] = [new Set([from]), [from], new Set<number>()];
  while (waiting.length) {
    const t = waiting.pop()!;
    if (of.parent[t] >= 0) out.add(of.parent[t]);
    for (let k = 0; k < 3; ++k) {
      const next = of.beside[3 * t + k];
      if (next < 0 || seen.has(next)) continue;
      if (of.parent[next] !== of.parent[t] && (dot(normal(t), normal(next)) < least || dot(normal(from), normal(next)) < leastInAll)) continue;
      seen.add(next);
      waiting.push(next);
    }
  }
  return [...out];
}

/** The faces at the end of the body along an axis that look that way: triangles of the file. */
export function endFaces(of: Body, axis: number, sign: number): number[] {
  let end = -Infinity, start = Infinity;
  for (let i = axis; i < of.corners.length; i += 3) [end, start] = [Math.max(end, sign * of.corners[i]), Math.min(start, sign * of.corners[i])];
  const deep = Math.max(0.02 * (end - start), 1e-6 * of.diagonal);
  const whole = new Map<number, boolean>();
  for (let t = 0; t < of.count; ++t) {
    const good = sign * of.normals[3 * t + axis] > 0.7 && sign * of.middles[3 * t + axis] >= end - deep;
    whole.set(of.parent[t], good && (whole.get(of.parent[t]) ?? true));
  }
  return [...whole].filter(([parent, good]) => good && parent >= 0).map(([parent]) => parent);
}

/** The box around picked triangles, a little larger; and whether it has no others. */
export function boxAround(of: Body, picked: Set<number>): {box: [number[], number[]]; exact: boolean} {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  let inside = 0;
  for (let t = 0; t < of.count; ++t) {
    if (!picked.has(of.parent[t])) continue;
    inside += 1;
    for (let k = 0; k < 9; ++k) {
      low[k % 3] = Math.min(low[k % 3], of.corners[9 * t + k]);
      high[k % 3] = Math.max(high[k % 3], of.corners[9 * t + k]);
    }
  }
  // Outwards to a round number.
  const margin = 0.002 * of.diagonal, step = 10 ** Math.floor(Math.log10(margin));
  const round = (x: number, way: (x: number) => number): number => Number((way(Number((x / step).toPrecision(9))) * step).toPrecision(8));
  const box: [number[], number[]] = [low.map((x) => round(x - margin, Math.floor)), high.map((x) => round(x + margin, Math.ceil))];
  return {box, exact: patch(of, {name: '', line: 0, box: box as RegionEntry['box']}).length === inside};
}

/** Its middle, its direction outwards, weighed by area. */
export function middleOf(of: Body, triangles: number[]): {at: number[]; out: number[]} {
  const [at, out] = [[0, 0, 0], [0, 0, 0]];
  let sum = 0;
  for (const t of triangles) {
    const p = of.corners.subarray(9 * t, 9 * t + 9);
    const [u, v] = [[p[3] - p[0], p[4] - p[1], p[5] - p[2]], [p[6] - p[0], p[7] - p[1], p[8] - p[2]]];
    const area = 0.5 * Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    sum += area;
    for (let c = 0; c < 3; ++c) {
      at[c] += area * of.middles[3 * t + c];
      out[c] += area * of.normals[3 * t + c];
    }
  }
  return {at: at.map((x) => x / (sum || 1)), out: out.map((x) => x / (Math.hypot(...out) || 1))};
}

/** Colours of regions: apart for most eyes (Okabe, Ito 2008). */
const palette: [number, number, number][] = [[0, 158, 115], [86, 180, 233], [204, 121, 167], [213, 94, 0], [0, 114, 178], [230, 159, 0]];
export const regionColour = (index: number): [number, number, number] => palette[index % palette.length];
export const plainColour: [number, number, number] = [168, 172, 178];
export const pickedColour: [number, number, number] = [255, 212, 0];

/** Colour of each shown triangle: picked, of the chosen region, of any, or of none. */
export function colours(of: Body, chosen: string, picked: Set<number>): [number, number, number][] {
  const out: [number, number, number][] = Array.from({length: of.count}, () => plainColour);
  [...patches.value].forEach(([name, triangles], i) => {
    if (!chosen || name === chosen) for (const t of triangles) out[t] = regionColour(i);
  });
  if (picked.size) for (let t = 0; t < of.count; ++t) if (picked.has(of.parent[t])) out[t] = pickedColour;
  return out;
}
