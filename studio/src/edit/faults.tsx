// All that is wrong, by what it is about; a click leads to where it can be mended.
import {figure, percent} from '../format';
import {Said, Wide} from '../widgets';
import {faults, passes, pulse, type Fault} from './capture';
import {inFile, show, showLine, subject} from './chosen';

export function checkWords(): string {
  const check = pulse.value?.check;
  const stops = faults.value.filter((one) => one.stops).length, warns = faults.value.length - stops;
  const counted = (n: number, what: string): string => `${n} ${what}${n === 1 ? '' : 's'}`;
  if (stops) return counted(stops, 'fault') + (warns ? `, ${counted(warns, 'warning')}` : '');
  if (!check || check.state === 'idle' || check.state === 'running') return 'checking …';
  if (check.state === 'failed') return check.message ?? 'check failed';
  return passes.value ? `passes check${warns ? `, ${counted(warns, 'warning')}` : ''}` : 'checking …';
}

function FaultRow(props: {of: Fault}) {
  const {of} = props;
  const about = subject(of);
  return (
    <li class={of.stops ? 'stops' : 'warns'}>
      <button class="fault" onClick={() => show(of)}>
        <b>{of.stops ? 'Fault' : 'Warning'}</b>{about.name && ` in ${about.name}`}: <Said text={of.wrong} />
        {of.right && <em> <Said text={of.right} /></em>}
      </button>
      {inFile(of) ? <button class="quiet" onClick={() => showLine(of.line)}>line {of.line}</button>
        : of.file && <small>{of.file.split('/').pop()}{of.line > 0 && `, line ${of.line}`}</small>}
    </li>
  );
}

export function FaultList() {
  const check = pulse.value?.check;
  return (
    <div class="form">
      <p role="status"><b>{checkWords()}</b></p>
      <ul class="faults-found" aria-label="Faults and warnings">{faults.value.map((one, i) => <FaultRow key={i} of={one} />)}</ul>
      {check?.state === 'done' && (check.cameras ?? []).length > 0 && (
        <Wide label="The model over the photos">
          <thead><tr><th>camera</th><th>outlines overlap</th><th>texture found</th><th>off by</th></tr></thead>
          <tbody>{check.cameras!.map((one) => (
            <tr key={one.camera}><th scope="row">{one.camera}, {one.example}</th><td>{figure(one.overlap)}</td>
              <td>{percent(one.texture_found ?? undefined)}</td><td>{one.off_px === null ? '–' : `${figure(one.off_px)} px`}</td></tr>))}</tbody>
        </Wide>)}
      <p class="note"><code>hookeye check</code> runs after each change. Overlaps near 1 and texture that is found mean that the poses are right.</p>
    </div>
  );
}
