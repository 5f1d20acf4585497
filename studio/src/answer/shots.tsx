// The photo where the base model fails most: as it was taken, what the base model leaves of it and
// what the newest does.
import {useEffect, useRef, useState} from 'preact/hooks';
import {counted, frames, paint, residualRamp, type Frames, type Kind} from '../compare/frames';
import type {PhotoEntry, StepEntry} from '../document';
import {figure} from '../format';
import {chosenPhoto, figuresOf, run, verb, worstPhoto} from '../state';
import {Legend} from '../widgets';

interface Shot {
  of: Frames;
  kind: Kind;
  says: string;
}

async function shotsOf(entry: PhotoEntry, base: StepEntry, newest: StepEntry): Promise<Shot[]> {
  const first = await frames(entry, base);
  const chi = (step: StepEntry): string => figure(figuresOf(step, entry)?.chi);
  const shots: Shot[] = [
    {of: first, kind: 'photo', says: `photo: ${entry.example}, ${entry.camera}`},
    {of: first, kind: 'residual', says: `residual of the given model: ${chi(base)}`},
  ];
  if (newest !== base) shots.push({of: await frames(entry, newest), kind: 'residual', says: `of the model found: ${chi(newest)}`});
  return shots.filter((shot) => paint(shot.of, shot.kind));
}

/** The part that counts, whole and with a margin. */
function Picture(props: {shot: Shot}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const {of, kind} = props.shot;
  useEffect(() => {
    const painted = paint(of, kind);
    if (!painted || !canvas.current) return;
    const s = (kind === 'photo' ? of.photo : of.residual)!.shrink;
    const box = counted(of) ?? {left: 0, top: 0, right: of.entry.width - 1, bottom: of.entry.height - 1};
    const [width, height] = [(box.right - box.left + 1) / s, (box.bottom - box.top + 1) / s];
    canvas.current.width = Math.max(1, Math.round(width));
    canvas.current.height = Math.max(1, Math.round(height));
    canvas.current.getContext('2d')!.drawImage(painted, box.left / s, box.top / s, width, height, 0, 0, canvas.current.width, canvas.current.height);
  }, [of, kind]);
  return <figure><canvas ref={canvas} role="img" aria-label={props.shot.says} /><figcaption>{props.shot.says}</figcaption></figure>;
}

export function Shots() {
  const {steps, photos} = run.value;
  const [base, newest] = [steps[0], steps[steps.length - 1]];
  const index = worstPhoto(base);
  const entry = photos[index];
  const [shots, setShots] = useState<Shot[]>([]);
  useEffect(() => {
    let current = true;
    if (entry && base) void shotsOf(entry, base, newest).then((made) => current && setShots(made), () => undefined);
    return () => {
      current = false;
    };
  }, [entry, base, newest]);
  if (!entry || !base) return null;
  return (
    <section class="shots">
      <div class="row">{shots.map((shot) => <Picture key={shot.says} shot={shot} />)}</div>
      <div class="legends"><Legend ramp={residualRamp} />
        <span>Where the given model fails most; figures: normalised residual, 1 is noise. <button class="link" onClick={() => {
          chosenPhoto.value = index;
          verb.value = 'compare';
        }}>Compare all photos</button></span></div>
    </section>
  );
}
