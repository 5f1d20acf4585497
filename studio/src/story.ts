// The run in seven short sentences with figures, for someone who has never seen it.
import type {EffectScore, ParameterValue, StepEntry} from './document';
import {around, figure, listed, logEvidence, percent, spaced} from './format';
import {decisionAfter, effectsOf, figuresOf, floor, gateOf, isNamed, isNumerical, run, timelineOf, units, wasTested, worstPhoto, type Decision, type Verb} from './state';

export interface Told {
  /** In large letters. */
  headline: string;
  sentence: string;
}

const many = (count: number, what: string): string => `${count} ${what}${count === 1 ? '' : 's'}`;

/** What the body is taken for: the addends that a fit found take the place of the capture's law. */
function law(): string {
  const own = run.value.steps[0]?.metrics;
  const addends = own?.additive ? own.energy?.filter((curve) => curve.beyond !== undefined).map((curve) => curve.name) ?? [] : [];
  if (addends.length) return ` whose energy is a sum over ${listed(addends)}`;
  const laws = [...new Set(run.value.capture?.laws ?? [])];
  return laws.length ? ` of ${listed(laws)} law` : '';
}

/** The material's first modulus, and what the run has come to. */
function answered(): Told {
  const {material, headline, sentence} = run.value.answer;
  const card = material?.cards[0];
  const first = card && [...card.parameters, ...(card.small_strain ?? [])].find((v) => v.known === 'fitted' && v.unit);
  return {
    headline: first ? `${first.name} ${around(first.value, first.low, first.high).value} ${first.unit}` : headline,
    sentence: first ? `${headline}. ${sentence}` : sentence,
  };
}

function compared(): Told {
  const {photos} = run.value;
  if (!photos.some((p) => p.photo)) return {headline: 'no photos', sentence: 'They are not here; see what is missing above.'};
  const examples = new Set(photos.map((p) => p.example));
  const heldOut = photos.filter((p) => p.use === 'validate').length;
  return {
    headline: many(photos.length, 'photo'),
    sentence: `of ${many(examples.size, 'load case')} by ${many(new Set(photos.map((p) => p.camera)).size, 'camera')}` +
      `${heldOut ? `, ${heldOut} of them held out,` : ''} against pictures of a model${law()}`,
  };
}

/** `lengthPerPx`: at the worst photo of the base step, when it is known. */
function failed(base: StepEntry, lengthPerPx: number): Told {
  const told = timelineOf(base);
  if (!told) return {headline: '–', sentence: 'run.json does not tell of this step'};
  const over = told.chi_fit / floor.value.chi;
  const worst = run.value.photos[worstPhoto(base)];
  const there = worst && figuresOf(base, worst);
  const length = there && Number.isFinite(lengthPerPx)
    ? ` (${figure(there.rms_px * lengthPerPx, 2)} ${units.value.length})` : '';
  const where = there ? `, most in ${worst.example} by ${worst.camera}: surface off there by ${figure(there.rms_px, 2)} px${length}` : '';
  return {
    headline: `${figure(over, 2)} × noise floor`,
    sentence: `is the residual of the base model (normalised RMS ${figure(told.chi_fit)}, noise floor ${figure(floor.value.chi)})${where}`,
  };
}

/** Which guard keeps an effect from being named, in the program's own words; runs of older versions do not tell. */
export function whyNotNamed(effect: EffectScore, entry: StepEntry | undefined): string {
  if (effect.why_not_named) return effect.why_not_named;
  const gate = gateOf(entry);
  return (effect.evidence ?? 0) < gate
    ? `its log Bayes factor ${logEvidence(effect.evidence)} is below ${figure(gate)}, the 95 % critical value over all effects`
    : 'so small a part of the misfit may be the renderer’s or the mesh’s own error';
}

/** What the refits of the leading effects came to. */
export function decidedBy(added: string, others: string[], margin: number): string {
  const all = ['both', 'all three'][others.length - 1] ?? `all ${others.length + 1}`;
  return `refits of ${all} decided for ${spaced(added)} over ${spaced(others[0])}, by ${figure(margin, 4)}`;
}

