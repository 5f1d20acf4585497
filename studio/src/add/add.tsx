// Verb 4: add an effect, watch the refit, take it back; steps side by side.
import {figure, duration, forShell, listed, logEvidence, percent, spaced} from '../format';
import {effectsOf, gateOf, isNamed, job, other, otherStep, run, showStep, step, stepIndex, timelineOf, wasTested} from '../state';
import {Ask} from '../facts/glossary';
import {Copy, Share, Wide} from '../widgets';
import {whyNotNamed} from '../story';
import {add, busy, stop} from './job';

/** `named`: where it may stand beside another effect's name. */
export function AddButton(props: {effect: string; named?: boolean}) {
  if (!run.value.live) return null;
  return (
    <button class="primary" disabled={busy()} data-add={props.effect}
            onClick={() => void add(props.effect)}>Add{props.named && ` ${spaced(props.effect)}`}</button>
  );
}

/** Progress of the refit, under the verdict on every tab. */
export function JobLine() {
  const now = job.value;
  if (!now || now.state === 'idle') return null;
  const what = now.effect ? `${now.take_back ? 'Taking back' : 'Adding'} ${spaced(now.effect)}` : 'Refit';
  if (!busy())
    return (
      <p class={`job ${now.state}`} role="status">
        {now.state === 'done' ? `${what}: done. ${now.message ?? ''}` : now.state === 'stopped' ? `${what}: stopped; nothing was changed.` : now.message}
      </p>
    );
  const stopping = now.state === 'stopping';
  return (
    <div class={`job ${now.state}`} role="status">
      <progress max={1} value={stopping ? undefined : now.share ?? 0} aria-label={what} />
      <span>{stopping ? `Stopping: ${what.toLowerCase()}, ${now.stage ?? 'starting'}; nothing will be changed`
        : <>{what}: <b>{percent(now.share ?? 0)}</b>{now.seconds_left ? `, about ${duration(now.seconds_left)} left` : ''}
          {' · '}{now.stage ?? 'starting'}
          {now.of ? `, iteration ${now.iteration} of at most ${now.of}` : ''}
          {now.chi ? `, residual ${figure(now.chi, 4)}` : ''}
          {now.seconds !== undefined ? `, ${duration(now.seconds)} so far` : ''}</>}
      </span>
      <button disabled={stopping} onClick={() => void stop()}>{stopping ? 'Stopping …' : 'Stop'}</button>
    </div>
  );
}

function Steps() {
  const {steps} = run.value.timeline;
  const stands = new Set(steps[steps.length - 1]?.effects);
  // of an effect that was added twice the newest is taken back
  const newest = new Map(run.value.steps.map((entry) => [timelineOf(entry)?.added, entry.folder]));
  return (
    <Wide label="Steps of the run" class="steps">
      <thead><tr><th>step</th><th>residual<Ask word="chi" /></th><th>held out<Ask word="heldOut" /></th><th>off by [px]</th><th>show</th><th>against</th><th /></tr></thead>
      <tbody>
        {run.value.steps.map((entry, i) => {
          const t = timelineOf(entry);
          const others = t?.dropped?.filter((name) => name !== t.added) ?? [];
          return (
            <tr key={entry.folder} aria-selected={i === stepIndex.value}>
              <td>{entry.folder}{others.length > 0 && `, without ${listed(others)}`}</td>
              <td>{figure(t?.chi_fit, 4)}</td><td>{figure(t?.chi_validate, 4)}</td><td>{figure(t?.rms_px_fit)}</td>
              <td><input type="radio" name="show" aria-label={`show ${entry.folder}`} checked={i === stepIndex.value}
                onChange={() => showStep(i)} /></td>
              <td><input type="radio" name="against" aria-label={`compare with ${entry.folder}`} checked={i === otherStep.value}
                onClick={() => (otherStep.value = otherStep.value === i ? -1 : i)} onChange={() => undefined} /></td>
              <td>{run.value.live && t?.added && stands.has(t.added) && newest.get(t.added) === entry.folder && (
                <button disabled={busy()} onClick={() => void add(t.added!, true)}>Take back</button>
              )}</td>
            </tr>
          );
        })}
      </tbody>
    </Wide>
  );
}

function Difference() {
  const entries = [other.value, step.value].sort((x, y) => (x?.folder ?? '').localeCompare(y?.folder ?? ''));
  const [a, b] = entries.map(timelineOf);
  if (!a || !b || a === b) return <p class="note">Choose a step under “against” to compare it with the shown one, here and in Compare.</p>;
  const names = [...new Set([...a.parameters, ...b.parameters].map((p) => p.name))];
  return (
    <Wide label="Parameters of the two steps">
      <thead><tr><th>parameter</th>{entries.map((entry) => <th key={entry!.folder}>{entry!.folder}</th>)}<th>unit</th></tr></thead>
      <tbody>
        {names.map((name) => {
          const [x, y] = [a, b].map((t) => t.parameters.find((p) => p.name === name));
          return <tr key={name}><td>{name}</td><td>{figure(x?.value, 4)}</td><td>{figure(y?.value, 4)}</td><td>{x?.unit ?? y?.unit}</td></tr>;
        })}
      </tbody>
    </Wide>
  );
}

export function Add() {
  // An effect is always added to the newest step, whichever is looked at.
  const newest = run.value.steps[run.value.steps.length - 1];
  const offered = effectsOf(newest).filter(wasTested).filter((e, i) => i < 10 || isNamed(e, newest));
  const standsOut = offered.some((e) => isNamed(e, newest));
  return (
    <div class="add columns">
      <section>
        <h3>Add an effect to {newest?.folder ?? 'the newest step'}</h3>
        {!run.value.live && <p class="note">This is a report. To add with one click, run <code>hookeye studio {forShell(run.value.run)}</code>; or copy a command.</p>}
        {offered.length === 0 && <p class="empty">The newest step has not been diagnosed yet.</p>}
        {standsOut && <p class="note">Named only above a log Bayes factor of {figure(gateOf(newest))}<Ask word="gate" />{
          offered.some((e) => !isNamed(e, newest)) && '; what is grey is not named'}.</p>}
        {offered.length > 0 && !standsOut && <p>Nothing stands out any more. {spaced(offered[0].effect)} leads, and is not
          named: {whyNotNamed(offered[0], newest)}<Ask word="gate" />.</p>}
        <ul class="offers">
          {offered.map((e) => (
            <li key={e.effect} class={isNamed(e, newest) ? '' : 'below'}>
              <span class="name">{spaced(e.effect)}</span>
              <Share of={e.explains} />
              <span class="value" title={isNamed(e, newest) ? undefined : whyNotNamed(e, newest)}>log BF {logEvidence(e.evidence)}</span>
              {run.value.live ? <AddButton effect={e.effect} /> : (
                <Copy text={`hookeye add ${forShell(run.value.run)} ${e.effect}`} label="Copy command" />
              )}
            </li>
          ))}
        </ul>
      </section>
      <section>
        <h3>Steps</h3>
        <Steps />
        <Difference />
      </section>
    </div>
  );
}
