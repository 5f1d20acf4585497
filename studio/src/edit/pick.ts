// Faces of the body that are picked, to make a region of.
import {signal} from '@preact/signals';
import {smoothPatch, type Body} from './body';
import {form, picked} from './chosen';

/** How sharp an edge may be that a click goes over; 0: it picks one face. */
export const across = signal(20);

/** Picks the faces that go on from a triangle of the shown body, or leaves them out again. */
export function pick(of: Body, triangle: number): void {
  if (triangle < 0) return;
  const hit = across.value > 0 ? smoothPatch(of, triangle, across.value) : [of.parent[triangle]];
  toggle(hit);
}
export function toggle(faces: number[]): void {
  const now = new Set(picked.value);
  const all = faces.every((face) => now.has(face));
  for (const face of faces) {
    if (all) now.delete(face);
    else now.add(face);
  }
  picked.value = now;
  form.value = 'regions';
}
