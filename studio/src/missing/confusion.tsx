// Which effects cannot be told apart, as a matrix: rows by name, columns by the rows' numbers.
import {useRef} from 'preact/hooks';
import {css, notCounted, sequential, type Ramp} from '../colours';
import type {EffectScore} from '../document';
import {drawnSvg, saveCsv} from '../download';
import {spaced} from '../format';
import {savePictures} from '../pictures';
import {Legend} from '../widgets';
import {cosine, leastCosine, together} from './order';

const cosineRamp: Ramp = {
  title: 'cosine between the changes of the pictures',
  ends: [`${leastCosine}`, '', '1: cannot be told apart'], scale: sequential, from: 0,
};
const title = 'What cannot be told apart sits together';
const size = 20;
const left = 200;
const top = 16;

function Cell(props: {a: EffectScore; b: EffectScore; row: number; column: number}) {
  const {a, b, row, column} = props;
  const c = cosine(a, b);
  return (
    <rect x={left + column * size} y={top + row * size} width={size - 1} height={size - 1}
          fill={css(c === undefined ? notCounted : sequential((c - leastCosine) / (1 - leastCosine)))}>
      <title>{`${spaced(a.effect)} and ${spaced(b.effect)}: ${c === undefined ? `cosine below ${leastCosine}` : `cosine ${c.toFixed(3)}`}`}</title>
    </rect>
  );
}

export function Confusion(props: {effects: EffectScore[]; strong: string}) {
  const ref = useRef<SVGSVGElement>(null);
  const list = together(props.effects.filter((e, i) => i < 12 || e.named));
  const n = list.length;
  if (n < 2) return null;
  return (
    <figure class="confusion">
      <figcaption>{title}
        <button class="quiet" onClick={() => ref.current && void drawnSvg(ref.current).then((canvas) =>
          savePictures('confusion.png', [{canvas, says: `${title} (grey: cosine below ${leastCosine})`}], [cosineRamp]))}>PNG</button>
        <button class="quiet" onClick={() => saveCsv('confusion.csv',
          [['', ...list.map((e) => e.effect)], ...list.map((a) => [a.effect, ...list.map((b) => cosine(a, b))])])}>CSV</button>
      </figcaption>
      <svg ref={ref} viewBox={`0 0 ${left + n * size + 4} ${top + n * size + 4}`} role="img"
           aria-label="Cosine between the signatures of effects">
        {list.map((a, i) => (
          <g key={a.effect}>
            <text x={left - 6} y={top + i * size + 14} text-anchor="end" class={a.effect === props.strong ? 'strong' : ''}>{spaced(a.effect)} {i + 1}</text>
            <text x={left + (i + 0.5) * size} y={top - 4} text-anchor="middle" class={a.effect === props.strong ? 'strong' : ''}>{i + 1}</text>
            {list.map((b, j) => <Cell key={b.effect} a={a} b={b} row={i} column={j} />)}
          </g>
        ))}
      </svg>
      <div class="legends"><Legend ramp={cosineRamp} /><span>grey: below {leastCosine}</span></div>
    </figure>
  );
}
