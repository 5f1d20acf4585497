// What a run has found: the material, the verdict, the misfit; beside them the photos, and what the
// material does under a pull and under the measured forces.
import {run} from '../state';
import {Said} from '../widgets';
import {FoundEffects} from './effects';
import {MaterialCard} from './material';
import {MeasuredForces, MeasuredTable} from './measured';
import {Shots} from './shots';
import {StressStretch} from './stress';

const capital = (text: string) => `${text[0]?.toUpperCase() ?? ''}${text.slice(1)}`;

/** What discover said in full, where the plain sentence says less. */
function Detail() {
  const {sentence} = run.value.timeline;
  if (!sentence || run.value.answer.sentence.toLowerCase() === sentence.toLowerCase()) return null;
  return <p class="note">In detail: <Said text={sentence} />.</p>;
}

function Verdict() {
  const {headline, sentence, misfit, tested} = run.value.answer;
  return (
    <section class="found">
      <h3>Verdict</h3>
      <p><b>{headline[0]?.toUpperCase()}{headline.slice(1)}.</b> <Said text={sentence} />.</p>
      <Detail />
      <h3>Misfit</h3>
      <p>{misfit ? `${capital(misfit)}.` : 'No step is finished yet.'}</p>
      {tested && <p class="note">{capital(tested)}.</p>}
    </section>
  );
}

export function Answer() {
  const newest = run.value.steps[run.value.steps.length - 1];
  return (
    <div class="answer">
      <section class="card"><MaterialCard /><Verdict /><FoundEffects /></section>
      <Shots />
      <section class="charts"><StressStretch /><MeasuredForces /></section>
      <div class="measured-table"><MeasuredTable all={newest?.metrics?.measured ?? []} /></div>
    </div>
  );
}
