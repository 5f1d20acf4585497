// The page: the verdict on top; the answer, the five verbs and the facts as tabs, one at a time.
import {render} from 'preact';
import {useEffect, useRef} from 'preact/hooks';
import {Add, JobLine} from './add/add';
import {follow} from './add/job';
import {Answer} from './answer/answer';
import {Compare} from './compare/compare';
import {Editor} from './edit/editor';
import {Facts} from './facts/facts';
import {Fails} from './fails/fails';
import {Falls} from './falls/falls';
import {Missing} from './missing/missing';
import {setLive} from './parts';
import {chosenPhoto, help, otherStep, run, showStep, stepIndex, verb, verbs, type Verb} from './state';
import {Tabs} from './tabs';
import {followSystem, turnTheme} from './theme';
import {Said} from './widgets';
import './style.css';

const views: Record<Verb, () => preact.JSX.Element> = {
  answer: Answer, compare: Compare, fails: Fails, missing: Missing, add: Add, falls: Falls, facts: Facts,
};

function Verdict() {
  const {headline, sentence} = run.value.answer;
  const judged = run.value.timeline.sentence !== undefined;
  return <p class="verdict" title={sentence}><b class={judged ? headline : 'open'}>{headline}</b> <Said text={sentence} />.</p>;
}

/** What is not here, or was left out to keep the file small. */
function Notes() {
  const {faults, reduction} = run.value;
  if (!faults.length && !reduction) return null;
  const said = faults.length ? `${faults.length} thing${faults.length > 1 ? 's' : ''} of this run ${faults.length > 1 ? 'are' : 'is'} not here` : 'Reduced';
  return (
    <details class="faults"><summary>{said}</summary>
      <ul>{faults.map((f) => <li key={f}>{f}</li>)}{reduction && <li>{reduction}</li>}</ul></details>
  );
}

function StepChoice() {
  const list = run.value.steps;
  if (!list.length) return null;
  return (
    <span class="step-choice">
      <label>step <select value={stepIndex.value} onChange={(e) => showStep(Number(e.currentTarget.value))}>{list.map((s, i) => <option key={s.folder} value={i}>{s.folder}</option>)}</select></label>
      <label>against <select value={otherStep.value} onChange={(e) => (otherStep.value = Number(e.currentTarget.value))}>
        <option value={-1}>none</option>
        {list.map((s, i) => <option key={s.folder} value={i}>{s.folder}</option>)}
      </select></label>
    </span>
  );
}

const keyTable: [string, string][] = [
  ['a', 'the answer'],
  ['1 … 6', 'the five verbs, and the facts'],
  ['← → ↑ ↓', 'photos: next and previous; pictures: move the cross (Shift: by ten); body: turn'],
  ['+ − 0', 'zoom in, out, fit'],
  ['n p', 'next, previous photo'],
  ['[ ]', 'earlier, later step'],
  ['Enter', 'body: pick the point in the middle'],
  ['t', 'dark, light'],
  ['?', 'this table'],
];

/** Modal: the browser keeps the focus inside, closes it with Escape and gives the focus back. */
function Help() {
  const dialog = useRef<HTMLDialogElement>(null);
  useEffect(() => {
    if (help.value) dialog.current?.showModal();
    else dialog.current?.close();
  }, [help.value]);
  const close = (): void => void (help.value = false);
  return (
    <dialog class="help" ref={dialog} aria-label="Keys" onClose={close} onClick={close}>
      <table><tbody>{keyTable.map(([k, what]) => <tr key={k}><th scope="row"><kbd>{k}</kbd></th><td>{what}</td></tr>)}</tbody></table>
      <button onClick={close}>Close</button>
    </dialog>
  );
}

function keys(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  const typed = target instanceof HTMLInputElement ? !/checkbox|radio/.test(target.type) : /SELECT|TEXTAREA/.test(target.tagName);
  if (event.ctrlKey || event.metaKey || event.altKey || typed) return;
  const index = Number(event.key);
  if (index > 0 && verbs[index]) verb.value = verbs[index];
  else if (event.key === 'a') verb.value = 'answer';
  else if (event.key === 't') turnTheme();
  else if (event.key === '?') help.value = !help.value;
  else if (event.key === '[' && stepIndex.value > 0) showStep(stepIndex.value - 1);
  else if (event.key === ']' && stepIndex.value < run.value.steps.length - 1) showStep(stepIndex.value + 1);
  else if (event.key === 'n' || event.key === 'p') nextPhoto(event.key === 'n' ? 1 : -1);
}

function Page() {
  const View = views[verb.value];
  useEffect(() => {
    document.addEventListener('keydown', keys);
    return () => document.removeEventListener('keydown', keys);
  }, []);
  useEffect(() => {
    history.replaceState(null, '', '#' + verb.value);
  }, [verb.value]);
  const title = run.value.capture?.title ?? run.value.run.split('/').pop();
  return (
    <>
      <header>
        <h1 title={title}>Hookeye <small>{title}</small></h1>
        <Verdict />
        {verb.value !== 'answer' && <StepChoice />}
        <Notes />
        <span class="tools">
          <button title="Dark or light (t)" aria-label="Dark or light" onClick={turnTheme}>◐</button>
          <button title="Keys (?)" aria-label="Keys" onClick={() => (help.value = !help.value)}>?</button>
        </span>
      </header>
      <Tabs />
      <JobLine />
      <main id="view" role="tabpanel" aria-labelledby={'tab-' + verb.value}><View /></main>
      <Help />
    </>
  );
}

function nextPhoto(by: number): void {
  const count = run.value.photos.length;
  if (count) chosenPhoto.value = (chosenPhoto.value + by + count) % count;
}

followSystem();
setLive(run.value.live === true);
document.title = `${run.value.capture?.title ?? 'Run'} – Hookeye`;
render(run.value.edit ? <Editor /> : <Page />, document.getElementById('page')!);
if (run.value.live) follow();
