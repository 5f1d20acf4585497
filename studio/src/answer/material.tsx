// The material's card: law, values with intervals, what they rest on; to be copied.
import type {Material, MaterialValue} from '../document';
import {saveCsv} from '../download';
import {around} from '../format';
import {run} from '../state';
import {Copy, Wide} from '../widgets';

const unknown: Record<MaterialValue['known'], string> = {fitted: '–', given: 'as given', open: 'not identifiable'};
const intervalOf = (v: MaterialValue): string =>
  v.low === undefined || v.high === undefined ? unknown[v.known] : around(v.value, v.low, v.high).interval;

/** So many values are shown; of an additive material there may be a hundred. */
const most = 12;

function Values(props: {card: Material['cards'][number]}) {
  const {card} = props;
  const few = card.parameters.length <= most;
  const rows = [...(few ? card.parameters : []), ...(card.small_strain ?? [])];
  return <>
    <Wide label={`Material ${card.region || card.law}`} class="material">
      <thead><tr><th>{card.region && `${card.region}: `}<b>{card.law}</b></th><th>value</th><th>95 % interval</th><th>unit</th></tr></thead>
      <tbody>
        {rows.map((v) => (
          <tr key={v.name}>
            <td>{v.name} <small>{v.long_name}</small></td>
            <td><b>{around(v.value, v.low, v.high).value}</b></td><td>{intervalOf(v)}</td><td>{v.unit}</td>
          </tr>
        ))}
      </tbody>
    </Wide>
    {!few && <p class="note">and {card.parameters.length} control values, which the step’s model.yaml has.</p>}
  </>;
}

const csv = (material: Material): unknown[][] => [
  ['region', 'law', 'name', 'unit', 'value', 'low', 'high', 'known', 'long_name'],
  ...material.cards.flatMap((card) => [...card.parameters, ...(card.small_strain ?? [])].map((v) =>
    [card.region, card.law, v.name, v.unit, v.value, v.low, v.high, v.known, v.long_name]))];

export function MaterialCard() {
  const {material, text} = run.value.answer;
  if (!material)
    return <><h3>Material</h3><p class="note">This run does not tell its material’s card: an earlier version made it. Its parameters stand under
      “Error falls”.</p></>;
  const yaml = material.beside.length ? `${material.yaml}  # without ${material.beside.join(', ')}` : material.yaml;
  return <>
    <h3>Material
      <Copy text={text} label="Copy as text" /><Copy text={yaml} label="Copy as yaml" />
      <button class="quiet" onClick={() => saveCsv('material.csv', csv(material))}>CSV</button></h3>
    {material.cards.map((card) => <Values key={card.region} card={card} />)}
    {material.blended && <p class="note">Moduli at small strain: of the mean over the body.</p>}
    {material.beside.length > 0 && <p class="note">The law's own values are without {material.beside.join(', ')}, which the body has too; means over the body are with it.</p>}
    {material.depends.map((sentence) => <p class="rests" key={sentence}>{sentence}.</p>)}
    {yaml.length < 400 && <code class="yaml">{yaml}</code>}
  </>;
}
