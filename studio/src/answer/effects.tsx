// What was added to the model: each effect's numbers with their intervals.
import type {FoundEffect} from '../document';
import {saveCsv} from '../download';
import {around, spaced} from '../format';
import {run} from '../state';
import {Said, Wide} from '../widgets';

/** So many values are shown; a field may have a hundred. */
const most = 12;

function Values(props: {found: FoundEffect}) {
  const {effect, says, values} = props.found;
  return <>
    {says && <p class="note"><Said text={`${spaced(effect)}: ${says}`} />.</p>}
    {values.length <= most
      ? <Wide label={`Values of ${spaced(effect)}`} class="found-values">
          <thead><tr><th><b>{spaced(effect)}</b></th><th>value</th><th>95 % interval</th><th>unit</th></tr></thead>
          <tbody>
            {values.map((v) => {
              const told = around(v.value, v.low, v.high);
              return (
                <tr key={v.name}>
                  <td>{v.factor ? v.long_name : <>{v.name} <small>{v.long_name}</small></>}</td>
                  <td><b>{v.known === 'open' ? 'somewhere' : told.value}</b></td><td>{told.interval}</td><td>{v.unit || (v.factor ? 'times' : '')}</td>
                </tr>);
            })}
          </tbody>
        </Wide>
      : <p class="note">Its {values.length} values stand in the CSV and in the step’s model.yaml.</p>}
  </>;
}

export function FoundEffects() {
  const all = run.value.answer.effects ?? [];
  if (!all.length) return null;
  const csv = [['effect', 'name', 'long_name', 'unit', 'value', 'low', 'high'],
    ...all.flatMap((one) => one.values.map((v) => [one.effect, v.name, v.long_name, v.unit, v.value, v.low, v.high]))];
  return <>
    <h3>Added to the model
      <button class="quiet" onClick={() => saveCsv('effects.csv', csv)}>CSV</button></h3>
    {all.map((found) => <Values key={found.effect} found={found} />)}
  </>;
}
