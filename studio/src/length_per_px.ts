// Pixels as lengths on the body.
import {useEffect, useState} from 'preact/hooks';
import {field} from './parts';
import {run, worstPhoto} from './state';

/** Length of a pixel at the worst photo of the base step; NaN until it is known. */
export function useLengthPerPx(): number {
  const [length, setLength] = useState(NaN);
  const base = run.value.steps[0];
  const worst = run.value.photos[worstPhoto(base)];
  const part = worst && base?.fields[`photo-${worst.name}`];
  useEffect(() => {
    if (part) void field<{length_per_px: number}>(part).then((f) => setLength(f.length_per_px), () => undefined);
  }, [part]);
  return length;
}