/** "1.23 / floor": fitted / held out. */
export function bothOf(tried: Decision['tried'][number]): string {
  // Half-size pictures have their floor from the model before: who is below it is not better than noise.
  const over = (times: number): string => (tried.overFloor && times < 0.995 ? 'floor' : figure(times, 2));
  return over(tried.fitted) + (tried.heldOut === null ? '' : ` / ${over(tried.heldOut)}`);
}

/** What the first steps of a refit came to, where more than one effect was tried. */
export function triedBy({added, tried}: Decision): string {
  const own = tried.find((t) => t.effect === added);
  const next = tried.find((t) => t.effect !== added);
  return own && next
    ? `in the screening it leaves ${bothOf(own)}, ${spaced(next.effect)} ${bothOf(next)} (${own.overFloor ? 'times the noise floor' : 'residual'} of half-size photos)` : '';
}

function sureness(effect: EffectScore, before: StepEntry): string {
  const next = effectsOf(before).filter((e) => wasTested(e) && e.effect !== effect.effect)
    .sort((a, b) => (b.evidence ?? 0) - (a.evidence ?? 0))[0];
  const decision = decisionAfter(before);
  const leads = next && (next.evidence ?? 0) > (effect.evidence ?? 0) ? next.effect : effect.effect;
  const own = decision?.added === effect.effect ? decision : undefined;
  const rest = own?.margin !== undefined ? decidedBy(own.added, own.refitted, own.margin)
    : (own && leads !== effect.effect && triedBy(own)) || next && `next: ${spaced(next.effect)}, ${logEvidence(next.evidence)}`;
  return `would remove ${percent(effect.explains)} of the excess misfit; log Bayes factor ${logEvidence(effect.evidence)}, ` +
    `critical value ${figure(gateOf(before), 2)}` + (rest ? `; ${rest}` : '');
}

/** Share and choice of an effect that was not the only one. */
function chapter(effect: EffectScore, before: StepEntry, index: number): string {
  const decision = decisionAfter(before);
  const share = effect.explains === undefined ? ''
    : index === 0 ? ` ${percent(effect.explains)} of the excess misfit` : ` ${percent(effect.explains)} of the rest`;
  const chosen = decision?.added === effect.effect && decision.margin !== undefined
    ? ` (refits decided, by ${figure(decision.margin, 4)})` : '';
  const mesh = isNumerical(effect.effect) ? ' (the mesh, not the material)' : '';
  return `${index > 0 ? 'then ' : ''}${spaced(effect.effect)}${share}${chosen}${mesh}`;
}

function missing(): Told {
  const {steps, timeline} = run.value;
  const tie = timeline.tie ?? [];
  if (timeline.verdict === 'ambiguous' && tie.length > 1)
    return {headline: tie.map(spaced).join(' or '), sentence: 'these photos cannot tell which; hookeye plan names the photos that can'};
  const standing = timelineOf(steps[steps.length - 1])?.effects;
  const added = steps.flatMap((entry, i) => {
    const name = timelineOf(entry)?.added;
    if (name && standing && !standing.includes(name)) return [];  // a later one made it idle
    const score = i > 0 && name ? effectsOf(steps[i - 1]).find((e) => e.effect === name) : undefined;
    return score ? [{score, before: steps[i - 1]}] : [];
  });
  if (added.length)
    return {headline: listed(added.map((a) => spaced(a.score.effect))),
      sentence: added.length === 1 ? sureness(added[0].score, added[0].before)
        : added.map((a, i) => chapter(a.score, a.before, i)).join(', ')};
  const now = steps[steps.length - 1];
  const tested = effectsOf(now).filter(wasTested);
  const first = tested.find((e) => isNamed(e, now)) ?? tested[0];
  if (!first) return {headline: 'not tested', sentence: 'this run has not been diagnosed'};
  if (isNamed(first, now))
    return {headline: `${spaced(first.effect)}?`, sentence: `leads, not added yet: ${sureness(first, now)}`};
  return {headline: 'nothing', sentence: `of ${effectsOf(now).length} effects stands out. The best, ${spaced(first.effect)}, ` +
    `is not named: ${whyNotNamed(first, now)}`};
}

