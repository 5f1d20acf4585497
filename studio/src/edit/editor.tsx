// The capture in the browser: body over photos on the left, what is told of it on the right.
import {effect} from '@preact/signals';
import {useEffect} from 'preact/hooks';
import {turnTheme} from '../theme';
import {Buttons, Said} from '../widgets';
import {BodyView} from './body_view';
import {refreshBody} from './body';
import {capture, draft, faults, follow, passes, pulse, redo, refusal, saving, takeIn, undo} from './capture';
import {CaseForm} from './case_form';
import {chooseCase, form, formNames, forms, shownCase, stage, stages, type Form} from './chosen';
import {checkWords, FaultList} from './faults';
import {PhotoView} from './photo_view';
import {Pose} from './pose';
import {RegionForm} from './region_form';
import {TextPane} from './text_pane';
import './edit.css';

const views: Record<Form, () => preact.JSX.Element> = {case: CaseForm, regions: RegionForm, faults: FaultList, text: TextPane};

function FormTabs() {
  const move = (event: KeyboardEvent): void => {
    const by = {ArrowRight: 1, ArrowLeft: -1}[event.key];
    if (!by) return;
    event.preventDefault();
    form.value = forms[(forms.indexOf(form.value) + by + forms.length) % forms.length];
    document.getElementById('tab-' + form.value)?.focus();
  };
  return (
    <div class="tabs" role="tablist" aria-label="Forms" onKeyDown={move}>
      {forms.map((one) => (
        <button key={one} id={'tab-' + one} role="tab" aria-selected={one === form.value} aria-controls="form" tabIndex={one === form.value ? 0 : -1}
                onClick={() => (form.value = one)}>{formNames[one]}{one === 'faults' && faults.value.length > 0 && <span class="count">{faults.value.length}</span>}</button>))}
    </div>
  );
}

function Notices() {
  return (
    <>
      {pulse.value?.outside && (
        <p class="notice" role="alert">Another program has changed the file. Nothing is written over it.{' '}
          <button onClick={() => void takeIn()}>Take its text in</button> Undo brings back what was here.</p>)}
      {refusal.value && <p class="notice failed" role="alert"><Said text={refusal.value} /> <button class="quiet" onClick={() => (refusal.value = '')}>Close</button></p>}
      {draft.value !== null && form.value !== 'text' && <p class="notice">The text was changed and is not saved. <button onClick={() => (form.value = 'text')}>Look at it</button></p>}
    </>
  );
}

/** Outside of inputs: u and r as buttons have it, n and p for load cases. */
function keys(event: KeyboardEvent): void {
  const target = event.target as HTMLElement;
  const typedIn = target instanceof HTMLInputElement ? !/checkbox|radio|range/.test(target.type) : /SELECT|TEXTAREA/.test(target.tagName);
  const control = event.ctrlKey || event.metaKey;
  if (typedIn || event.altKey) return;
  const all = capture.value?.examples ?? [];
  const next = (by: number): void => all.length ? chooseCase(all[(all.indexOf(shownCase.value!) + by + all.length) % all.length].name) : undefined;
  if (control && event.key === 'z') void undo();
  else if (control && (event.key === 'y' || event.key === 'Z')) void redo();
  else if (control) return;
  else if (event.key === 'n' || event.key === 'p') next(event.key === 'n' ? 1 : -1);
  else if (event.key === 't') turnTheme();
  else if (/^[1-4]$/.test(event.key)) form.value = forms[Number(event.key) - 1];
  else if (event.key === 'b') stage.value = stage.value === 'photo' ? 'body' : 'photo';
  else return;
  event.preventDefault();
}

export function Editor() {
  const state = capture.value;
  useEffect(() => {
    document.addEventListener('keydown', keys);
    const leave = (event: BeforeUnloadEvent): void => void (draft.value !== null && event.preventDefault());
    window.addEventListener('beforeunload', leave);
    follow();
    const stop = effect(() => void (capture.value && refreshBody()));
    return () => {
      document.removeEventListener('keydown', keys);
      window.removeEventListener('beforeunload', leave);
      stop();
    };
  }, []);
  const Shown = views[form.value];
  return (
    <>
      <header>
        <h1 title={state?.file}>Hookeye <small>{state?.title || state?.file}</small></h1>
        <button class={'verdict-button ' + (passes.value ? 'good' : faults.value.some((one) => one.stops) ? 'bad' : '')} onClick={() => (form.value = 'faults')}>{checkWords()}</button>
        <span class="push" />
        <span class="tools">
          <span class="note" role="status">{saving.value ? 'writing …' : draft.value !== null ? 'text not saved' : 'saved'}</span>
          <button disabled={!state?.can_undo || saving.value || draft.value !== null} onClick={() => void undo()}>Undo</button>
          <button disabled={!state?.can_redo || saving.value || draft.value !== null} onClick={() => void redo()}>Redo</button>
          <button title="Dark or light (t)" aria-label="Dark or light" onClick={turnTheme}>◐</button>
        </span>
      </header>
      <Notices />
      {!state ? <main><p class="empty">Reading the capture …</p></main> : (
        <main class="editor">
          <section class="stage" aria-label="Photo and body">
            <Buttons label="What is shown" values={stages} chosen={stage} names={{photo: 'Body over photo', body: 'Body in space'}} />
            {stage.value === 'photo' ? <PhotoView /> : <BodyView />}
            {state.cameras.length > 0 && <Pose />}
          </section>
          <section class="side" aria-label="Capture">
            <FormTabs />
            <div id="form" role="tabpanel" aria-labelledby={'tab-' + form.value} class="panel-box" tabIndex={-1}><Shown /></div>
          </section>
        </main>)}
    </>
  );
}
