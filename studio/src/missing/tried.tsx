// What was tried on a step's model, effect by effect: how far each came, by which number its way ended, what it cost.
import type {DecisionLine} from '../document';
import {figure, spaced} from '../format';
import {step} from '../state';

/** [where it was accepted, where not] */
const outcomes: Record<DecisionLine['asked'], [string, string]> = {
  named: ['stands out', 'does not stand out'],
  screened: ['screened', 'not screened further'],
  refitted: ['refitted', 'not refitted'],
  ranked: ['says most', 'says less than the best'],
  stands: ['stands', 'refused'],
  widened: ['this form was taken', 'this form was not taken'],
  dropped: ['left the model', 'stays in the model'],
  swapped: ['took its place', 'did not take its place'],
  tied: ['cannot be told from it', 'can be told from it'],
  paired: ['stand together', 'do not stand together'],
  ended: ['explained', 'not explained'],
  scored: ['best by the score in the shadow', 'not the best by it'],
};
const outcome = (one: DecisionLine): string => outcomes[one.asked][one.accepted ? 0 : 1];

/** "creep" of "creep as 'levels off'" and of "creep in place of swelling". */
const branchOf = (one: DecisionLine): string => one.candidate.split(' ')[0] || 'the search';

const cost = (lines: DecisionLine[]): string => {
  const seconds = lines.reduce((sum, one) => sum + (one.cpu_s ?? 0), 0);
  return seconds >= 0.1 ? `${figure(seconds, 2)} CPU-s` : '';
};

function Line(props: {of: DecisionLine; branch: string}) {
  const one = props.of;
  const about = one.candidate === props.branch || !one.candidate ? '' : `${one.candidate.slice(props.branch.length).trim()}: `;
  const numbers = one.value === null ? one.option
    : `${figure(one.value, 3)}${one.limit === null ? '' : ` against ${figure(one.limit, 3)}`}${one.option ? `: ${one.option}` : ''}`;
  return (
    <li class={one.accepted ? 'yes' : 'no'}>
      {about}<b>{outcome(one)}</b>: {one.why}{numbers && <span class="numbers"> ({numbers})</span>} <code>{one.where}</code>
    </li>
  );
}

export function Tried() {
  // A score that decides nothing is no branch of what was tried.
  const all = (step.value?.decisions ?? []).filter((one) => one.asked !== 'scored');
  const branches = new Map<string, DecisionLine[]>();
  for (const one of all) branches.set(branchOf(one), [...(branches.get(branchOf(one)) ?? []), one]);
  // Who did not stand out was asked nothing more.
  const open = [...branches].filter(([, lines]) => lines.some((one) => one.asked !== 'named' || one.accepted));
  if (!open.length) return null;
  const silent = branches.size - open.length;
  return (
    <section class="tried-tree">
      <h3>What was tried on this model</h3>
      {open.map(([branch, lines]) => {
        const last = lines[lines.length - 1];
        return (
          <details key={branch}>
            <summary><span class="name">{spaced(branch)}</span> <span class={last.accepted ? 'yes' : 'no'}>{outcome(last)}</span>
              {' '}<span class="note">{cost(lines)}</span></summary>
            <ol>{lines.map((one, i) => <Line key={i} of={one} branch={branch} />)}</ol>
          </details>
        );
      })}
      {silent > 0 && <p class="note">{silent} {silent === 1 ? 'effect does' : 'effects do'} not stand out.</p>}
    </section>
  );
}
