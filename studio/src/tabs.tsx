// The five verbs and the facts as tabs; each tells in figures what its view holds.
import {useEffect, useState} from 'preact/hooks';
import {field} from './parts';
import {run, verb, verbNames, verbs, worstPhoto, type Verb} from './state';
import {story} from './story';

/** Length of a pixel at the worst photo of the base step; NaN until it is known. */
function useLengthPerPx(): number {
  const [length, setLength] = useState(NaN);
  const base = run.value.steps[0];
  const worst = run.value.photos[worstPhoto(base)];
  const part = worst && base?.fields[`photo-${worst.name}`];
  useEffect(() => {
    if (part) void field<{length_per_px: number}>(part).then((f) => setLength(f.length_per_px), () => undefined);
  }, [part]);
  return length;
}

function choose(next: Verb): void {
  verb.value = next;
  // On a phone the tabs fill the screen.
  if (matchMedia('(max-width: 900px)').matches) document.getElementById('view')?.scrollIntoView();
}

export function Tabs() {
  const told = story(useLengthPerPx());
  const move = (event: KeyboardEvent): void => {
    const by = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (!by) return;
    event.preventDefault();
    verb.value = verbs[(verbs.indexOf(verb.value) + by + verbs.length) % verbs.length];
    document.getElementById('tab-' + verb.value)?.focus();
  };
  return (
    <div class="tabs" role="tablist" aria-label="The five verbs" onKeyDown={move}>
      {verbs.map((v, i) => (
        <button key={v} id={'tab-' + v} role="tab" aria-selected={v === verb.value} aria-controls="view"
                aria-labelledby={'name-' + v} aria-describedby={'told-' + v}
                tabIndex={v === verb.value ? 0 : -1} onClick={() => choose(v)}>
          <span class="name" id={'name-' + v}>{i < 5 && <span class="number" aria-hidden="true">{i + 1}</span>} {verbNames[v]}</span>
          <span id={'told-' + v} class="told"><b>{told[v].headline}</b> {told[v].sentence}</span>
        </button>
      ))}
    </div>
  );
}
