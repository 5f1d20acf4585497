// What the page shows: the run's document and the choices of the person in front of it.
import {computed, signal} from '@preact/signals';
import type {EffectScore, JobState, PageDocument, PhotoEntry, PhotoFigures, StepEntry, TimelineStep} from './document';
import {keysOf} from './format';

/** Where the capture is not there to tell of its photos, the residuals do; their size is in them. */
export function withPhotos(page: PageDocument): PageDocument {
  if (page.photos.length) return page;
  const told = page.steps.flatMap((step) => step.metrics?.photos ?? []);
  const names = [...new Set(page.steps.flatMap((step) => Object.keys(step.residuals)))];
  const photos = names.sort().map((name): PhotoEntry => {
    const figures = told.find((f) => `${name}-`.startsWith(`${f.example}-${f.camera}-`));
    return {name, example: figures?.example ?? name, camera: figures?.camera ?? '',
      use: figures?.use === 'validate' ? 'validate' : 'fit', width: 0, height: 0, file: ''};
  });
  return {...page, photos};
}
export const run = signal<PageDocument>(
  withPhotos(JSON.parse(document.getElementById('document')?.textContent ?? 'null')),
);
export const job = signal<JobState | null>(null);

export const verbNames = {
  answer: 'Answer',
  compare: 'Compare',
  fails: 'Where it fails',
  missing: 'What is missing',
  add: 'Add',
  falls: 'Error falls',
  facts: 'Facts',
};
export type Verb = keyof typeof verbNames;
export const verbs = keysOf(verbNames);

const fromAddress = location.hash.slice(1) as Verb;
export const verb = signal<Verb>(verbs.includes(fromAddress) ? fromAddress : 'answer');

// A report is read by someone who was not there: it opens where the run began, against where it
// ended. In the studio one works on the newest step.
const newest = run.value.steps.length - 1;
const retold = !run.value.live && newest > 0;
/** -1: the newest step. */
export const chosenStep = signal(retold ? 0 : -1);
/** The step that the chosen one is compared with; -1: none. */
export const otherStep = signal(retold ? newest : -1);
export const chosenEffect = signal('');
/** A pixel asked for by another view: shown in the middle. */
export const wantedPixel = signal<{photo: string; x: number; y: number} | null>(null);
export const help = signal(false);
export const theme = signal<'light' | 'dark'>('light');

export const stepIndex = computed(() => {
  const count = run.value.steps.length;
  return chosenStep.value < 0 ? count - 1 : Math.min(chosenStep.value, count - 1);
});
/** Shows a step. Where that was the one compared with, the two change places. */
export function showStep(index: number): void {
  if (index === otherStep.value) otherStep.value = stepIndex.value;
  chosenStep.value = index === run.value.steps.length - 1 ? -1 : index;
}
export const step = computed<StepEntry | undefined>(() => run.value.steps[stepIndex.value]);
export const other = computed<StepEntry | undefined>(
  () => (otherStep.value === stepIndex.value ? undefined : run.value.steps[otherStep.value]),
);

/** The timeline's entry of a step, or nothing where run.json does not know it. */
export function timelineOf(entry: StepEntry | undefined): TimelineStep | undefined {
  if (!entry) return undefined;
  const index = Number.parseInt(entry.folder, 10);
  const found = run.value.timeline.steps[index];
  return found && entry.folder.endsWith('-' + found.name) ? found : undefined;
}
export function effectsOf(entry: StepEntry | undefined): EffectScore[] {
  return entry?.diagnosis?.effects ?? timelineOf(entry)?.diagnosis ?? [];
}
export function wasTested(effect: EffectScore): boolean {
  return effect.testable !== false && effect.evidence !== undefined;
}
/** Log Bayes factor below which no effect is named (estimation/diagnosis/diagnosis.h: kNameable). */
export function gateOf(entry: StepEntry | undefined): number {
  return Math.max(5, entry?.diagnosis?.gate ?? timelineOf(entry)?.gate ?? 0);
}
/** The program's own word where it gave one: it also asks whether a renderer could err as much. */
export function isNamed(effect: EffectScore, entry: StepEntry | undefined): boolean {
  return wasTested(effect) && (effect.named ?? (effect.evidence ?? 0) >= gateOf(entry));
}
/** Of the catalogue's group `numerical`: they tell of the model's mesh, not of the body. */
export const isNumerical = (effect: string): boolean => effect === 'mesh_resolution';
/** What was added to a step, and by how much its refit beat the best of the others that were refitted. */
export interface Decision {
  added: string;
  /** All that were tried, best first: chi of fitted and held-out photos over the floor, at half size, after two steps of a refit;
   *  the residual itself where the floor is not known. */
  tried: {effect: string; fitted: number; heldOut: number | null; overFloor: boolean}[];
  refitted: string[];
  margin?: number;
}
export function decisionAfter(entry: StepEntry | undefined): Decision | undefined {
  const told = timelineOf(entry);
  const next = told && run.value.timeline.steps[run.value.timeline.steps.indexOf(told) + 1];
  if (!next?.added || next.name.startsWith('without-')) return undefined;
  const others = (next.rivals ?? []).filter((r) => r.effect !== next.added).sort((a, b) => b.score - a.score);
  const tried = (next.raced ?? []).map(({effect, chi_fit, chi_validate, floor}) => ({effect, overFloor: !!floor, fitted: chi_fit / (floor || 1),
    heldOut: chi_validate === null ? null : chi_validate / (floor || 1)}));
  return {added: next.added, tried, refitted: others.map((r) => r.effect), margin: others.length ? -others[0].score : undefined};
}
export function figuresOf(entry: StepEntry | undefined, photo: PhotoEntry): PhotoFigures | undefined {
  return entry?.metrics?.photos.find((f) => f.example === photo.example && f.camera === photo.camera);
}
/** Where the step's misfit is largest. */
export function worstPhoto(entry: StepEntry | undefined): number {
  const chi = run.value.photos.map((photo) => figuresOf(entry, photo)?.chi ?? 0);
  return Math.max(0, chi.indexOf(Math.max(...chi)));
}
export const chosenPhoto = signal(worstPhoto(step.value));

export const floor = computed(
  () => run.value.timeline.floor ?? step.value?.metrics?.floor ?? {chi: 1, source: 'noise model'},
);
/** In the field's words. */
export const floorSource = (source: string): string =>
  source === 'rest photos'
    ? 'the reference images'
    : source === 'loaded photos'
      ? 'what no model could take from the photos'
      : `the ${source}`;
export const units = computed(
  () => run.value.capture?.units ?? {length: 'length', force: 'force', stress: 'stress'},
);
