// What an effect would remove of the residual, in cells of the photos.
import {useEffect, useState} from 'preact/hooks';
import {field} from '../parts';

/** Cells of a photo; `bytes`: all residuals there are, then all that would be removed (128: 0). */
export interface Cells {
  columns: number;
  rows: number;
  bytes: string;
}
export interface Prediction {
  cell_px: number;
  unit: number;
  photos: Record<string, Cells>;
}

/** The prediction of an effect; the one before stays until it is read, so that nothing flickers. */
export function usePrediction(part: string | undefined): Prediction | null {
  const [prediction, setPrediction] = useState<Prediction | null>(null);
  useEffect(() => {
    let current = true;
    if (part) void field<Prediction>(part).then((p) => current && setPrediction(p), () => undefined);
    return () => {
      current = false;
    };
  }, [part]);
  return part ? prediction : null;
}
