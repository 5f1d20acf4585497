// Verb 3: the ranked effects, what each would explain, and what it cannot be told from.
import {signal} from '@preact/signals';
import type {EffectScore} from '../document';
import {saveCsv} from '../download';
import {figure, listed, logEvidence, percent, spaced} from '../format';
import {chosenEffect, decisionAfter, effectsOf, gateOf, isNamed, step, wasTested, type Decision} from '../state';
import {AddButton} from '../add/add';
import {Ask} from '../facts/glossary';
import {bothOf, decidedBy, triedBy, whyNotNamed} from '../story';
import {Confusion} from './confusion';
import {FreeForm} from './free_form';
import {Removed} from './removed';
import {Tried} from './tried';
import {Share, Wide} from '../widgets';

/** The effect under the pointer: looked at, not chosen. */
const previewed = signal('');

/** `pinned`: what Add would add, whichever effect is looked at. */
function Detail(props: {effect: EffectScore; pinned: EffectScore}) {
  const e = props.effect;
  return (
    <section class="detail" aria-live="polite">
      <h3>{spaced(e.effect)} <AddButton effect={props.pinned.effect} named /></h3>
      <p>{e.why ?? e.why_not}</p>
      {e.why_not_named && <p class="note">Not named: {e.why_not_named}<Ask word="gate" />.</p>}
      {(e.confused_with ?? []).length > 0 && <p>These photos hardly tell it from {listed(e.confused_with!.map(spaced))}.</p>}
      {e.predicted && e.predicted.length > 0 && (
        <Wide label="Parameters it would have">
          <thead><tr><th>would be</th><th>value</th><th>95 % interval</th></tr></thead>
          <tbody>
            {e.predicted.slice(0, 8).map((p) => (
              <tr key={p.name}><td title={p.long_name}>{p.name}</td><td>{figure(p.value)} {p.unit}</td>
                <td>{figure(p.low)} .. {figure(p.high)}</td></tr>
            ))}
          </tbody>
        </Wide>
      )}
      {wasTested(e) && <Removed effect={e.effect} />}
    </section>
  );
}

function rankingCsv(all: EffectScore[], tried: Decision['tried']): void {
  saveCsv('effects.csv', [
    ['effect', 'testable', 'explains', 'explains_held_out', 'evidence', 'weight', 'p_value', 'dof', 'tried_chi_fit', 'tried_chi_validate', 'confused_with', 'why'],
    ...all.map((e) => [e.effect, wasTested(e), e.explains, e.explains_held_out, e.evidence, e.weight, e.p_value, e.dof,
      tried.find((t) => t.effect === e.effect)?.fitted, tried.find((t) => t.effect === e.effect)?.heldOut,
      (e.confused_with ?? []).join(' '), e.why ?? e.why_not])]);
}

/** One effect of the ranking; what could not be tested is greyed and says why. */
function Row(props: {effect: EffectScore; pinned: boolean; named: boolean; tried: Decision['tried']}) {
  const e = props.effect;
  const taken = e.confused_with ?? [];
  const own = props.tried.find((t) => t.effect === e.effect);
  const choose = (): void => {
    chosenEffect.value = e.effect;
  };
  const clicked = (): void => {
    choose();
    // On a phone what is told of it stands below the whole table.
    if (matchMedia('(max-width: 900px)').matches) document.querySelector('.detail')?.scrollIntoView();
  };
  return (
    <tr class={!wasTested(e) ? 'below untested' : props.named ? '' : 'below'} aria-selected={props.pinned}
        onMouseEnter={() => (previewed.value = e.effect)} onClick={clicked}>
      <td><button class="link" onFocus={choose}>{spaced(e.effect)}</button></td>
      {wasTested(e) ? <>
        <td class="share"><Share of={e.explains} /> {percent(e.explains)}</td>
        <td>{logEvidence(e.evidence)}</td><td>{percent(e.weight)}</td>
        {props.tried.length > 0 && <td class="wide tried">{own ? bothOf(own) : '–'}</td>}
        <td class="wide">{e.dof}</td>
        <td class="wide">{taken.slice(0, 1).map(spaced).join(', ')}{taken.length > 1 && ` +${taken.length - 1}`}</td>
      </> : <td colSpan={6}>not tested: {e.why_not}</td>}
    </tr>
  );
}

