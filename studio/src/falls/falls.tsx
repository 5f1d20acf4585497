// Verb 5: the error over the steps against the measured floor; parameters with their intervals.
import {useMemo, useRef} from 'preact/hooks';
import {saveCanvas, saveCsv} from '../download';
import {figure} from '../format';
import {floor, run, step, stepIndex, timelineOf} from '../state';
import {Chart, type Line} from './chart';
import type {EnergyCurve, ParameterValue} from '../document';

function Parameters(props: {list: ParameterValue[]}) {
  return (
    <table class="parameters" aria-label="Parameters with 95 % intervals">
      <thead><tr><th>parameter</th><th>value</th><th>95 % interval</th><th>unit</th></tr></thead>
      <tbody>
        {props.list.map((p) => (
          <tr key={p.name}>
            <td title={p.long_name}>{p.name}</td><td>{figure(p.value, 4)}</td>
            <td><Interval p={p} /> {figure(p.low)} .. {figure(p.high)}</td><td>{p.unit}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** The interval on a scale of +-20 % about the value; an arrow where it goes on. */
function Interval(props: {p: ParameterValue}) {
  const {value, low, high} = props.p;
  if (low === undefined || high === undefined || !Number.isFinite(low) || !Number.isFinite(high)) return null;
  const span = 0.2 * Math.max(Math.abs(value), 1e-12);
  const at = (v: number): number => 30 + 28 * Math.min(1, Math.max(-1, (v - value) / span));
  return (
    <svg class="interval" viewBox="0 0 60 10" width="60" height="10" aria-hidden="true">
      <line x1={at(low)} x2={at(high)} y1="5" y2="5" /><circle cx="30" cy="5" r="2.5" />
    </svg>
  );
}

function Energy(props: {curve: EnergyCurve}) {
  const {curve} = props;
  const lines = useMemo<Line[]>(() => [
    {label: 'upper', values: curve.high, colour: '#2166ac66'},
    {label: 'energy', values: curve.value, colour: '#2166ac'},
    {label: 'lower', values: curve.low, colour: '#2166ac66'},
  ], [curve]);
  const axis = curve.axis ?? 'stretch';
  const other = Object.entries(curve.at ?? {}).map(([name, value]) => `, ${name} = ${figure(value)}`).join('');
  return <div class="energy">
    <h3>Energy of {curve.name}, with its 95 % band</h3>
    <div class="chart-box">
      <Chart title={`Energy of ${curve.name} over ${axis}, with its 95 % band`} x={curve.stretch} lines={lines}
             bands={[[1, 3]]} xLabel={axis + other} yLabel={`energy [${curve.unit}]`} visited={curve.visited} />
    </div>
    {curve.visited && <p class="note">{axis} visited (shaded): {figure(curve.visited[0])} to {figure(curve.visited[1])}
      {curve.beyond ? `; beyond the control points in ${curve.beyond} of ${curve.elements} elements` : ''}</p>}
  </div>;
}

export function Falls() {
  const box = useRef<HTMLDivElement>(null);
  const list = run.value.steps;
  const {x, names, lines} = useMemo(() => {
    const told = list.map((s) => timelineOf(s));
    return {
      x: list.map((_, i) => i),
      names: list.map((s) => s.folder.replace(/^\d+-/, '').replaceAll('_', ' ')),
      lines: [
        {label: 'χ fitted photos', values: told.map((t) => t?.chi_fit ?? null), colour: '#2f7fc1', points: true},
        {label: 'χ held-out photos', values: told.map((t) => t?.chi_validate ?? null), colour: '#d1495b', dash: [6, 4], points: true},
        {label: `floor (${floor.value.source})`, values: list.map(() => floor.value.chi), colour: '#888888', dash: [2, 3]},
      ] as Line[],
    };
  }, [list, floor.value]);
  const now = timelineOf(step.value);
  const curves = step.value?.metrics?.energy ?? [];
  return (
    <div class="falls">
      <section>
        <h3>Misfit over the steps
          <button class="quiet" onClick={() => saveCsv('error.csv', [['step', 'chi_fit', 'chi_validate', 'floor', 'rms_px_fit', 'rms_px_validate'],
            ...list.map((s) => {
              const t = timelineOf(s);
              return [s.folder, t?.chi_fit, t?.chi_validate, floor.value.chi, t?.rms_px_fit, t?.rms_px_validate];
            })])}>CSV</button>
          <button class="quiet" onClick={() => {
            const canvas = box.current?.querySelector('canvas');
            if (canvas) saveCanvas('error.png', canvas);
          }}>PNG</button>
        </h3>
        <div ref={box} class="chart-box">
          <Chart title="Misfit chi over the steps of the run, fitted and held out, against the noise floor"
                 x={x} names={names} lines={lines} xLabel="step" yLabel="χ, residual over noise" log />
        </div>
        {curves.map((curve) => <Energy key={curve.name} curve={curve} />)}
      </section>
      <section>
        <h3>Parameters of {list[stepIndex.value]?.folder ?? 'no step'}
          <button class="quiet" onClick={() => saveCsv('parameters.csv', [['name', 'unit', 'value', 'low', 'high'],
            ...(now?.parameters ?? []).map((p) => [p.name, p.unit, p.value, p.low, p.high])])}>CSV</button></h3>
        {now ? <Parameters list={now.parameters} /> : <p class="empty">run.json tells nothing of this step.</p>}
        {step.value?.diagnosis?.mesh_note && <p class="note">{step.value.diagnosis.mesh_note}</p>}
        {now?.undetermined?.map((sentence) => <p class="note" key={sentence}>{sentence}</p>)}
        {now?.converged === false && <p class="note">This fit did not converge in {now.iterations} iterations.</p>}
        <Measured />
      </section>
    </div>
  );
}

function Measured() {
  const all = step.value?.metrics?.measured ?? [];
  if (!all.length) return null;
  const three = (v: number[]): string => v.map((c) => figure(c)).join(', ');
  return (
    <table aria-label="Measured forces and positions">
      <thead><tr><th>measured</th><th>value</th><th>model</th><th>over σ</th></tr></thead>
      <tbody>
        {all.map((m, i) => (
          <tr key={i}><td>{m.example}: {m.kind.replace('_', ' ')} {m.region}</td><td>{three(m.measured)}</td>
            <td>{three(m.predicted)}</td><td>{three(m.over_sigma)}</td></tr>
        ))}
      </tbody>
    </table>
  );
}
