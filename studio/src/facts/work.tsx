// Where the time of the run's commands went, as `hookeye profile` tells it; and which pixels the fit has seen.
import {duration, figure} from '../format';
import {run, step} from '../state';
import type {AllPixels, CommandWork} from '../document';
import {Wide} from '../widgets';

/** Less is not worth a cell [CPU-seconds]. */
const least = 0.05;

function commandOf({first_step: first, steps}: CommandWork): string {
  if (steps === first) return `A command on step ${steps - 1}`;
  return steps === first + 1 ? `The command of step ${first}` : `The command of steps ${first} to ${steps - 1}`;
}

function sum(values: number[]): number {
  return values.reduce((all, one) => all + one, 0);
}

function WorkTable({work}: {work: CommandWork}) {
  const stages = Object.entries(work.cpu_s).filter(([, parts]) => sum(Object.values(parts)) >= least);
  const names = [...new Set(stages.flatMap(([, parts]) => Object.keys(parts)))];
  const columns = names.filter((part) => sum(stages.map(([, parts]) => parts[part] ?? 0)) >= least);
  const all = sum(stages.flatMap(([, parts]) => Object.values(parts)));
  const cell = (value: number) => (value < least ? '–' : value.toFixed(1));
  return <>
    <p>{commandOf(work)}: {duration(work.wall_s)}, {figure(all)} CPU-seconds.</p>
    <Wide label="CPU-seconds by stage and part of the work">
      <thead><tr><th>CPU-seconds</th>{columns.map((part) => <th key={part}>{part}</th>)}<th>all</th></tr></thead>
      <tbody>{stages.map(([stage, parts]) => (
        <tr key={stage}><th scope="row">{stage}</th>{columns.map((part) => <td key={part}>{cell(parts[part] ?? 0)}</td>)}<td>{cell(sum(Object.values(parts)))}</td></tr>
      ))}</tbody>
    </Wide>
  </>;
}

export function Work() {
  const commands = run.value.work ?? [];
  if (!commands.length) return null;
  return <>
    <h3>Where the time went</h3>
    {commands.map((work, i) => <WorkTable key={i} work={work} />)}
  </>;
}

/** Rows of the reporting table; none where the fit has seen all pixels of its photos. */
export function pixelRows(): [string, string][] {
  const all: AllPixels | undefined = step.value?.metrics?.all_pixels;
  if (!all) return [];
  const rows: [string, string][] = [['Pixels',
    `the fit has seen ${figure(100 * all.share)} % of ${figure(all.pixels / 1e6)} million${all.read_pixels < 0.7 * all.share * all.pixels ? ', by means of several' : ''}; intervals and pictures are of all (normalised residual ${figure(all.chi_fit, 4)} pixel by pixel)`]];
  const known = all.parameters.filter((p) => p.standard_error > 0);
  if (known.length)
    rows.push(['Pixels left out', known.map((p) => {
      const grown = Math.hypot(1, p.added_by_reading / p.standard_error) - 1;
      return `${p.name}: all of them would move it by ${figure(Math.abs(p.moved) / p.standard_error, 2)} standard errors, to leave some out adds ${figure(100 * grown, 2)} % to its standard error`;
    }).join('; ')]);
  return rows;
}
