// The run in six short sentences with figures, for someone who has never seen it.
import type {EffectScore, StepEntry} from './document';
import {around, figure, listed, percent, spaced} from './format';
import {effectsOf, figuresOf, floor, gateOf, run, timelineOf, units, wasTested, worstPhoto, type Verb} from './state';

export interface Told {
  /** In large letters. */
  headline: string;
  sentence: string;
}

const many = (count: number, what: string): string => `${count} ${what}${count === 1 ? '' : 's'}`;

/** What the body is taken for: the addends that a fit found take the place of the capture's law. */
function law(): string {
  const addends = run.value.steps[0]?.metrics?.energy?.map((curve) => curve.name) ?? [];
  if (addends.length) return ` whose energy is a sum over ${listed(addends)}`;
  const laws = [...new Set(run.value.capture?.laws ?? [])];
  return laws.length ? ` of ${listed(laws)} law` : '';
}

function compared(): Told {
  const {photos} = run.value;
  if (!photos.length) return {headline: 'no photos', sentence: 'They are not here; see what is missing above.'};
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
  const where = there ? `, most in ${worst.example} by ${worst.camera}: surface off by ${figure(there.rms_px, 2)} px${length}` : '';
  return {
    headline: `${figure(over, 2)} × noise floor`,
    sentence: `is the misfit of the base model (χ ${figure(told.chi_fit)}, floor ${figure(floor.value.chi)})${where}`,
  };
}

function sureness(effect: EffectScore, before: StepEntry): string {
  const next = effectsOf(before).filter((e) => wasTested(e) && e.effect !== effect.effect)
    .sort((a, b) => (b.evidence ?? 0) - (a.evidence ?? 0))[0];
  return `would remove ${percent(effect.explains)} of the misfit; log evidence ${figure(effect.evidence)} ` +
    `where ${figure(gateOf(before), 2)} is enough` + (next ? `; next: ${spaced(next.effect)}, ${figure(next.evidence)}` : '');
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
        : added.map((a) => `${spaced(a.score.effect)}: ${percent(a.score.explains)}, log evidence ${figure(a.score.evidence)}`).join('; ')};
  const now = steps[steps.length - 1];
  const first = effectsOf(now).filter(wasTested)[0];
  if (!first) return {headline: 'not tested', sentence: 'this run has not been diagnosed'};
  return (first.evidence ?? 0) >= gateOf(now)
    ? {headline: `${spaced(first.effect)}?`, sentence: `leads, not added yet: ${sureness(first, now)}`}
    : {headline: 'nothing', sentence: `of ${effectsOf(now).length} effects stands out: the best, ${spaced(first.effect)}, ` +
        `has log evidence ${figure(first.evidence)}, below the ${figure(gateOf(now), 2)} of chance`};
}

function refitted(newest: StepEntry): Told {
  const told = timelineOf(newest);
  if (!told?.added || run.value.steps.length < 2)
    return {headline: 'no effect yet', sentence: 'adding one refits the model with it, from where this fit ended'};
  const own = told.parameters.filter((p) => p.name.startsWith(told.added!));
  const main = (own.length ? own : told.parameters).slice().sort((a, b) => Math.abs(b.value) - Math.abs(a.value))[0];
  if (!main) return {headline: spaced(told.added), sentence: 'added'};
  const {value, interval} = around(main.value, main.low, main.high);
  return {
    headline: told.name.startsWith('without-') ? `− ${spaced(told.added)}` : `+ ${spaced(told.added)}`,
    sentence: `refitted from the photos: ${main.name} ${value} ${main.unit}, 95 % interval ${interval}`,
  };
}

function fell(base: StepEntry, newest: StepEntry): Told {
  const [a, b] = [timelineOf(base), timelineOf(newest)];
  if (!a || !b) return {headline: '–', sentence: 'run.json does not tell of every step'};
  if (base === newest) return {headline: `χ ${figure(b.chi_fit)}`, sentence: `with one step; the noise floor is ${figure(floor.value.chi)}`};
  const heldOut = a.chi_validate !== null && b.chi_validate !== null
    ? `; held-out photos ${figure(a.chi_validate)} → ${figure(b.chi_validate)}` : '';
  return {
    headline: `χ ${figure(a.chi_fit)} → ${figure(b.chi_fit)}`,
    sentence: `${figure(b.chi_fit / floor.value.chi)} times the floor${heldOut}; surface off by ${figure(a.rms_px_fit, 2)} → ${figure(b.rms_px_fit, 2)} px`,
  };
}

export function story(lengthPerPx: number): Record<Verb, Told> {
  const {steps} = run.value;
  const [base, newest] = [steps[0], steps[steps.length - 1]];
  const none = {headline: '–', sentence: 'no step is finished'};
  return {
    compare: compared(),
    fails: base ? failed(base, lengthPerPx) : none,
    missing: base ? missing() : none,
    add: base ? refitted(newest) : none,
    falls: base ? fell(base, newest) : none,
    facts: {headline: 'how measured', sentence: 'noise, filters, units, loads, versions, files'},
  };
}
