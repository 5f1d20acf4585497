// The answer, the five verbs and the facts as tabs; each tells in figures what its view holds, the
// chosen one in a whole sentence below.
import {useEffect} from 'preact/hooks';
import {useLengthPerPx} from './length_per_px';
import {verb, verbNames, verbs} from './state';
import {story} from './story';

export function Tabs() {
  const told = story(useLengthPerPx());
  // A phone shows some of them at a time.
  useEffect(() => document.getElementById('tab-' + verb.value)?.scrollIntoView({block: 'nearest', inline: 'nearest'}), [verb.value]);
  const move = (event: KeyboardEvent): void => {
    const by = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (!by) return;
    event.preventDefault();
    verb.value = verbs[(verbs.indexOf(verb.value) + by + verbs.length) % verbs.length];
    document.getElementById('tab-' + verb.value)?.focus();
  };
  return (
    <nav>
      <div class="tabs" role="tablist" aria-label="The answer and the five verbs" onKeyDown={move}>
        {verbs.map((v, i) => (
          <button key={v} id={'tab-' + v} role="tab" aria-selected={v === verb.value} aria-controls="view"
                  aria-labelledby={'name-' + v} aria-describedby={'told-' + v} title={told[v].sentence}
                  tabIndex={v === verb.value ? 0 : -1} onClick={() => (verb.value = v)}>
            <span class="name" id={'name-' + v}>{i > 0 && i < 6 && <span class="number" aria-hidden="true">{i}</span>} {verbNames[v]}</span>
            <span id={'told-' + v} class="told"><b>{told[v].headline}</b> <span class="rest">{told[v].sentence}</span></span>
          </button>
        ))}
      </div>
      {verb.value !== 'answer' && <p class="story"><b>{told[verb.value].headline}</b> {told[verb.value].sentence}</p>}
    </nav>
  );
}
