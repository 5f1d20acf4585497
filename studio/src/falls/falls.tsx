// Verb 5: the error over the steps against the measured floor; parameters with their intervals.
import {useMemo} from 'preact/hooks';
import {saveCsv} from '../download';
import {around, figure} from '../format';
import {floor, floorSource, other, run, step, timelineOf} from '../state';
import {Wide} from '../widgets';
import {MeasuredTable} from '../answer/measured';
import {Chart, type Line} from './chart';
import type {EnergyCurve, ParameterValue} from '../document';

/** Parameters of the shown step and, beside them, of the one it is compared with. */
function Parameters(props: {steps: {folder: string; list: ParameterValue[]}[]}) {
  const {steps} = props;
  const names = [...new Set(steps.flatMap((s) => s.list.map((p) => p.name)))];
  return (
    <Wide label="Parameters with 95 % intervals" class="parameters">
      <thead><tr><th>parameter</th>{steps.map((s) => <th key={s.folder} colSpan={2}>{s.folder}, 95 % interval</th>)}<th>unit</th></tr></thead>
      <tbody>
        {names.map((name) => {
          const all = steps.map((s) => s.list.find((p) => p.name === name));
          const known = all.find((p) => p)!;
          return (
            <tr key={name}>
              <td>{name.split(/(?<=[._])/).map((part) => <>{part}<wbr /></>)}{known.long_name && <small>{known.long_name}</small>}</td>
              {all.map((p, i) => <Value key={i} p={p} drawn={steps.length === 1} />)}
              <td>{known.unit}</td>
            </tr>
          );
        })}
      </tbody>
    </Wide>
  );
}

function Value(props: {p: ParameterValue | undefined; drawn: boolean}) {
  const {p} = props;
  if (!p) return <><td>–</td><td /></>;
  const {value, interval} = around(p.value, p.low, p.high);
  return <><td>{p.known === 'open' ? 'somewhere' : value}</td><td>{props.drawn && <Interval p={p} />} {interval}</td></>;
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
  return <div>
    <Chart title={`Energy of ${curve.name}`} file={`energy-${curve.name}`}
           says={`Energy of ${curve.name} over ${axis}, with its 95 % band`} x={curve.stretch} lines={lines}
           bands={[[1, 3]]} xLabel={axis + other} yLabel={`energy [${curve.unit}]`} visited={curve.visited} />
    {curve.visited && <p class="note">{axis} visited (shaded): {figure(curve.visited[0])} to {figure(curve.visited[1])}
      {curve.beyond ? `; beyond the control points in ${curve.beyond} of ${curve.elements} elements` : ''}</p>}
  </div>;
}

function errorCsv(): unknown[][] {
  return [['step', 'chi_fit', 'chi_validate', 'floor', 'rms_px_fit', 'rms_px_validate'],
    ...run.value.steps.map((s) => {
      const t = timelineOf(s);
      return [s.folder, t?.chi_fit, t?.chi_validate, floor.value.chi, t?.rms_px_fit, t?.rms_px_validate];
    })];
}

export function Falls() {
  const list = run.value.steps;
  const {x, names, lines} = useMemo(() => {
    const told = list.map((s) => timelineOf(s));
    return {
      x: list.map((_, i) => i),
      names: list.map((s) => s.folder.replace(/^\d+-/, '').replaceAll('_', ' ')),
      lines: [
        {label: 'fitted photos', values: told.map((t) => t?.chi_fit ?? null), colour: '#2f7fc1', points: true},
        {label: 'held-out photos', values: told.map((t) => t?.chi_validate ?? null), colour: '#d1495b', dash: [6, 4], points: true},
        {label: `noise floor (${floorSource(floor.value.source)})`, values: list.map(() => floor.value.chi), colour: '#888888', dash: [2, 3],
          points: list.length === 1},
      ] as Line[],
    };
  }, [list, floor.value]);
  const told = [...new Set([step.value, other.value])].flatMap((entry) => {
    const list = timelineOf(entry)?.parameters;
    return entry && list ? [{folder: entry.folder, list}] : [];
  }).sort((a, b) => a.folder.localeCompare(b.folder));
  const latest = told.length ? list.find((s) => s.folder === told[told.length - 1].folder) : undefined;
  const now = timelineOf(latest ?? step.value);
  const curves = latest?.diagnosis?.energy ?? latest?.metrics?.energy ?? [];
  const lost = latest?.metrics?.ellipticity;
  return (
    <div class="falls columns">
      <section>
        {list.length > 0 && <Chart title="Residual over the steps" file="error" csv={errorCsv()} x={x} names={names} lines={lines} log tall={curves.length === 0}
               says="Normalised residual over the steps of the run, fitted and held out, against the noise floor"
               xLabel="step" yLabel="normalised residual" />}
        <div class="curves">{curves.map((curve) => <Energy key={curve.name} curve={curve} />)}</div>
        {lost && lost.elements_lost > 0 && <p class="note">The material loses ellipticity at the strains of {lost.elements_lost} elements,
          most in {lost.example}: no resistance against wrinkles or shear bands there.</p>}
      </section>
      <section>
        <h3>Parameters
          <button class="quiet" onClick={() => saveCsv('parameters.csv', [['step', 'name', 'unit', 'value', 'low', 'high'],
            ...told.flatMap((s) => s.list.map((p) => [s.folder, p.name, p.unit, p.value, p.low, p.high]))])}>CSV</button></h3>
        {told.length ? <Parameters steps={told} />
          : <p class="empty">{list.length ? 'run.json tells nothing of this step.' : 'No step is finished yet.'}</p>}
        {latest?.diagnosis?.mesh_note && <p class="note">The mesh: {latest.diagnosis.mesh_note}.</p>}
        {now?.undetermined?.map((sentence) => <p class="note" key={sentence}>{sentence}</p>)}
        {now?.converged === false && <p class="note">This fit did not converge in {now.iterations} iterations.</p>}
        <MeasuredTable all={latest?.metrics?.measured ?? []} />
      </section>
    </div>
  );
}
