// Verb 3: the ranked effects, what each would explain, and what it cannot be told from.
import {signal} from '@preact/signals';
import {useRef} from 'preact/hooks';
import {css, sequential, type Ramp} from '../colours';
import type {EffectScore} from '../document';
import {saveCsv, saveSvg} from '../download';
import {figure, listed, logEvidence, percent, spaced} from '../format';
import {chosenEffect, decisionAfter, effectsOf, gateOf, isNamed, step, wasTested, type Decision} from '../state';
import {AddButton} from '../add/add';
import {decidedBy, tooLittle} from '../story';
import {cosine, together} from './order';
import {Removed} from './removed';
import {Legend, Share} from '../widgets';

/** The effect under the pointer: looked at, not chosen. */
const previewed = signal('');

const cosineRamp: Ramp = {
  title: 'cosine between the changes of the pictures',
  ends: ['told apart', '', '1: cannot be'], scale: sequential, from: 0,
};

function Confusion(props: {effects: EffectScore[]; strong: string}) {
  const ref = useRef<SVGSVGElement>(null);
  const list = together(props.effects.slice(0, 12));
  const n = list.length;
  const size = 20;
  const left = 200;
  if (n < 2) return null;
  return (
    <figure class="confusion">
      <figcaption>What cannot be told apart sits together
        <button class="quiet" onClick={() => ref.current && saveSvg('confusion.png', ref.current)}>PNG</button>
        <button class="quiet" onClick={() => saveCsv('confusion.csv',
          [['', ...list.map((e) => e.effect)], ...list.map((a) => [a.effect, ...list.map((b) => (a === b ? 1 : cosine(a, b)))])])}>CSV</button>
      </figcaption>
      <svg ref={ref} viewBox={`0 0 ${left + n * size + 4} ${n * size + 4}`} role="img"
           aria-label="Cosine between the signatures of effects">
        {list.map((a, i) => (
          <g key={a.effect}>
            <text x={left - 6} y={i * size + 14} text-anchor="end" class={a.effect === props.strong ? 'strong' : ''}>{spaced(a.effect)}</text>
            {list.map((b, j) => {
              const c = i === j ? 1 : cosine(a, b);
              return (
                <rect key={b.effect} x={left + j * size} y={i * size} width={size - 1} height={size - 1} fill={css(sequential(c))}>
                  <title>{`${spaced(a.effect)} and ${spaced(b.effect)}: cosine ${c.toFixed(2)}`}</title>
                </rect>
              );
            })}
          </g>
        ))}
      </svg>
      <Legend ramp={cosineRamp} />
    </figure>
  );
}

/** `pinned`: what Add would add, whichever effect is looked at. */
function Detail(props: {effect: EffectScore; pinned: EffectScore}) {
  const e = props.effect;
  return (
    <section class="detail" aria-live="polite">
      <h3>{spaced(e.effect)} <AddButton effect={props.pinned.effect} named /></h3>
      <p>{e.why ?? e.why_not}</p>
      {(e.confused_with ?? []).length > 0 && <p>These photos hardly tell it from {listed(e.confused_with!.map(spaced))}.</p>}
      {e.predicted && e.predicted.length > 0 && (
        <table>
          <thead><tr><th>would be</th><th>value</th><th>95 % interval</th></tr></thead>
          <tbody>
            {e.predicted.slice(0, 8).map((p) => (
              <tr key={p.name}><td title={p.long_name}>{p.name}</td><td>{figure(p.value)} {p.unit}</td>
                <td>{figure(p.low)} .. {figure(p.high)}</td></tr>
            ))}
          </tbody>
        </table>
      )}
      <Removed effect={e.effect} />
    </section>
  );
}

function rankingCsv(all: EffectScore[]): void {
  saveCsv('effects.csv', [
    ['effect', 'testable', 'explains', 'explains_held_out', 'evidence', 'weight', 'p_value', 'dof', 'confused_with', 'why'],
    ...all.map((e) => [e.effect, wasTested(e), e.explains, e.explains_held_out, e.evidence, e.weight, e.p_value, e.dof,
      (e.confused_with ?? []).join(' '), e.why ?? e.why_not])]);
}

