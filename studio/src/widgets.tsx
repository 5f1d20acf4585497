// Small parts of every view.
import type {Signal} from '@preact/signals';
import type {ComponentChildren} from 'preact';
import {useEffect, useRef, useState} from 'preact/hooks';
import {gradient, type Ramp} from './colours';
import {saveCsv} from './download';
import {saveBars} from './pictures';

export function Toolbar(props: {children: ComponentChildren}) {
  return <div class="toolbar">{props.children}</div>;
}

/** A table that may be wider than a phone scrolls by itself; only then the keyboard stops at it. */
export function Wide(props: {label: string; class?: string; children: ComponentChildren}) {
  const ref = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const box = ref.current!;
    const measure = (): void => {
      if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
      else box.removeAttribute('tabindex');
    };
    const watch = new ResizeObserver(measure);
    watch.observe(box);
    watch.observe(box.firstElementChild!);
    return () => watch.disconnect();
  }, []);
  return <div class="wide-table" ref={ref} role="group" aria-label={props.label}><table class={props.class} aria-label={props.label}>{props.children}</table></div>;
}

/** A bar for a share of one. */
export function Share(props: {of: number | undefined}) {
  return <span class="track"><span class="fill" style={{width: `${100 * Math.min(1, Math.max(0, props.of ?? 0))}%`}} /></span>;
}

/** A sentence of the program, whose commands stand in backticks. */
export function Said(props: {text: string}) {
  return <>{props.text.split('`').map((part, i) => (i % 2 ? <code key={i}>{part}</code> : part))}</>;
}

/** Says what became of the click; where there is no clipboard, the text itself to copy by hand. */
export function Copy(props: {text: string; label: string}) {
  const [outcome, setOutcome] = useState<'' | 'copied' | 'refused'>('');
  const copy = async (): Promise<void> => {
    try {
      await navigator.clipboard.writeText(props.text);
      setOutcome('copied');
      setTimeout(() => setOutcome(''), 2500);
    } catch {
      setOutcome('refused');
    }
  };
  if (outcome === 'refused') return <code class="copied" role="status">{props.text}</code>;
  return <button class="quiet" aria-live="polite" onClick={() => void copy()}>{outcome === 'copied' ? 'Copied' : props.label}</button>;
}

/** One of several, as a row of buttons. */
export function Buttons<T extends string>(props: {
  label: string;
  values: readonly T[];
  chosen: Signal<T>;
  names?: Record<T, string>;
}) {
  return (
    <div class="choice" role="group" aria-label={props.label}>
      {props.values.map((value) => (
        <button key={value} aria-pressed={props.chosen.value === value}
                onClick={() => (props.chosen.value = value)}>
          {props.names?.[value] ?? value}
        </button>
      ))}
    </div>
  );
}

export function Legend(props: {ramp: Ramp}) {
  const {ramp} = props;
  return (
    <div class="legend">
      <span>{ramp.title}</span>
      <div class="ramp" style={{background: gradient(ramp)}} />
      <div class="ends">{ramp.ends.map((end) => <span>{end}</span>)}</div>
    </div>
  );
}

export interface Row {
  name: string;
  value: number;
  note?: string;
}
/** Horizontal bars from zero; `mark` is drawn as a line (the floor). */
export function Bars(props: {title: string; rows: Row[]; mark?: number; digits?: number}) {
  const file = props.title.replace(/[^a-z]+/gi, '-').replace(/^-/, '');
  const most = Math.max(props.mark ?? 0, ...props.rows.map((r) => (Number.isFinite(r.value) ? r.value : 0)), 1e-12);
  return (
    <section class="bars">
      <h3>{props.title}
        <button class="quiet" onClick={() => saveCsv(`${file}.csv`, [['name', 'value'], ...props.rows.map((r) => [r.name, r.value])])}>CSV</button>
        <button class="quiet" onClick={() => saveBars(`${file}.png`, props.title, props.rows, props.mark)}>PNG</button></h3>
      <dl>
        {props.rows.map((row) => (
          <div key={row.name}>
            <dt title={row.note}>{row.name}</dt>
            <dd>
              <span class="track">
                <span class="fill" style={{width: `${(100 * Math.max(0, row.value || 0)) / most}%`}} />
                {props.mark !== undefined && <span class="mark" style={{left: `${(100 * props.mark) / most}%`}} />}
              </span>
              <span class="value">{Number.isFinite(row.value) ? row.value.toPrecision(props.digits ?? 3) : '–'}</span>
            </dd>
          </div>
        ))}
      </dl>
    </section>
  );
}
