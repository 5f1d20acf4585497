// Small inputs of the forms.
import {useState} from 'preact/hooks';
import type {Fault} from './capture';
import {draft, saving} from './capture';
import {inFile, showLine} from './chosen';
import {Said} from '../widgets';

/** Nothing is changed by forms while the text is typed in. */
export const locked = (): boolean => draft.value !== null;
/** Of what would be done twice by a second click: nothing while a change is under way. */
export const once = (work: () => void): void => void (!saving.value && !locked() && work());

/** A number as it is typed; '' where there is none. Told when the input is left, or at Enter. */
export function NumberField(props: {label: string; value: string; onChange: (text: string) => void; optional?: boolean}) {
  const [text, setText] = useState(props.value);
  const [told, setTold] = useState(props.value);
  if (told !== props.value) {  // it was changed elsewhere
    setTold(props.value);
    setText(props.value);
  }
  const wrong = text.trim() === '' ? !props.optional : !Number.isFinite(Number(text));
  return <input class="number" inputMode="decimal" aria-label={props.label} title={props.label} placeholder={props.label.split(' ').pop()}
                value={text} aria-invalid={wrong} disabled={locked()}
                onInput={(e) => setText(e.currentTarget.value)}
                onChange={(e) => e.currentTarget.value !== props.value && (e.currentTarget.value.trim() === '' ? props.optional : Number.isFinite(Number(e.currentTarget.value)))
                  && props.onChange(e.currentTarget.value.trim())} />;
}

/** Three numbers with their axes. */
export function VectorField(props: {label: string; value: string[]; onChange: (value: string[]) => void; optional?: boolean}) {
  return (
    <span class="vector" role="group" aria-label={props.label}>
      {['x', 'y', 'z'].map((axis, i) => (
        <NumberField key={axis} label={`${props.label} ${axis}`} value={props.value[i]} optional={props.optional}
                     onChange={(text) => props.onChange(props.value.map((old, k) => (k === i ? text : old)))} />))}
    </span>
  );
}

/** What is wrong, with its line. */
export function FaultLines(props: {of: Fault[]}) {
  if (!props.of.length) return null;
  return (
    <ul class="fault-lines">
      {props.of.map((fault, i) => (
        <li key={i} class={fault.stops ? 'stops' : 'warns'}>
          <b>{fault.stops ? 'Fault' : 'Warning'}</b> {inFile(fault) && <button class="link" onClick={() => showLine(fault.line)}>line {fault.line}</button>}{' '}
          <Said text={fault.wrong} />{fault.right && <>. <em><Said text={fault.right} /></em></>}
        </li>))}
    </ul>
  );
}
