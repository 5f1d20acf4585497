// A line chart by uPlot in the page's colours.
import {useEffect, useRef} from 'preact/hooks';
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import {theme} from '../state';

export interface Line {
  label: string;
  values: (number | null)[];
  colour: string;
  dash?: number[];
  points?: boolean;
}
export function Chart(props: {
  title: string;
  x: number[];
  names?: string[];
  lines: Line[];
  bands?: [number, number][];
  xLabel: string;
  yLabel: string;
  log?: boolean;
  visited?: [number, number];  // shaded along x: where the data are
}) {
  const ref = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const box = ref.current!;
    const style = getComputedStyle(document.body);
    const ink = style.getPropertyValue('--ink').trim() || '#222';
    const faint = style.getPropertyValue('--line').trim() || '#ccc';
    const size = (): {width: number; height: number} => ({
      width: Math.max(200, box.clientWidth),
      height: Math.max(160, box.clientHeight - 30),
    });
    const axis = {stroke: ink, grid: {stroke: faint, width: 1}, ticks: {stroke: faint, width: 1}};
    const names = props.names;
    const plot = new uPlot(
      {
        ...size(),
        scales: {x: {time: false, range: names ? (_, a, b) => [a - 0.3, b + 0.3] : undefined}, y: {distr: props.log ? 3 : 1}},
        axes: [
          {...axis, label: props.xLabel, labelSize: 22, ...(names && {
            splits: () => props.x, values: (_: uPlot, at: number[]) => at.map((i) => names[i] ?? ''),
          })},
          {...axis, label: props.yLabel, labelSize: 22, size: props.log ? 56 : 68, ...(!props.log && {
            values: (_: uPlot, at: number[]) => at.map((v) => `${Number(v.toPrecision(4))}`),
          })},
        ],
        series: [
          {label: props.xLabel, value: names ? (_, v) => names[v] ?? '–' : undefined},
          ...props.lines.map((line) => ({
            label: line.label,
            stroke: line.colour,
            width: 2,
            dash: line.dash,
            points: {show: line.points ?? false, size: 8, fill: line.colour},
            value: (_: uPlot, v: number | null) => (v === null ? '–' : v.toPrecision(4)),
          })),
        ],
        hooks: {
          drawClear: props.visited ? [(u: uPlot) => {
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
    const watch = new ResizeObserver(() => plot.setSize(size()));
    watch.observe(box);
    return () => {
      watch.disconnect();
      plot.destroy();
    };
  }, [props.x, props.lines, theme.value]);
  return <div class="chart" ref={ref} role="img" aria-label={props.title} />;
}
