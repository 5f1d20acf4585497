// What the person in front of the page has chosen.
import {computed, signal} from '@preact/signals';
import {keysOf} from '../format';
import {capture, faults, type CameraEntry, type CaseEntry, type Fault} from './capture';

export const formNames = {case: 'Load case', regions: 'Regions', faults: 'Faults', text: 'Text'};
export type Form = keyof typeof formNames;
export const forms = keysOf(formNames);
export const form = signal<Form>('case');

export const stages = ['photo', 'body'] as const;
export const stage = signal<(typeof stages)[number]>('photo');

const caseName = signal('');
const cameraName = signal('');
/** Region whose patch is shown; '': all. */
export const region = signal('');
/** Line of the text that is looked at. */
export const wantedLine = signal(0);
/** Triangles of the body's file that are picked. */
export const picked = signal<Set<number>>(new Set());

export const shownCase = computed<CaseEntry | undefined>(() => {
  const all = capture.value?.examples ?? [];
  return all.find((one) => one.name === caseName.value) ?? all[0];
});
export const shownCamera = computed<CameraEntry | undefined>(() => {
  const all = capture.value?.cameras ?? [];
  return all.find((one) => one.name === cameraName.value)
    ?? all.find((one) => shownCase.value?.photos.some((photo) => photo.camera === one.name)) ?? all[0];
});
export const chooseCase = (name: string): void => void (caseName.value = name);
export const chooseCamera = (name: string): void => void (cameraName.value = name);

/** The key at the left margin above a line. */
function sectionOf(line: number): string {
  const lines = capture.value?.text.split('\n') ?? [];
  for (let i = Math.min(line, lines.length) - 1; i >= 0; --i) {
    const found = /^([A-Za-z]\w*):/.exec(lines[i]);
    if (found) return found[1];
  }
  return '';
}
/** Of entries by their first lines, the one that a line belongs to. */
function owner<T extends {line: number}>(all: T[], line: number): T | undefined {
  return all.filter((one) => one.line > 0 && one.line <= line).sort((a, b) => b.line - a.line)[0];
}

export const inFile = (fault: Fault): boolean => fault.line > 0 && fault.file === capture.value?.file;

/** What a fault is about. */
export function subject(fault: Fault): {kind: 'examples' | 'regions' | 'cameras' | ''; name: string} {
  const state = capture.value;
  if (!state || !inFile(fault)) return {kind: '', name: ''};
  const section = sectionOf(fault.line);
  if (section !== 'examples' && section !== 'regions' && section !== 'cameras') return {kind: '', name: ''};
  const found = owner<{line: number; name: string}>(state[section], fault.line);
  return found ? {kind: section, name: found.name} : {kind: '', name: ''};
}

/** Shows a fault where it can be mended: in its form, else in the text. */
export function show(fault: Fault): void {
  const about = subject(fault);
  if (about.kind === 'examples') {
    chooseCase(about.name);
    form.value = 'case';
  } else if (about.kind === 'regions') {
    region.value = about.name;
    form.value = 'regions';
  } else {
    if (about.kind === 'cameras') chooseCamera(about.name);
    showLine(inFile(fault) ? fault.line : 0);
  }
  // The text takes the focus by itself.
  if (form.value !== 'text') requestAnimationFrame(() => document.getElementById('form')?.focus());
}
export function showLine(line: number): void {
  wantedLine.value = line;
  form.value = 'text';
}

export const faultsOf = (kind: 'examples' | 'regions' | 'cameras', name: string): Fault[] =>
  faults.value.filter((fault) => {
    const about = subject(fault);
    return about.kind === kind && about.name === name;
  });
