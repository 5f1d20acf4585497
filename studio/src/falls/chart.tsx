// A line chart by uPlot in the page's colours, with its title and its files.
import {useEffect, useRef} from 'preact/hooks';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import {saveCsv} from '../download';
import {figure} from '../format';
import {saveChart} from '../pictures';
import {theme} from '../state';

export interface Line {
  label: string;
  values: (number | null)[];
  colour: string;
  dash?: number[];
  points?: boolean;
  width?: number;
}
/** Whether names stand side by side under the axis; else numbers do, and the names are in the legend. */
const fit = (u: uPlot, names: string[]): boolean =>
  7.5 * Math.max(...names.map((name) => name.length)) < u.width / (names.length + 0.4);

export function Chart(props: {
  title: string;
  /** What it shows, for those who do not see it. */
  says: string;
  /** Name of its files. */
  file: string;
  csv?: unknown[][];
  x: number[];
  names?: string[];
  lines: Line[];
  bands?: [number, number][];
  xLabel: string;
  yLabel: string;
  log?: boolean;
  tall?: boolean;
  visited?: [number, number];  // shaded along x: where the data are
  brief?: boolean;  // without a legend: its lines are told elsewhere
}) {
  const ref = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const box = ref.current!;
    const style = getComputedStyle(document.body);
    const ink = style.getPropertyValue('--ink').trim() || '#222';
    const faint = style.getPropertyValue('--line').trim() || '#ccc';
    const size = (): {width: number; height: number} => ({
      width: Math.max(200, box.clientWidth),
      // uPlot's legend stands below its canvas
      height: Math.max(140, box.clientHeight - (props.brief ? 0 : box.querySelector('.u-legend')?.clientHeight ?? 30) - 4),
    });
    const axis = {stroke: ink, grid: {stroke: faint, width: 1}, ticks: {stroke: faint, width: 1}};
    const names = props.names;
    const plot = new uPlot(
      {
        ...size(),
        legend: {show: !props.brief},
        pxAlign: 0,  // whole pixels would give smooth curves corners
        scales: {x: {time: false, range: names ? [-0.3, names.length - 0.7] : undefined}, y: {distr: props.log ? 3 : 1}},
        axes: [
          {...axis, label: props.xLabel, labelSize: 22, size: 34, ...(names && {
            splits: () => props.x, values: (u: uPlot, at: number[]) => at.map((i) => (fit(u, names) ? names[i] : names[i] && `${i}`) ?? ''),
          })},
          {...axis, label: props.yLabel, labelSize: 22, size: 64,
            values: (_, at) => at.map((v: number | null) => (v == null ? '' : figure(v)))},
        ],
        series: [
          {label: props.xLabel, value: names ? (_, v) => names[v] ?? '–' : undefined},
          ...props.lines.map((line) => ({
            label: line.label,
            stroke: line.colour,
            width: line.width ?? 2,
            dash: line.dash,
            points: {show: line.points ?? false, size: 8, fill: line.colour},
            value: (_: uPlot, v: number | null | undefined) => (v == null ? '–' : v.toPrecision(4)),
          })),
        ],
        hooks: {
          ready: props.brief ? [] : [(u) => u.setLegend({idx: props.x.length - 1})],  // figures before anything is pointed at
          drawClear: props.visited ? [(u) => {
            const [from, to] = props.visited!.map((v) => u.valToPos(v, 'x', true));
            u.ctx.save();
            u.ctx.globalAlpha = 0.35;
            u.ctx.fillStyle = faint;
            u.ctx.fillRect(from, u.bbox.top, to - from, u.bbox.height);
            u.ctx.restore();
          }] : [],
        },
        bands: props.bands?.map((series) => ({series, fill: '#2166ac44'})),
      },
      [props.x, ...props.lines.map((line) => line.values)] as uPlot.AlignedData,
      box,
    );
    plot.setSize(size());
    const watch = new ResizeObserver(() => plot.setSize(size()));
    watch.observe(box);
    return () => {
      watch.disconnect();
      plot.destroy();
    };
  }, [props.x, props.lines, theme.value]);
  const csv = props.csv ?? [[props.xLabel, ...props.lines.map((line) => line.label)],
    ...props.x.map((x, i) => [x, ...props.lines.map((line) => line.values[i])])];
  return (
    <section class={props.tall ? 'chart-box tall' : 'chart-box'}>
      <h3>{props.title}
        <button class="quiet" onClick={() => saveCsv(`${props.file}.csv`, csv)}>CSV</button>
        <button class="quiet" onClick={() => {
          const canvas = ref.current?.querySelector('canvas');
          if (canvas) saveChart(`${props.file}.png`, props.title, canvas, props.lines);
        }}>PNG</button>
      </h3>
      <div class="chart" ref={ref} role="img" aria-label={props.says} />
    </section>
  );
}
