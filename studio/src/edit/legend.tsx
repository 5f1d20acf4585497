// What the colours and lines over the photo and on the body are; folded where there is little room.
import type {Signal} from '@preact/signals';
import {useEffect, useRef} from 'preact/hooks';
import {css} from '../colours';
import {loadColour, supportColour} from '../fails/marks';
import {actsOf} from './acts';
import {patches, pickedColour, regionColour} from './body';
import {picked, region, shownCase} from './chosen';
import {pairing} from './pose';
import {outlineColour, wireColour} from './projected';

const hex = (colour: number): string => '#' + colour.toString(16).padStart(6, '0');
export const pairColour = '#ffd400';

/** No `style` attribute: the page's content security policy forbids it. */
function Key(props: {kind: 'line' | 'patch' | 'ring' | 'arrow' | 'cross'; colour: string; says: string}) {
  const {kind, colour} = props;
  const line = {stroke: colour, 'stroke-width': 2, fill: 'none'};
  return (
    <li>
      <svg width="18" height="12" viewBox="0 0 18 12" aria-hidden="true">
        {kind === 'line' && <path d="M1 6H17" {...line} />}
        {kind === 'patch' && <rect x="2" y="1" width="14" height="10" fill={colour} />}
        {kind === 'ring' && <circle cx="9" cy="6" r="4" {...line} />}
        {kind === 'arrow' && <path d="M1 6H16M12 2L16 6L12 10" {...line} />}
        {kind === 'cross' && <path d="M9 1V11M4 6H14" {...line} />}
      </svg> {props.says}
    </li>
  );
}

/** `lines`: what is drawn over a photo; left out: the body in space. */
export function Legend(props: {lines?: Record<'outline' | 'wire' | 'faces' | 'marks', Signal<boolean>>}) {
  const {lines} = props;
  const box = useRef<HTMLDetailsElement>(null);
  useEffect(() => {
    box.current!.open = window.matchMedia('(min-width: 901px)').matches;
  }, []);
  const marks = !lines || lines.marks.value ? actsOf(shownCase.value) : [];
  const loads = (one: (typeof marks)[number]): boolean => one.force !== undefined || one.pressure !== undefined;
  const moves = (one: (typeof marks)[number]): boolean => !loads(one) && one.move !== undefined;
  const held = marks.filter((one) => !loads(one) && !moves(one));
  const names = [...patches.value.keys()];
  return (
    <details class="legend" ref={box}>
      <summary>Legend</summary>
      <ul>
        {lines?.outline.value && <Key kind="line" colour={hex(outlineColour)} says="outline of the body at rest" />}
        {lines?.wire.value && <Key kind="line" colour={hex(wireColour)} says="edges of its triangles" />}
        {names.map((name, i) => (!region.value || name === region.value) && (
          <Key key={name} kind="patch" colour={css(regionColour(i))} says={`region ${name}`} />))}
        {picked.value.size > 0 && <Key kind="patch" colour={css(pickedColour)} says="picked faces" />}
        {held.length > 0 && <Key kind={lines ? 'ring' : 'patch'} colour={hex(supportColour)} says={lines ? 'held or turned here' : 'held or turned here (cones)'} />}
        {marks.some(moves) && <Key kind="arrow" colour={hex(supportColour)} says="moved this way by a support" />}
        {marks.some(loads) && <Key kind="arrow" colour={hex(loadColour)} says="load: a force or a pressure" />}
        {lines && pairing.value && <Key kind="cross" colour={pairColour} says="picked pairs" />}
      </ul>
    </details>
  );
}