/** One effect of the ranking; what could not be tested is greyed and says why. */
function Row(props: {effect: EffectScore; pinned: boolean; named: boolean}) {
  const e = props.effect;
  const taken = e.confused_with ?? [];
  const choose = (): void => {
    chosenEffect.value = e.effect;
  };
  return (
    <tr class={!wasTested(e) ? 'below untested' : props.named ? '' : 'below'} aria-selected={props.pinned}
        onMouseEnter={() => (previewed.value = e.effect)} onClick={choose}>
      <td><button class="link" onFocus={choose}>{spaced(e.effect)}</button></td>
      {wasTested(e) ? <>
        <td class="share"><Share of={e.explains} /> {percent(e.explains)}</td>
        <td>{logEvidence(e.evidence)}</td><td>{percent(e.weight)}</td><td class="wide">{e.dof}</td>
        <td class="wide">{taken.slice(0, 2).map(spaced).join(', ')}{taken.length > 2 && ` and ${taken.length - 2} more`}</td>
      </> : <td colSpan={5}>not tested: {e.why_not}</td>}
    </tr>
  );
}

/** What was added next, and why that one: the evidence is an estimate, refits decide. */
function Decided(props: {ranked: EffectScore[]; decision: Decision; folder: string | undefined}) {
  const {ranked, decision: {added, refitted, margin}, folder} = props;
  const own = ranked.find((e) => e.effect === added);
  const next = ranked.find((e) => e !== own);
  return <p><b>{spaced(added)}</b> was added to step {folder}
    {own && `: log evidence ${logEvidence(own.evidence)}`}
    {own && next && `, ${next === ranked[0] ? 'behind' : 'before'} ${spaced(next.effect)} with ${logEvidence(next.evidence)}`}
    {margin !== undefined && `; ${decidedBy(added, refitted, margin)}`}.</p>;
}

/** What the ranking comes to, in one sentence. */
function Outcome(props: {ranked: EffectScore[]; decision: Decision | undefined}) {
  const {ranked, decision} = props;
  const folder = step.value?.folder;
  const gate = gateOf(step.value);
  if (decision) return <Decided ranked={ranked} decision={decision} folder={folder} />;
  const first = ranked.find((e) => isNamed(e, step.value)) ?? ranked[0];
  const second = ranked.find((e) => e !== first);
  const rule = `below ${figure(gate)}, which chance alone reaches in less than 5 % of runs, nothing is named`;
  if (!first) return <p>Nothing could be tested in step {folder}.</p>;
  if (isNamed(first, step.value))
    return <p><b>{spaced(first.effect)}</b> leads in step {folder} with log evidence {logEvidence(first.evidence)}
      {second && `, before ${spaced(second.effect)} with ${logEvidence(second.evidence)}`}; {rule}.</p>;
  return <p><b>Nothing stands out</b> in step {folder}: {spaced(first.effect)} leads with log evidence {logEvidence(first.evidence)}; {
    (first.evidence ?? 0) < gate ? rule : tooLittle}.</p>;
}

export function Missing() {
  const all = effectsOf(step.value);
  const ranked = all.filter(wasTested);
  if (!all.length)
    return <p class="empty">This step has not been diagnosed: run <code>hookeye diagnose RUN</code>.</p>;
  const decision = decisionAfter(step.value);
  const byName = (name: string | undefined): EffectScore | undefined => all.find((e) => e.effect === name);
  const pinned = byName(chosenEffect.value) ?? byName(decision?.added) ?? ranked[0] ?? all[0];
  return (
    <div class="missing columns">
      <div class="ranking">
        <Outcome ranked={ranked} decision={decision} />
        <table aria-label="Ranked effects" onMouseLeave={() => (previewed.value = '')}>
          <thead><tr><th>effect</th><th>would explain</th><th>evidence</th><th>weight</th><th class="wide">dof</th>
            <th class="wide">easily taken for <button class="quiet" onClick={() => rankingCsv(all)}>CSV</button></th></tr></thead>
          <tbody>
            {[...ranked, ...all.filter((e) => !wasTested(e))].map((e) => (
              <Row key={e.effect} effect={e} pinned={e === pinned} named={isNamed(e, step.value)} />
            ))}
          </tbody>
        </table>
      </div>
      <div class="side">
        {pinned && <Detail effect={byName(previewed.value) ?? pinned} pinned={pinned} />}
        <Confusion effects={ranked} strong={pinned.effect} />
      </div>
    </div>
  );
}
