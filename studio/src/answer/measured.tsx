// Measured forces, moments and positions against the model's, component by component.
import type {Measured} from '../document';
import {saveCsv} from '../download';
import {figure} from '../format';
import {savePairs} from '../pictures';
import {run, units} from '../state';
import {Wide} from '../widgets';

const words: Record<string, string> = {force_on: 'force on', moment_on: 'moment on', position_of: 'position of'};

export function unitOf(m: Measured): string {
  const {length, force} = units.value;
  return m.unit ?? (m.kind === 'force_on' ? force : m.kind === 'moment_on' ? `${force} ${length}` : length);
}
const nameOf = (m: Measured): string => `${m.example}: ${m.words ?? words[m.kind] ?? m.kind} ${m.region}`;
/** Standard deviation of a component: one told for all, or each its own. */
const sigmaOf = (m: Measured, k: number): number => (Array.isArray(m.sigma) ? m.sigma[k] : m.sigma);
const heldOut = (m: Measured): boolean => run.value.capture?.examples.find((e) => e.name === m.example)?.use === 'validate';

function measuredCsv(all: Measured[]): void {
  saveCsv('measured.csv', [
    ['example', 'kind', 'region', 'unit', 'component', 'sigma', 'measured', 'model'],
    ...all.flatMap((m) => m.measured.map((value, k) => [m.example, m.kind, m.region, unitOf(m), m.measured.length > 1 ? componentOf(m, k) : '', sigmaOf(m, k), value, m.predicted[k]]))]);
}

export function MeasuredTable(props: {all: Measured[]}) {
  const {all} = props;
  if (!all.length) return null;
  const three = (v: number[]): string => v.map((c) => figure(c)).join(', ');
  return (
    <Wide label="Measured forces and positions">
      <thead><tr><th>measured <button class="quiet" onClick={() => measuredCsv(all)}>CSV</button></th>
        <th>value</th><th>σ</th><th>model</th><th>unit</th><th>off by [σ]</th></tr></thead>
      <tbody>
        {all.map((m, i) => (
          <tr key={i}><td>{nameOf(m)}{heldOut(m) && ' (held out)'}</td><td>{three(m.measured)}</td><td>{Array.isArray(m.sigma) ? three(m.sigma) : figure(m.sigma)}</td>
            <td>{three(m.predicted)}</td><td>{unitOf(m)}</td><td>{three(m.over_sigma)}</td></tr>
        ))}
      </tbody>
    </Wide>
  );
}

export interface Pair {
  name: string;
  measured: number;
  half: number;
  model: number;
}

/** Each component on one scale from the least to the most: measured with its 95 %, and the model's. */
function Pairs(props: {title: string; unit: string; pairs: Pair[]}) {
  const {title, unit, pairs} = props;
  const ends = pairs.flatMap((p) => [p.measured - p.half, p.measured + p.half, p.model, 0]);
  const [low, high] = [Math.min(...ends), Math.max(...ends)];
  const at = (v: number): string => `${(100 * (v - low)) / (high - low || 1)}%`;
  return (
    <section class="pairs">
      <h3>{title} [{unit}]
        <button class="quiet" onClick={() => savePairs(`${title.replace(/[^a-z]+/gi, '-')}.png`, `${title} [${unit}]`, pairs)}>PNG</button></h3>
      <dl>
        {pairs.map((p) => (
          <div key={p.name}>
            <dt title={p.name}>{p.name}</dt>
            <dd>
              <span class="range">
                <span class="zero" style={{left: at(0)}} />
                <span class="whisker" style={{left: at(p.measured - p.half), width: `${(100 * 2 * p.half) / (high - low || 1)}%`}} />
                <span class="measured-at" style={{left: at(p.measured)}} />
                <span class="model-at" style={{left: at(p.model)}} />
              </span>
              <span class="value">{figure(p.measured)} / {figure(p.model)}</span>
            </dd>
          </div>
        ))}
      </dl>
      <p class="note"><span class="key measured-at" /> measured, with ± 1.96 σ · <span class="key model-at" /> model</p>
    </section>
  );
}

/** One chart a kind: forces, moments and positions have units of their own. */
const titles: Record<string, string> = {
  force_on: 'Measured and predicted forces', moment_on: 'Measured and predicted moments', position_of: 'Measured and predicted positions',
  travel_of: 'Measured and predicted travels', rotation_of: 'Measured and predicted rotations',
  strain_of: 'Measured and predicted strains',
};

/** A sensor of the user's own is a kind of its own, by its name. */
function groupsOf(all: Measured[]) {
  const sensors = [...new Set(all.filter((m) => m.kind === 'sensor').map((m) => m.region))];
  return [...Object.keys(titles).map((kind) => ({title: titles[kind], own: all.filter((m) => m.kind === kind)})),
    ...sensors.map((name) => ({title: `Measured and predicted: ${name}`, own: all.filter((m) => m.kind === 'sensor' && m.region === name)}))];
}

const componentOf = (m: Measured, k: number) => (m.kind === 'sensor' ? String(k + 1) : 'xyz'[k]);

export function MeasuredForces() {
  const newest = run.value.steps[run.value.steps.length - 1];
  const all = newest?.metrics?.measured ?? [];
  if (!all.length) {
    const told = (run.value.capture?.examples ?? []).some((e) => e.loads.length > 0);
    return <p class="note unmeasured">No force was measured in this capture{told
      ? ': its forces are prescribed, and the model meets them exactly'
      : ', and none is prescribed: the photos fix only ratios of stiffness'}.</p>;
  }
  return (
    <div>
      {groupsOf(all).map(({title, own}) => {
        const pairs = own.flatMap((m) => m.measured.map((value, k): Pair => (
          {name: `${m.example} ${m.region} ${m.measured.length > 1 ? componentOf(m, k) : ''}`.replace('  ', ' ').trim(), measured: value, half: 1.96 * sigmaOf(m, k), model: m.predicted[k]})));
        return own.length > 0 && <Pairs key={title} title={title} unit={unitOf(own[0])} pairs={pairs} />;
      })}
    </div>
  );
}