/** What was added next, and why that one: the evidence is an estimate, refits decide. */
function Decided(props: {ranked: EffectScore[]; decision: Decision; folder: string | undefined}) {
  const {ranked, decision, folder} = props;
  const {added, refitted, margin} = decision;
  const own = ranked.find((e) => e.effect === added);
  const next = ranked.find((e) => e !== own);
  return <p><b>{spaced(added)}</b> was added to step {folder}
    {own && `: log Bayes factor ${logEvidence(own.evidence)}`}
    {own && next && `, ${next === ranked[0] ? 'behind' : 'before'} ${spaced(next.effect)} with ${logEvidence(next.evidence)}`}
    {triedBy(decision) && <>; {triedBy(decision)}<Ask word="tried" /></>}
    {margin !== undefined && <>; {decidedBy(added, refitted, margin)}<Ask word="refit" /></>}.</p>;
}

/** What the ranking comes to, in one sentence. */
function Outcome(props: {ranked: EffectScore[]; decision: Decision | undefined}) {
  const {ranked, decision} = props;
  const folder = step.value?.folder;
  const gate = gateOf(step.value);
  if (decision) return <Decided ranked={ranked} decision={decision} folder={folder} />;
  const first = ranked.find((e) => isNamed(e, step.value)) ?? ranked[0];
  const second = ranked.find((e) => e !== first);
  const rule = `critical value ${figure(gate)}`;
  if (!first) return <p>Nothing could be tested in step {folder}.</p>;
  if (isNamed(first, step.value))
    return <p><b>{spaced(first.effect)}</b> leads in step {folder} with a log Bayes factor of {logEvidence(first.evidence)}
      {second && `, before ${spaced(second.effect)} with ${logEvidence(second.evidence)}`}; {rule}<Ask word="gate" />.</p>;
  return <p><b>Nothing stands out</b> in step {folder}. {spaced(first.effect)} leads, and is not named: {
    whyNotNamed(first, step.value)}<Ask word="gate" />.</p>;
}

export function Missing() {
  const all = effectsOf(step.value);
  const ranked = all.filter(wasTested);
  if (!all.length)
    return step.value?.fields['free_form']
      ? <div class="missing"><p>No effect of the catalogue was tried.</p><FreeForm /></div>
      : <p class="empty">This step has not been diagnosed: run <code>hookeye diagnose RUN</code>.</p>;
  const decision = decisionAfter(step.value);
  const tried = decision?.tried ?? [];
  const byName = (name: string | undefined): EffectScore | undefined => all.find((e) => e.effect === name);
  const pinned = byName(chosenEffect.value) ?? byName(decision?.added) ?? ranked[0] ?? all[0];
  return (
    <div class="missing columns">
      <div class="ranking" onMouseLeave={() => (previewed.value = '')}>
        <Outcome ranked={ranked} decision={decision} />
        <Wide label="Ranked effects">
          <thead><tr><th>effect <button class="quiet" onClick={() => rankingCsv(all, tried)}>CSV</button></th><th>would remove<Ask word="explains" /></th>
            <th>log BF<Ask word="evidence" /></th><th>weight<Ask word="weight" /></th>
            {tried.length > 0 && <th class="wide">screening<Ask word="tried" /></th>}<th class="wide">dof<Ask word="dof" /></th>
            <th class="wide">confused with</th></tr></thead>
          <tbody>
            {[...ranked, ...all.filter((e) => !wasTested(e))].map((e) => (
              <Row key={e.effect} effect={e} pinned={e === pinned} named={isNamed(e, step.value)} tried={tried} />
            ))}
          </tbody>
        </Wide>
        <Tried />
      </div>
      <div class="side">
        <FreeForm />
        {pinned && <Detail effect={byName(previewed.value) ?? pinned} pinned={pinned} />}
        <Confusion effects={ranked} strong={pinned.effect} />
      </div>
    </div>
  );
}
