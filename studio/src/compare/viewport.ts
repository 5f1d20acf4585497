// One zoom and place for all pictures: `scale` screen px per photo pixel, photo pixel (x, y) in
// the middle of every panel.
import {signal} from '@preact/signals';

export interface Place {
  scale: number;
  x: number;
  y: number;
}
/** scale 0: fit what counts into the panel. */
export const place = signal<Place>({scale: 0, x: 0, y: 0});
/** The pixel under the pointer or the keyboard's cross, in every panel. */
export const cursor = signal<{x: number; y: number} | null>(null);

export interface Size {
  width: number;
  height: number;
}
export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}
/** What "fit" shows: the pixels that count; null: the whole picture. */
export const focus = signal<Box | null>(null);

export function resolved(panel: Size, photo: Size): Place {
  if (place.value.scale > 0) return place.value;
  const box = focus.value ?? {left: 0, top: 0, right: photo.width - 1, bottom: photo.height - 1};
  const scale = Math.min(
    panel.width / (box.right - box.left + 1),
    panel.height / (box.bottom - box.top + 1),
  );
  return {scale, x: (box.left + box.right) / 2, y: (box.top + box.bottom) / 2};
}

/** Photo pixel under a point of the panel. Pixel centres are whole numbers. */
export function pixelAt(panel: Size, photo: Size, left: number, top: number): {x: number; y: number} {
  const p = resolved(panel, photo);
  return {
    x: Math.round(p.x + (left - panel.width / 2) / p.scale),
    y: Math.round(p.y + (top - panel.height / 2) / p.scale),
  };
}

export function screenAt(panel: Size, photo: Size, x: number, y: number): [number, number] {
  const p = resolved(panel, photo);
  return [panel.width / 2 + (x - p.x) * p.scale, panel.height / 2 + (y - p.y) * p.scale];
}

/** Zooms so that the photo point under (left, top) stays there. */
export function zoom(panel: Size, photo: Size, factor: number, left: number, top: number): void {
  const p = resolved(panel, photo);
  const scale = Math.min(64, Math.max(0.05, p.scale * factor));
  const x = p.x + (left - panel.width / 2) / p.scale;
  const y = p.y + (top - panel.height / 2) / p.scale;
  place.value = {
    scale,
    x: x - (left - panel.width / 2) / scale,
    y: y - (top - panel.height / 2) / scale,
  };
}

export function pan(panel: Size, photo: Size, dx: number, dy: number): void {
  const p = resolved(panel, photo);
  place.value = {scale: p.scale, x: p.x - dx / p.scale, y: p.y - dy / p.scale};
}
