// Verb 3: the ranked effects, what each would explain, and what it cannot be told from.
import {useRef} from 'preact/hooks';
import {css, sequential} from '../colours';
import type {EffectScore} from '../document';
import {saveCsv, saveSvg} from '../download';
import {figure, percent, spaced} from '../format';
import {chosenEffect, step, timelineOf} from '../state';
import {AddButton} from '../add/add';
import {cosine, together} from './order';
import {Removed} from './removed';

export function effectsNow(): EffectScore[] {
  const entry = step.value;
  return entry?.diagnosis?.effects ?? timelineOf(entry)?.diagnosis ?? [];
}
const tested = (e: EffectScore): boolean => e.testable !== false && e.evidence !== undefined;

function Confusion(props: {effects: EffectScore[]}) {
  const ref = useRef<SVGSVGElement>(null);
  const list = together(props.effects.slice(0, 12));
  const n = list.length;
  const size = 20;
  const left = 180;
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
            <text x={left - 6} y={i * size + 14} text-anchor="end" class={a.effect === chosenEffect.value ? 'strong' : ''}>{spaced(a.effect)}</text>
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
      <p class="note">Cosine between the pictures' changes: 1 (bright) cannot be told apart; dark is told apart well enough not to be listed.</p>
    </figure>
  );
}

function Detail(props: {effect: EffectScore}) {
  const e = props.effect;
  return (
    <section class="detail" aria-live="polite">
      <h3>{spaced(e.effect)} <AddButton effect={e.effect} /></h3>
      <p>{e.why ?? e.why_not}</p>
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

export function Missing() {
  const all = effectsNow();
  const ranked = all.filter(tested);
  const untestable = all.filter((e) => !tested(e));
  if (!all.length)
    return <p class="empty">This step has not been diagnosed: run <code>hookeye diagnose RUN</code>.</p>;
  const gate = Math.max(5, step.value?.diagnosis?.gate ?? 0);
  const chosen = all.find((e) => e.effect === chosenEffect.value) ?? ranked[0] ?? all[0];
  return (
    <div class="missing">
      <div class="ranking">
        <table aria-label="Ranked effects">
          <thead><tr><th>effect</th><th>would explain</th><th>evidence</th><th>weight</th><th>dof</th><th>easily taken for</th></tr></thead>
          <tbody>
            {ranked.map((e) => (
              <tr key={e.effect} class={(e.evidence ?? 0) < gate ? 'below' : ''} aria-selected={e === chosen}
                  onMouseEnter={() => (chosenEffect.value = e.effect)}>
                <td><button class="link" onClick={() => (chosenEffect.value = e.effect)}
                  onFocus={() => (chosenEffect.value = e.effect)}>{spaced(e.effect)}</button></td>
                <td class="share"><span class="track"><span class="fill" style={{width: `${100 * Math.min(1, Math.max(0, e.explains ?? 0))}%`}} /></span> {percent(e.explains)}</td>
                <td>{figure(e.evidence)}</td><td>{percent(e.weight)}</td><td>{e.dof}</td>
                <td>{(e.confused_with ?? []).map(spaced).join(', ')}</td>
              </tr>
            ))}
          </tbody>
        </table>
        <p class="note">Nothing is named below evidence {figure(gate)}: chance alone reaches it in 5 % of runs.
          <button class="quiet" onClick={() => saveCsv('effects.csv', [
            ['effect', 'testable', 'explains', 'explains_held_out', 'evidence', 'weight', 'p_value', 'dof', 'confused_with', 'why'],
            ...all.map((e) => [e.effect, tested(e), e.explains, e.explains_held_out, e.evidence, e.weight, e.p_value, e.dof,
              (e.confused_with ?? []).join(' '), e.why ?? e.why_not])])}>CSV</button></p>
        {untestable.length > 0 && (
          <details open={ranked.length < 10}>
            <summary>{untestable.length} not tested</summary>
            <ul class="untestable">{untestable.map((e) => <li key={e.effect}><b>{spaced(e.effect)}</b> {e.why_not}</li>)}</ul>
          </details>
        )}
      </div>
      <div class="side">
        {chosen && <Detail effect={chosen} />}
        <Confusion effects={ranked} />
      </div>
    </div>
  );
}
