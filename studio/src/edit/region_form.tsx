// Regions: patches of the body's surface. Picked faces become one.
import {useState} from 'preact/hooks';
import {css} from '../colours';
import {figure} from '../format';
import {body, boxAround, endFaces, patches, regionColour} from './body';
import {capture, edit, vector, word, writeFaces, type RegionEntry} from './capture';
import {faultsOf, picked, region, showLine} from './chosen';
import {FaultLines, locked, once} from './fields';
import {across, toggle} from './pick';

function shapeText(one: RegionEntry): string {
  const point = (v: number[]): string => `(${v.map((x) => figure(x, 4)).join(', ')})`;
  if (one.box) return `box from ${point(one.box[0])} to ${point(one.box[1])}`;
  if (one.sphere) return `ball around ${point(one.sphere.center)}, radius ${figure(one.sphere.radius)}`;
  if (one.halfspace) return `beyond ${point(one.halfspace.point)} towards ${point(one.halfspace.normal)}`;
  if (one.faces) return `${one.faces.length} faces of the surface, in ${one.file}`;
  return one.group ? `group ${one.group} of the mesh` : 'cannot be read';
}

/** Load cases that name it. */
const usersOf = (name: string): string[] => (capture.value?.examples ?? [])
  .filter((one) => [...one.supports, ...one.loads].some((act) => act.region === name)).map((one) => one.name);

function List() {
  const all = capture.value!.regions;
  return (
    <ul class="acts regions" aria-label="Regions">
      {all.map((one, i) => {
        const users = usersOf(one.name), count = patches.value.get(one.name)?.length;
        return (
          <li key={one.name} class="act">
            <span class="swatch" style={{background: css(regionColour(i))}} aria-hidden="true" />
            <button class="link" aria-pressed={region.value === one.name} onClick={() => (region.value = region.value === one.name ? '' : one.name)}>{one.name}</button>
            <span class="says">{shapeText(one)}{count === 0 ? '; it holds nothing of the surface that is drawn' : ''}</span>
            <button class="quiet" onClick={() => showLine(one.line)}>line {one.line}</button>
            <button class="quiet" disabled={locked() || users.length > 0} title={users.length ? `used in ${users.join(', ')}` : ''}
                    aria-label={`Remove ${one.name}`} onClick={() => once(() => void edit({path: ['regions', one.name]}))}>Remove</button>
            <FaultLines of={faultsOf('regions', one.name)} />
          </li>);
      })}
      {!all.length && <li class="note">There is none yet.</li>}
    </ul>
  );
}

const axes: [string, number, number][] = [['−x', 0, -1], ['+x', 0, 1], ['−y', 1, -1], ['+y', 1, 1], ['−z', 2, -1], ['+z', 2, 1]];

function Make() {
  const [name, setName] = useState('');
  const [as, setAs] = useState<'box' | 'faces' | ''>('');
  const of = body.value;
  if (!of) return null;
  const around = picked.value.size ? boxAround(of, picked.value) : null;
  const kind = as || (around?.exact || !of.ofFile ? 'box' : 'faces');
  const taken = capture.value!.regions.some((one) => one.name === name);
  const make = async (): Promise<void> => {
    const done = kind === 'box'
      ? await edit({path: ['regions', name], value: `{box: [${around!.box.map(vector).join(', ')}]}`})
      : await writeFaces(name, [...picked.value].sort((a, b) => a - b));
    if (!done) return;
    picked.value = new Set();
    region.value = name;
    setName('');
  };
  return (
    <form class="add" aria-label="Make a region" onSubmit={(event) => {
      event.preventDefault();
      if (around && name) once(() => void make());
    }}>
      <h3>Make a region</h3>
      <p class="note">Click faces on the body or in the photo, or take an end of the body:</p>
      <div class="choice" role="group" aria-label="End of the body">
        {axes.map(([says, axis, sign]) => <button type="button" key={says} onClick={() => toggle(endFaces(of, axis, sign))}>{says}</button>)}
      </div>
      <label>A click goes over edges up to <select value={across.value} onChange={(e) => (across.value = Number(e.currentTarget.value))}>
        <option value="0">none: one face</option>{[5, 20, 40, 180].map((d) => <option key={d} value={d}>{d}°</option>)}</select></label>
      <p role="status" class="note"><b>{picked.value.size}</b> faces picked {picked.value.size > 0 &&
        <button type="button" class="quiet" onClick={() => (picked.value = new Set())}>Clear</button>}</p>
      <label>Name <input value={name} onInput={(e) => setName(e.currentTarget.value.trim())} /></label>
      <label>as <select value={kind} onChange={(e) => setAs(e.currentTarget.value as 'box' | 'faces')}>
        <option value="box">the box around them</option>{of.ofFile && <option value="faces">these faces, in a list</option>}</select></label>
      {around && kind === 'box' && !around.exact && <small>The box holds other faces too.</small>}
      <button class="primary" type="submit" disabled={!around || !name || locked()}>{taken ? 'Replace' : 'Make'}</button>
    </form>
  );
}

export function RegionForm() {
  return <div class="form"><Make /><h3>Regions</h3><List />
    <p class="note">Balls, half-spaces and groups of a mesh are written in the text: <code>{word('grip')}: {'{sphere: {center: [0, 0, 0], radius: 5}}'}</code>.</p></div>;
}
