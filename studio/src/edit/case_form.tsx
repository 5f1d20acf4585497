// One load case: what it is used for, its photos, what holds the body and what pulls at it.
import {useState} from 'preact/hooks';
import {loadText, supportText} from './acts';
import {capture, edit, plain, word, type CaseEntry, type Edit, type LoadEntry, type SupportEntry} from './capture';
import {chooseCase, faultsOf, region, shownCase, showLine} from './chosen';
import {FaultLines, locked, NumberField, once, VectorField} from './fields';

const uses = {fit: 'fitted', validate: 'held out, helps to choose', test: 'nothing sees it before the end'};

function Use(props: {of: CaseEntry}) {
  const {of} = props;
  const set = (use: string): void => void edit({path: ['examples', of.name, 'use'], value: use});
  return (
    <fieldset class="uses" disabled={locked()}>
      <legend>Use</legend>
      {Object.entries(uses).map(([use, says]) => (
        <label key={use}><input type="radio" name="use" value={use} checked={of.use === use} onChange={() => set(use)} /> <b>{use}</b> <small>{says}</small></label>))}
    </fieldset>
  );
}

/** Loads and motions go; what stands still stays. Lists are shortened from behind, so that numbers hold. */
function asRest(of: CaseEntry): void {
  const path = ['examples', of.name];
  const moves = (support: SupportEntry): boolean => support.rigid !== undefined || (support.along ?? []).some((x) => x !== null && x !== 0);
  const edits: Edit[] = of.loads.length ? [{path: [...path, 'loads']}] : [];
  for (const support of [...of.supports].reverse())
    if (moves(support) && support.number !== undefined) edits.push({path: [...path, 'supports', String(support.number)]});
  void edit(...edits);
}

function Rest(props: {of: CaseEntry}) {
  const {of} = props;
  const from = capture.value?.texture_from;
  return (
    <p class="note">
      {of.rest ? 'The body is at rest here: its photos are reference images. ' : 'The body is loaded here. '}
      {!of.rest && <button disabled={locked()} onClick={() => once(() => asRest(of))}>Make it the rest state</button>}
      {of.rest && of.photos.length > 0 && from !== of.name && of.use === 'fit' &&
        <button disabled={locked()} onClick={() => void edit({path: ['body', 'texture'], value: `{from: ${word(of.name)}}`})}>Take the texture from it</button>}
      {from === of.name && ' Its photos give the texture.'}
    </p>
  );
}

/** Components of a prescribed motion, as the file has them. */
function supportValue(name: string, along: string[]): string {
  const axes = ['x', 'y', 'z'];
  const held = axes.filter((_, i) => along[i] !== '' && Number(along[i]) === 0);
  const moved = axes.flatMap((axis, i) => (along[i] !== '' && Number(along[i]) !== 0 ? [`${axis}: ${plain(Number(along[i]))}`] : []));
  const parts = [held.length ? `fix: [${held.join(', ')}]` : '', moved.length ? `move: {${moved.join(', ')}}` : ''].filter(Boolean);
  return `{region: ${word(name)}, ${parts.join(', ')}}`;
}
const typedOf = (along: (number | null)[]): string[] => along.map((x) => (x === null ? '' : String(x)));

function Row(props: {of: CaseEntry; list: 'supports' | 'loads'; entry: SupportEntry | LoadEntry; text: string; children?: preact.ComponentChildren}) {
  const {of, list, entry} = props;
  return (
    <li class="act">
      <button class="link" aria-pressed={region.value === entry.region} title="Show the region"
              onClick={() => (region.value = region.value === entry.region ? '' : entry.region)}>{entry.region}</button>
      <span class="says">{props.text}</span>
      {props.children}
      <button class="quiet" onClick={() => showLine(entry.line)}>line {entry.line}</button>
      <button class="quiet" disabled={locked() || entry.number === undefined} aria-label={`Remove ${entry.region}: ${props.text}`}
              onClick={() => once(() => void edit({path: ['examples', of.name, list, String(entry.number)]}))}>Remove</button>
    </li>
  );
}

function Supports(props: {of: CaseEntry}) {
  const {of} = props;
  return (
    <ul class="acts" aria-label="Supports">
      {of.supports.map((one, i) => (
        <Row key={i} of={of} list="supports" entry={one} text={supportText(one)}>
          {one.along && one.number !== undefined &&
            <VectorField label={`${one.region} moves along`} optional value={typedOf(one.along)} onChange={(value) =>
              value.some((x) => x !== '') && void edit({path: ['examples', of.name, 'supports', String(one.number)], value: supportValue(one.region, value)})} />}
        </Row>))}
      {!of.supports.length && <li class="note">Nothing holds the body.</li>}
    </ul>
  );
}

function Loads(props: {of: CaseEntry}) {
  const {of} = props;
  const set = (one: LoadEntry, key: string, value: string): void =>
    void edit({path: ['examples', of.name, 'loads', String(one.number), key], value});
  return (
    <ul class="acts" aria-label="Loads">
      {of.loads.map((one, i) => (
        <Row key={i} of={of} list="loads" entry={one} text={loadText(one)}>
          {one.number !== undefined && (one.force
            ? <VectorField label={`${one.region} force along`} value={one.force.map(String)} onChange={(value) => set(one, 'force', `[${value.join(', ')}]`)} />
            : <NumberField label={`${one.region} pressure`} value={String(one.pressure)} onChange={(value) => set(one, 'pressure', value)} />)}
        </Row>))}
      {!of.loads.length && <li class="note">Nothing pulls at it.</li>}
    </ul>
  );
}

