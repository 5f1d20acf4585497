// Where the misfit sits: by load case, camera, region and strain level.
import {useEffect, useState} from 'preact/hooks';
import type {StepEntry} from '../document';
import {Ask} from '../facts/glossary';
import {floor, floorSource} from '../state';
import {Bars, type Row} from '../widgets';
import {examplesOf, readable} from './surface';

interface Sum {
  squares: number;
  count: number;
}
const rootMean = (sum: Sum): number => (sum.count > 0 ? Math.sqrt(sum.squares / sum.count) : NaN);

/** Strain levels: edges at equal shares of the nodes would hide the few that are stretched most. */
function strainRows(pairs: [number, number][]): Row[] {
  const largest = Math.max(...pairs.map((p) => p[0]), 1e-9);
  const bins: Sum[] = Array.from({length: 5}, () => ({squares: 0, count: 0}));
  for (const [strain, r] of pairs) {
    const bin = bins[Math.min(4, Math.floor((5 * strain) / largest))];
    bin.squares += r * r;
    bin.count += 1;
  }
  return bins.map((bin, i) => ({
    name: `${((100 * largest * i) / 5).toFixed(0)}–${((100 * largest * (i + 1)) / 5).toFixed(0)} %`,
    value: rootMean(bin),
    note: `${bin.count} nodes`,
  }));
}

async function fieldRows(step: StepEntry): Promise<{regions: Row[]; strains: Row[]}> {
  const regions = new Map<string, Sum>();
  const pairs: [number, number][] = [];
  for (const s of (await readable(step, examplesOf(step))).all.values()) {
    for (const [name, nodes] of Object.entries(s.regions)) {
      const sum = regions.get(name) ?? {squares: 0, count: 0};
      for (const node of nodes) {
        const r = s.scalars.residual[node];
        if (Number.isFinite(r)) {
          sum.squares += r * r;
          sum.count += 1;
        }
      }
      regions.set(name, sum);
    }
    s.scalars.residual.forEach((r, i) => {
      if (Number.isFinite(r)) pairs.push([Math.abs(s.scalars.strain[i]), r]);
    });
  }
  return {
    regions: [...regions].map(([name, sum]) => ({name, value: rootMean(sum)})),
    strains: pairs.length ? strainRows(pairs) : [],
  };
}

export function FailureBars(props: {step: StepEntry}) {
  const [fields, setFields] = useState<{regions: Row[]; strains: Row[]} | null>(null);
  useEffect(() => {
    let current = true;
    void fieldRows(props.step).then((value) => current && setFields(value), () => undefined);
    return () => {
      current = false;
    };
  }, [props.step]);
  const metrics = props.step.metrics;
  const rows = (table: Record<string, number> | undefined): Row[] =>
    Object.entries(table ?? {}).map(([name, value]) => ({name, value}));
  const all: [string, Row[]][] = [
    ['residual by load case', rows(metrics?.chi_by_example)],
    ['residual by camera', rows(metrics?.chi_by_camera)],
    metrics?.chi_by_region
      ? ['residual by region of the surface', rows(metrics.chi_by_region)]
      : ['residual [σ] by region', fields?.regions ?? []],
    ['residual [σ] by strain level', fields?.strains ?? []],
  ];
  return (
    <div class="failure-bars">
      {all.map(([title, list]) => list.length > 0 && (
        <Bars key={title} title={title} rows={list} mark={floor.value.chi} />
      ))}
      <p class="note">Normalised residuals<Ask word="chi" />. The line is the noise floor, {floor.value.chi.toFixed(2)}, from {floorSource(floor.value.source)}<Ask word="floor" />.</p>
    </div>
  );
}