/** Parameters of the effect that stands at `at`. One that stands more than once (two places, two cameras) has its own names
 *  each time, alike but for the last part. */
function parametersOf(standing: string[], at: number, all: ParameterValue[]): ParameterValue[] {
  const effect = standing[at];
  const own = all.filter((p) => p.name === effect || p.name.startsWith(effect + '.'));
  if (standing.filter((one) => one === effect).length < 2) return own;
  const group = (p: ParameterValue) => p.name.slice(0, p.name.lastIndexOf('.'));
  const groups = [...new Set(own.map(group))];
  const mine = groups[standing.slice(0, at).filter((one) => one === effect).length];
  return own.filter((p) => group(p) === mine);
}

/** An effect's own parameters: the largest with its interval, of the others as many as a tab has room for
 *  when it stands `alone`. */
function valuesOf(effect: string, own: ParameterValue[], alone: boolean): string {
  if (isNumerical(effect)) return 'a finer mesh';
  const [main, ...others] = [...own]
    .sort((a, b) => Math.abs(b.value) - Math.abs(a.value));
  if (!main) return `${spaced(effect)}: no parameter of its own`;
  const {value, interval} = around(main.value, main.low, main.high);
  if (!alone) return `${main.name} ${value} ${main.unit}`;
  const short = others.slice(0, 2).map((p) => `, ${p.name.slice(effect.length + 1)} ${around(p.value, p.low, p.high).value} ${p.unit}`);
  return `${main.name} ${value} ${main.unit}, 95 % interval ${interval}${short.join('')}` +
    (others.length > 2 ? ` and ${others.length - 2} more` : '');
}

function refitted(newest: StepEntry): Told {
  const told = timelineOf(newest);
  if (!told?.added || run.value.steps.length < 2)
    return {headline: 'no effect yet', sentence: 'adding one refits the model with it, from where this fit ended'};
  const takenBack = told.name.startsWith('without-');
  const standing = told.effects ?? (takenBack ? [] : [told.added]);
  const alone = standing.filter((effect) => !isNumerical(effect)).length < 2;
  const values = standing.map((effect, at) => valuesOf(effect, parametersOf(standing, at, told.parameters), alone)).join('; ');
  return {
    headline: takenBack ? `− ${spaced(told.added)}` : standing.map((effect) => `+ ${spaced(effect)}`).join(' '),
    sentence: values ? `refitted from the photos: ${values}` : 'no added effect is left',
  };
}

function fell(base: StepEntry, newest: StepEntry): Told {
  const [a, b] = [timelineOf(base), timelineOf(newest)];
  if (!a || !b) return {headline: '–', sentence: 'run.json does not tell of every step'};
  if (base === newest)
    return {headline: `residual ${figure(b.chi_fit)}`, sentence: `normalised, with one step; the noise floor is ${figure(floor.value.chi)}`};
  const heldOut = a.chi_validate !== null && b.chi_validate !== null
    ? `; held-out photos ${figure(a.chi_validate)} → ${figure(b.chi_validate)}` : '';
  return {
    headline: `residual ${figure(a.chi_fit)} → ${figure(b.chi_fit)}`,
    sentence: `normalised; ${figure(b.chi_fit / floor.value.chi)} times the noise floor${heldOut}; surface off in all fitted photos by ${figure(a.rms_px_fit, 2)} → ${figure(b.rms_px_fit, 2)} px`,
  };
}

export function story(lengthPerPx: number): Record<Verb, Told> {
  const {steps} = run.value;
  const [base, newest] = [steps[0], steps[steps.length - 1]];
  const none = {headline: '–', sentence: 'no step is finished'};
  return {
    answer: answered(),
    compare: compared(),
    fails: base ? failed(base, lengthPerPx) : none,
    missing: base ? missing() : none,
    add: base ? refitted(newest) : none,
    falls: base ? fell(base, newest) : none,
    facts: {headline: 'how measured', sentence: 'noise, filters, units, loads, versions, files'},
  };
}