const kinds = {hold: 'held or moved', rigid: 'moves as a whole, unknown', force: 'force', pressure: 'pressure'};
type Kind = keyof typeof kinds;

function Add(props: {of: CaseEntry}) {
  const {of} = props;
  const regions = capture.value?.regions.map((one) => one.name) ?? [];
  const [wanted, setWanted] = useState('');
  const name = regions.includes(wanted) ? wanted : regions.includes(region.value) ? region.value : regions[0] ?? '';
  const [kind, setKind] = useState<Kind>('hold');
  const [along, setAlong] = useState(['0', '0', '0']);
  const [force, setForce] = useState(['0', '0', '0']);
  const [pressure, setPressure] = useState('');
  const {force: forceUnit, length, stress} = capture.value!.units;
  const ready = name !== '' && (kind === 'rigid' || (kind === 'hold' && along.some((x) => x !== '')) ||
    (kind === 'force' && force.some((x) => Number(x) !== 0)) || (kind === 'pressure' && pressure !== ''));
  const add = (): void => {
    const list = kind === 'hold' || kind === 'rigid' ? 'supports' : 'loads';
    const value = kind === 'hold' ? supportValue(name, along) : kind === 'rigid' ? `{region: ${word(name)}, rigid: fit}`
      : kind === 'force' ? `{region: ${word(name)}, force: [${force.map((x) => plain(Number(x))).join(', ')}]}` : `{region: ${word(name)}, pressure: ${pressure}}`;
    void edit({path: ['examples', of.name, list, '+'], value});
  };
  if (!regions.length) return <p class="note">A support or load needs a region: pick faces on the body or in the photo.</p>;
  return (
    <form class="add" aria-label="Add a support or a load" onSubmit={(event) => {
      event.preventDefault();
      if (ready) once(add);
    }}>
      <label>On <select value={name} onChange={(e) => setWanted(e.currentTarget.value)}>{regions.map((one) => <option key={one}>{one}</option>)}</select></label>
      <label>a <select aria-label="Kind" value={kind} onChange={(e) => setKind(e.currentTarget.value as Kind)}>
        {Object.entries(kinds).map(([key, says]) => <option key={key} value={key}>{says}</option>)}</select></label>
      {kind === 'hold' && <><VectorField label={`displacement [${length}] along`} optional value={along} onChange={setAlong} /><small>0 holds, empty is free</small></>}
      {kind === 'force' && <><VectorField label={`force [${forceUnit}] along`} value={force} onChange={setForce} /><small>{forceUnit}, in all</small></>}
      {kind === 'pressure' && <><NumberField label="pressure" value={pressure} onChange={setPressure} /><small>{stress}, pushes inwards</small></>}
      <button class="primary" type="submit" disabled={!ready || locked()}>Add</button>
    </form>
  );
}

function Photos(props: {of: CaseEntry}) {
  const {of} = props;
  const missing = capture.value!.cameras.filter((camera) => !of.photos.some((photo) => photo.camera === camera.name));
  const set = (camera: string, file: string): void => void (file && edit({path: ['examples', of.name, 'photos', camera], value: JSON.stringify(file)}));
  return (
    <dl class="case-photos">
      {of.photos.map((photo) => <div key={photo.camera}><dt>{photo.camera}</dt><dd>{photo.file}</dd></div>)}
      {missing.map(({name}) => (
        <div key={name}><dt>{name}</dt><dd>
          <input list="pictures" aria-label={`Photo of ${name}`} placeholder="no photo: a file of the folder" disabled={locked()}
                 onChange={(e) => set(name, e.currentTarget.value.trim())} /></dd></div>))}
      <datalist id="pictures">{capture.value!.pictures.map((file) => <option key={file} value={file} />)}</datalist>
    </dl>
  );
}

function NewCase() {
  const [name, setName] = useState('');
  const taken = capture.value!.examples.some((one) => one.name === name);
  const add = async (): Promise<void> => {
    if (await edit({path: ['examples', name], value: '{}'})) {
      chooseCase(name);
      setName('');
    }
  };
  return (
    <form class="add" aria-label="New load case" onSubmit={(event) => {
      event.preventDefault();
      if (name && !taken) once(() => void add());
    }}>
      <label>New load case <input value={name} onInput={(e) => setName(e.currentTarget.value.trim())} aria-invalid={taken} /></label>
      <button type="submit" disabled={!name || taken || locked()}>Add</button>
    </form>
  );
}

export function CaseForm() {
  const of = shownCase.value;
  if (!of) return <><p class="empty">The capture has no load case yet.</p><NewCase /></>;
  return (
    <div class="form">
      <label class="choose">Load case <select value={of.name} onChange={(e) => chooseCase(e.currentTarget.value)}>
        {capture.value!.examples.map((one) => <option key={one.name} value={one.name}>{one.name}{one.rest ? ' (rest)' : ''}{one.use === 'fit' ? '' : `, ${one.use}`}</option>)}
      </select></label>
      <FaultLines of={faultsOf('examples', of.name)} />
      <Rest of={of} />
      <Use of={of} />
      <h3>Supports</h3><Supports of={of} />
      <h3>Loads</h3><Loads of={of} />
      <Add of={of} />
      <h3>Photos</h3><Photos of={of} />
      {of.measured > 0 && <p class="note">{of.measured} measured value{of.measured > 1 ? 's' : ''}: see the text, <button class="link" onClick={() => showLine(of.line)}>line {of.line}</button>.</p>}
      <NewCase />
    </div>
  );
}
