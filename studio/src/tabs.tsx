// The five verbs and the facts as tabs; each tells in figures what its view holds.
import {useLengthPerPx} from './length_per_px';
import {verb, verbNames, verbs, type Verb} from './state';
import {story} from './story';

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
