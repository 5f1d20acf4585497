// The reporting table, the capture's facts, and what made the run.
import {save, saveCsv} from '../download';
import {figure} from '../format';
import {useLengthPerPx} from '../length_per_px';
import {bytesOf} from '../parts';
import {floor, floorSource, run, step, stepIndex, timelineOf, units} from '../state';
import {Wide} from '../widgets';
import {Glossary} from './glossary';
import {Work, pixelRows} from './work';

/** One component of the displacement of a cell of 16 px, from what noise and gradients leave open. */
function displacementResolution(perPx: number): [string, string][] {
  const {chi, per_px2: information} = {...step.value?.metrics?.floor, ...run.value.timeline.floor};
  if (!information || chi === undefined) return [];
  const px = chi / Math.sqrt(256 * information);
  const length = Number.isFinite(perPx) ? ` = ${figure(px * perPx, 2)} ${units.value.length}` : '';
  return [['Displacement resolution',
    `${figure(px, 2)} px${length}: standard deviation of one component in a cell of 16 px, from noise floor and texture`]];
}

function practiceRows(perPx: number): [string, string][] {
  const metrics = step.value?.metrics;
  const rows: [string, string][] = [
    ['Noise floor', `normalised residual ${figure(floor.value.chi, 4)}, from ${floorSource(floor.value.source)}`],
    ...run.value.practice.map((r): [string, string] => [r.name, r.value]),
    ...displacementResolution(perPx),
    ...pixelRows(),
  ];
  if (metrics)
    rows.push(['Spatial resolution',
      `${metrics.mesh.nodes} nodes, ${metrics.mesh.elements} tetrahedra of order ${metrics.mesh.order}, mean edge ${figure(metrics.mesh.mean_edge)} ${run.value.capture?.units.length ?? ''}`]);
  return rows;
}

/** A link to bytes that lie in this very page. */
function FileLink(props: {name: string; bytes: () => Promise<BlobPart>}) {
  return (
    <a href={'#' + props.name} download={props.name} onClick={(event) => {
      event.preventDefault();
      void props.bytes().then((bytes) => save(props.name, new Blob([bytes])));
    }}>{props.name}</a>
  );
}

/** run.json and the whole deformed bodies; in the studio every file of the step. */
function Files() {
  const {live, run: folder, timeline} = run.value;
  const now = step.value;
  if (live) {
    const files = ['run.json', ...(now?.files ?? [])].filter((f) => /\.(json|vtu|csv|yaml|exr)$/.test(f));
    return <ul class="files">{files.map((f) => <li key={f}><a href={`file?name=${encodeURIComponent(f)}`} download>{f}</a></li>)}</ul>;
  }
  const prefix = now ? `${now.folder}-` : '';
  return <>
    <ul class="files">
      <li><FileLink name="run.json" bytes={async () => JSON.stringify(timeline, null, 2)} /></li>
      {now?.deformed.map((body) => (
        <li key={body.name}><FileLink name={prefix + body.name} bytes={() => bytesOf(body.blob) as Promise<BlobPart>} /></li>
      ))}
    </ul>
    <p class="note">{now?.deformed.length ? '' : 'The deformed bodies (.vtu) are not in this page. '}All files of this run lie in <code>{folder}</code>.</p>
  </>;
}

export function Facts() {
  const rows = practiceRows(useLengthPerPx());
  const capture = run.value.capture;
  const told = timelineOf(step.value);
  return (
    <div class="facts columns">
      <section>
        <h3>How it was measured <button class="quiet" onClick={() => saveCsv('reporting.csv', [['item', 'value'], ...rows])}>CSV</button></h3>
        <Wide label="How it was measured"><tbody>{rows.map(([name, value]) => <tr key={name}><th scope="row">{name}</th><td>{value}</td></tr>)}</tbody></Wide>
        <h3>Words</h3>
        <Glossary />
        <h3>What made it</h3>
        <Wide label="What made it"><tbody>
          <tr><th scope="row">Command of step {stepIndex.value}</th><td><code>{told?.command ?? 'not recorded'}</code>{told?.made_in && <> in <code>{told.made_in}</code></>}</td></tr>
          <tr><th scope="row">Versions</th><td>{Object.entries(told?.made_by ?? {hookeye: run.value.version}).map(([k, v]) => `${k} ${v}`).join(', ')}</td></tr>
          <tr><th scope="row">This page</th><td>hookeye {run.value.version}</td></tr>
        </tbody></Wide>
      </section>
      <section>
        <h3>The capture{capture?.title ? `: ${capture.title}` : ''}</h3>
        {capture ? <>
          <Wide label="Load cases of the capture"><thead><tr><th>load case</th><th>use</th><th>supports and loads</th></tr></thead>
            <tbody>{capture.examples.map((e) => (
              <tr key={e.name}><td>{e.name}</td><td>{e.use === 'fit' ? 'fitted' : e.use === 'test' ? 'test' : 'held out'}</td><td>{[...e.supports, ...e.loads].join('; ') || 'none'}</td></tr>
            ))}</tbody></Wide>
          <p>Material {capture.laws.join(', ')}, fitted: {capture.fit.join(', ') || 'nothing'}. Texture: {capture.texture}.
            Cameras: {capture.cameras.map((c) => `${c.name} (${c.width} × ${c.height}, ${c.projection})`).join(', ')}.</p>
          <p class="note">{capture.file}</p>
        </> : <p class="empty">The capture could not be read.</p>}
        <h3>Files{step.value ? ` of ${step.value.folder}` : ''}</h3>
        <Files />
        <Work />
      </section>
    </div>
  );
}
