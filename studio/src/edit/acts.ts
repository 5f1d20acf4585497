// What holds the body and pulls at it in a load case, as it is drawn and told.
import type {Act} from '../document';
import {figure} from '../format';
import {capture, type CaseEntry, type LoadEntry, type SupportEntry} from './capture';

const unit = (): {length: string; force: string; stress: string} => capture.value?.units ?? {length: '', force: '', stress: ''};
const vectorText = (v: ArrayLike<number>): string => `(${Array.from(v, (x) => figure(x)).join(', ')})`;

export function supportText(support: SupportEntry): string {
  if (support.rigid === 'fit') return 'moves as a whole, by an unknown amount';
  if (support.rigid) {
    const {axis, degrees, move} = support.rigid;
    const parts = [degrees ? `turned by ${figure(degrees)}° about ${vectorText(axis)}` : '',
      Math.hypot(...move) ? `moved by ${vectorText(move)} ${unit().length}` : ''].filter(Boolean);
    return `as a whole ${parts.join(', ') || 'held'}`;
  }
  const along = support.along ?? [];
  const held = ['x', 'y', 'z'].filter((_, i) => along[i] === 0);
  const moved = ['x', 'y', 'z'].flatMap((name, i) => (along[i] ? [`${name} by ${figure(along[i])}`] : []));
  return [held.length ? `${held.join(', ')} held` : '', moved.length ? `${moved.join(', ')} ${unit().length} moved` : ''].filter(Boolean).join('; ');
}
export const loadText = (load: LoadEntry): string =>
  load.force ? `force ${vectorText(load.force)} ${unit().force}` : `pressure ${figure(load.pressure)} ${unit().stress}`;

/** The motion of a support; none where it stands. */
function motion(support: SupportEntry): number[] | undefined {
  const move = support.rigid && support.rigid !== 'fit' ? support.rigid.move : support.along?.map((x) => x ?? 0);
  return move && Math.hypot(...move) > 0 ? move : undefined;
}
export function actsOf(shown: CaseEntry | undefined): Act[] {
  if (!shown) return [];
  return [
    ...shown.supports.map((one): Act => ({region: one.region, text: `${one.region}: ${supportText(one)}`, move: motion(one)})),
    ...shown.loads.map((one): Act => ({region: one.region, text: `${one.region}: ${loadText(one)}`, force: one.force, pressure: one.pressure})),
  ];
}
