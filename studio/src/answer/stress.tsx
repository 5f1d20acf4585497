// Nominal stress of a bar of the fitted material over its stretch, with its 95 % band: solid where
// the photos saw it stretched so, dashed beyond.
import {useMemo} from 'preact/hooks';
import type {StressCurve} from '../document';
import {figure} from '../format';
import {Chart, type Line} from '../falls/chart';
import {run} from '../state';

const colours = ['#2166ac', '#b2182b', '#1a6b3c'];

/** Of a curve: its band's edges, the part that was seen, and what lies beyond with the points where
 *  they meet. */
function linesOf(curve: StressCurve, colour: string, named: boolean): Line[] {
  const [from, to] = curve.visited;
  const seen = curve.stretch.map((x) => x >= from && x <= to);
  const beyond = seen.map((own, i) => !own || seen[i - 1] === false || seen[i + 1] === false);
  const what = named ? curve.name : 'stress';
  return [
    {label: `${what}, upper`, values: curve.high, colour: colour + '66', width: 1},
    {label: what, values: curve.value.map((v, i) => (seen[i] ? v : null)), colour},
    {label: `${what}, lower`, values: curve.low, colour: colour + '66', width: 1},
    {label: `${what}, beyond`, values: curve.value.map((v, i) => (beyond[i] ? v : null)), colour, dash: [5, 5]},
  ];
}

function One(props: {curves: StressCurve[]; region: string}) {
  const {curves, region} = props;
  const first = curves[0];
  const lines = useMemo<Line[]>(() => curves.flatMap((curve, i) => linesOf(curve, colours[i], curves.length > 1)), [curves]);
  const bands = useMemo(() => curves.map((_, i): [number, number] => [4 * i + 1, 4 * i + 3]), [curves]);
  const csv = [['stretch', ...curves.flatMap((c) => ['stress', 'low', 'high'].map((v) => (curves.length > 1 ? `${c.name} ${v}` : v)))],
    ...first.stretch.map((x, i) => [x, ...curves.flatMap((c) => [c.value[i], c.low[i], c.high[i]])])];
  return <div>
    <Chart title={`Stress over stretch of a bar${region && `: ${region}`}`} file={`stress-stretch${region && `-${region}`}`} csv={csv}
           says={`Nominal stress of a bar over its stretch, with its 95 % band, from ${figure(first.stretch[0])} to ${figure(first.stretch[first.stretch.length - 1])}`}
           x={first.stretch} lines={lines} bands={bands} xLabel="stretch" yLabel={`force / rest area [${first.unit}]`} visited={first.visited} brief />
    <p class="note">Solid and shaded: stretches that the fitted photos saw, {figure(first.visited[0])} to {figure(first.visited[1])} (1 to 99 % of
      the body); dashed: beyond them, the law alone. Band: 95 %.</p>
  </div>;
}

export function StressStretch() {
  const cards = run.value.answer.material?.cards ?? [];
  return <>{cards.map((card) => card.curves && card.curves.length > 0 && <One key={card.region} curves={card.curves} region={card.region} />)}</>;
}
