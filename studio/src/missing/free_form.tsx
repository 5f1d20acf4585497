// Where to look when no effect of the catalogue explains what is left: forces that would, drawn on
// the body (estimation/diagnosis/free_form.h).
import {signal} from '@preact/signals';
import {useEffect, useRef, useState} from 'preact/hooks';
import {sequential, type Ramp} from '../colours';
import {examplesOf, norms, surface, type Surface} from '../fails/surface';
import {useScene} from '../fails/use_scene';
import {saveCsv} from '../download';
import {figure, logEvidence, percent} from '../format';
import {array, field, type StoredArray} from '../parts';
import {savePictures} from '../pictures';
import {step, theme} from '../state';
import {Legend} from '../widgets';

interface Field {
  name: string;
  /** The one it acts in; null: all. */
  example: string | null;
  unit: string;
  evidence: number;
  explains: number;
  sentence: string;
  forces: StoredArray;
}
const chosen = signal(0);

const names: Record<string, string> = {body_force: 'force in the body', traction: 'traction on the surface'};
const nameOf = (f: Field): string => `${names[f.name] ?? f.name}${f.example ? ` in ${f.example}` : ', in all load cases'}`;

function rampOf(f: Field, most: number): Ramp {
  return {title: `${names[f.name] ?? f.name} [${f.unit}]`, ends: ['0', '', figure(most)], scale: sequential, from: 0};
}

/** The fields of the step that is shown and its body in `example`, once they are read. */
function useFields(): {fields: Field[]; body: Surface | null} {
  const [fields, setFields] = useState<Field[]>([]);
  const [body, setBody] = useState<Surface | null>(null);
  const now = step.value;
  const part = now?.fields['free_form'];
  useEffect(() => {
    let current = true;
    setFields([]);
    if (now && part)
      void Promise.all([field<Field[]>(part), surface(now, examplesOf(now)[0])]).then(([read, first]) => {
        if (!current) return;
        setFields(read);
        setBody(first);
      }, () => undefined);
    return () => {
      current = false;
    };
  }, [now, part]);
  return {fields, body};
}

function Drawn(props: {of: Field; body: Surface}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const {scene, fault} = useScene(canvas);
  const {of, body} = props;
  const forces = array(of.forces);
  const sizes = norms(forces);
  const most = Math.max(...sizes);
  const ramp = rampOf(of, most);
  useEffect(() => {
    if (!scene) return;
    scene.setBackground(getComputedStyle(document.body).getPropertyValue('--stage').trim() || '#ffffff');
    scene.show(body, {amount: 0, ghost: false, colour: (i) => sequential(sizes[i] / most), arrows: forces});
  }, [scene, body, of, theme.value]);
  const csv = (): void => saveCsv(`${of.name}.csv`, [['x', 'y', 'z', 'fx', 'fy', 'fz'],
    ...Array.from(sizes, (_, i) => [...body.rest.slice(3 * i, 3 * i + 3), ...forces.slice(3 * i, 3 * i + 3)])]);
  return (
    <figure class="drawn">
      <canvas ref={canvas} tabIndex={0} role="img" onKeyDown={(event) => scene?.key(event)}
        aria-label={`${nameOf(of)}, on the body at rest; arrow keys turn it, + and - zoom`} />
      <figcaption class="legends">{fault || <Legend ramp={ramp} />}
        <span><button class="quiet" onClick={csv}>CSV</button>
          <button class="quiet" onClick={() => canvas.current && savePictures(`${of.name}.png`, [{canvas: canvas.current, says: nameOf(of)}], [ramp])}>PNG</button></span>
      </figcaption>
    </figure>
  );
}

export function FreeForm() {
  const {fields, body} = useFields();
  if (!fields.length || !body) return null;
  const shown = fields[Math.min(chosen.value, fields.length - 1)];
  return (
    <section class="free-form">
      <h3>Where to look</h3>
      <p>No effect of the catalogue explains what is left. Forces that would, whatever they stand for:</p>
      <ul>
        {fields.map((f, i) => (
          <li key={nameOf(f)}><button class="link" aria-pressed={f === shown} onClick={() => (chosen.value = i)}>{nameOf(f)}</button>
            {' '}would remove {percent(f.explains)}; log Bayes factor {logEvidence(f.evidence)}</li>
        ))}
      </ul>
      <Drawn of={shown} body={body} />
      <p class="note">{shown.sentence[0].toUpperCase() + shown.sentence.slice(1)}. Not every node has its arrow.</p>
    </section>
  );
}
