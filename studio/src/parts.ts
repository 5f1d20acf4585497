// Pictures and fields by name: from elements of this very page, or from the program that serves it.
import {decode} from 'fast-png';
import type {Picture} from './document';

export interface Grid {
  width: number;
  height: number;
  /** NaN: does not count. */
  values: Float32Array;
  /** Each value stands for shrink x shrink pixels. */
  shrink: number;
}

const ready = new Promise<void>((resolve) => {
  if (document.readyState !== 'loading') resolve();
  else document.addEventListener('DOMContentLoaded', () => resolve());
});

let live = false;
export function setLive(isLive: boolean): void {
  live = isLive;
}

export function fromBase64(text: string): Uint8Array {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

async function element(name: string): Promise<Element> {
  await ready;
  const found = document.querySelector(`[data-part="${CSS.escape(name)}"]`);
  if (!found) throw new Error(`${name} is not in this page`);
  return found;
}

async function fetched(name: string): Promise<Response> {
  const reply = await fetch('part?name=' + encodeURIComponent(name));
  if (!reply.ok) throw new Error(`${name}: ${reply.status} ${await reply.text()}`);
  return reply;
}

/** A part as it is. */
export async function bytesOf(name: string): Promise<Uint8Array> {
  if (live) return new Uint8Array(await (await fetched(name)).arrayBuffer());
  return fromBase64((await element(name)).textContent ?? '');
}

/** A small store of the newest values; promises, so that one picture is decoded once. */
class Recent<T> {
  private known = new Map<string, Promise<T>>();
  constructor(private most: number) {}
  get(name: string, make: () => Promise<T>): Promise<T> {
    let value = this.known.get(name);
    if (value) this.known.delete(name);
    else value = make();
    this.known.set(name, value);
    value.catch(() => this.known.delete(name));
    const first = this.known.keys().next();
    if (this.known.size > this.most && !first.done) this.known.delete(first.value);
    return value;
  }
  clear(): void {
    this.known.clear();
  }
}

const grids = new Recent<Grid>(24);
const documents = new Recent<unknown>(64);

export function picture(entry: Picture): Promise<Grid> {
  return grids.get(entry.blob, async () => {
    const png = decode(await bytesOf(entry.blob));
    const values = new Float32Array(png.width * png.height);
    for (let i = 0; i < values.length; ++i) {
      const code = png.data[i];
      values[i] = code === 0 ? NaN : (code - entry.quantum.zero) * entry.quantum.step;
    }
    return {width: png.width, height: png.height, values, shrink: entry.shrink};
  });
}

export function field<T>(name: string): Promise<T> {
  return documents.get(name, async () => {
    if (live) return (await fetched(name)).json();
    return JSON.parse((await element(name)).textContent ?? '');
  }) as Promise<T>;
}

/** Arrays on nodes: `components` values each. */
export interface StoredArray {
  components: number;
  float32: string;
}
export function array(stored: StoredArray): Float32Array {
  const bytes = fromBase64(stored.float32);
  return new Float32Array(bytes.buffer, 0, bytes.length / 4);
}

/** Value of a grid at a pixel of the full-size picture. */
export function at(grid: Grid, x: number, y: number): number {
  const u = Math.floor(x / grid.shrink);
  const v = Math.floor(y / grid.shrink);
  return u < 0 || v < 0 || u >= grid.width || v >= grid.height
    ? NaN
    : grid.values[v * grid.width + u];
}
