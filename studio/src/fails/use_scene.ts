// A body drawn in a canvas for as long as the canvas is there.
import {useEffect, useState} from 'preact/hooks';
import type {RefObject} from 'preact';
import {BodyScene} from './scene';

/** The scene, or why there is none. */
export function useScene(canvas: RefObject<HTMLCanvasElement>, overlay?: RefObject<HTMLCanvasElement>): {scene: BodyScene | null; fault: string} {
  const [scene, setScene] = useState<BodyScene | null>(null);
  const [fault, setFault] = useState('');
  useEffect(() => {
    try {
      const made = new BodyScene(canvas.current!, overlay?.current);
      setScene(made);
      const watch = new ResizeObserver(() => made.draw());
      watch.observe(canvas.current!);
      return () => {
        watch.disconnect();
        made.dispose();
      };
    } catch {
      setFault('This browser has no WebGL, so the body cannot be drawn.');
      return undefined;
    }
  }, []);
  return {scene, fault};
}
