// What the page shows: the run's document and the choices of the person in front of it.
import {computed, signal} from '@preact/signals';
import type {JobState, PageDocument, StepEntry, TimelineStep} from './document';

export const run = signal<PageDocument>(
  JSON.parse(document.getElementById('document')?.textContent ?? 'null'),
);
export const job = signal<JobState | null>(null);

export const verbs = ['compare', 'fails', 'missing', 'add', 'falls', 'facts'] as const;
export type Verb = (typeof verbs)[number];
export const verbNames: Record<Verb, string> = {
  compare: 'Compare',
  fails: 'Where it fails',
  missing: 'What is missing',
  add: 'Add',
  falls: 'The error falls',
  facts: 'Facts',
};

const fromAddress = location.hash.slice(1) as Verb;
export const verb = signal<Verb>(verbs.includes(fromAddress) ? fromAddress : 'compare');
/** -1: the newest step. */
export const chosenStep = signal(-1);
/** The step that the chosen one is compared with; -1: none. */
export const otherStep = signal(-1);
export const chosenPhoto = signal(0);
export const chosenEffect = signal('');
/** A pixel asked for by another view: shown in the middle. */
export const wantedPixel = signal<{photo: string; x: number; y: number} | null>(null);
export const help = signal(false);
export const theme = signal<'auto' | 'light' | 'dark'>('auto');

export const stepIndex = computed(() => {
  const count = run.value.steps.length;
  return chosenStep.value < 0 ? count - 1 : Math.min(chosenStep.value, count - 1);
});
export const step = computed<StepEntry | undefined>(() => run.value.steps[stepIndex.value]);
export const other = computed<StepEntry | undefined>(() => run.value.steps[otherStep.value]);
/** The timeline's entry of a step, or nothing where run.json does not know it. */
export function timelineOf(entry: StepEntry | undefined): TimelineStep | undefined {
  if (!entry) return undefined;
  const index = Number.parseInt(entry.folder, 10);
  const found = run.value.timeline.steps[index];
  return found && entry.folder.endsWith('-' + found.name) ? found : undefined;
}
export const floor = computed(
  () => run.value.timeline.floor ?? step.value?.metrics?.floor ?? {chi: 1, source: 'noise model'},
);
export const units = computed(
  () => run.value.capture?.units ?? {length: 'length', force: 'force', stress: 'stress'},
);
