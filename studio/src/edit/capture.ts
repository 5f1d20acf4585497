// The capture that is edited: what the program tells of it, and what is changed in it.
import {computed, signal} from '@preact/signals';
import {run} from '../state';

export interface Fault {
  file: string;
  line: number;
  column: number;
  wrong: string;
  right: string;
  /** Keeps the capture from being read; else it is a warning. */
  stops: boolean;
}
export interface CameraEntry {
  name: string;
  line: number;
  size: [number, number];
  projection: string;
  /** What its picture of the body depends on. */
  stamp: string;
}
type Vector = [number, number, number];
export interface RegionEntry {
  name: string;
  line: number;
  box?: [Vector, Vector];
  sphere?: {center: Vector; radius: number};
  halfspace?: {point: Vector; normal: Vector};
  faces?: number[];
  file?: string;
  group?: string;
}
export interface SupportEntry {
  region: string;
  line: number;
  /** In the list of the file. */
  number?: number;
  along?: (number | null)[];
  rigid?: 'fit' | {axis: Vector; degrees: number; center: Vector; move: Vector};
}
export interface LoadEntry {
  region: string;
  line: number;
  number?: number;
  force?: Vector;
  pressure?: number;
}
export interface CasePhoto {
  camera: string;
  file: string;
  line: number;
  stamp: string;
}
export interface CaseEntry {
  name: string;
  line: number;
  use: 'fit' | 'validate' | 'test';
  rest: boolean;
  supports: SupportEntry[];
  loads: LoadEntry[];
  photos: CasePhoto[];
  measured: number;
}
interface CheckState {
  state: 'idle' | 'running' | 'done' | 'failed';
  mark?: string;
  message?: string;
  warnings?: string[];
  inspected?: {file: string; line: number; column: number; seen: string; right: string}[];
  cameras?: {camera: string; example: string; overlap: number | null; texture_found: number | null; off_px: number | null}[];
  error?: {file: string; line: number; column: number; wrong?: string; right?: string; message: string};
}
interface Pulse {
  mark: string;
  outside: boolean;
  check: CheckState;
  place: {state: 'idle' | 'running' | 'done' | 'failed' | 'stopped'; message: string};
}
export interface EditState {
  title: string;
  file: string;
  text: string;
  units: {length: string; force: string; stress: string};
  texture_from: string;
  body: string;
  can_undo: boolean;
  can_redo: boolean;
  faults: Omit<Fault, 'stops'>[];
  cameras: CameraEntry[];
  regions: RegionEntry[];
  examples: CaseEntry[];
  pictures: string[];
  pulse: Pulse;
}
export interface Edit {
  path: string[];
  /** On one line, as in the file; left out: it goes. */
  value?: string;
}

export const capture = signal<EditState | null>(null);
export const pulse = signal<Pulse | null>(null);
/** What went wrong with the last change, in the program's words. */
export const refusal = signal('');
export const saving = signal(false);
/** The text as it is typed, until it is saved; null: as it is in the file. */
export const draft = signal<string | null>(null);
/** Of the draft. */
export const draftFaults = signal<Fault[]>([]);

export async function ask(path: string, body?: unknown): Promise<Response> {
  const reply = await fetch(path, body === undefined ? {} : {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(body)});
  if (!reply.ok) throw new Error((await reply.text()) || reply.statusText);
  return reply;
}

function take(state: EditState): void {
  capture.value = state;
  pulse.value = state.pulse;
  // Where lengths are drawn, their unit is told.
  run.value = {...run.value, capture: {...run.value.capture!, units: state.units}};
  document.title = `${state.title || state.file.split('/').slice(-2)[0]} – Hookeye`;
}

/** One change after the other: each is made to the text that the one before has left. */
let last: Promise<unknown> = Promise.resolve();
function change(path: string, body: object): Promise<boolean> {
  saving.value = true;
  const done = last.then(() => changed(path, body));
  last = done;
  return done.finally(() => last === done && (saving.value = false));
}

async function changed(path: string, body: object): Promise<boolean> {
  try {
    take(await (await ask(path, {seen: capture.value?.pulse.mark ?? '', ...body})).json());
    refusal.value = '';
    return true;
  } catch (error) {
    refusal.value = (error as Error).message;
    return false;
  }
}

export const edit = (...edits: Edit[]): Promise<boolean> => change('edit', {edits});
export const writeFaces = (name: string, triangles: number[]): Promise<boolean> => change('faces', {name, triangles});
export const nudge = (camera: string, move: number[], turn: number[]): Promise<boolean> => change('nudge', {camera, move, turn});
export const undo = (): Promise<boolean> => change('undo', {});
export const redo = (): Promise<boolean> => change('redo', {});
export const takeIn = (): Promise<boolean> => change('reload', {});
export async function saveDraft(): Promise<void> {
  const text = draft.value;
  if (text !== null && (await change('text', {text})) && draft.value === text) draft.value = null;
}

let trying = 0;
/** What stands in the field for text, whose lines end as browsers end them. */
export const shownText = (): string => (draft.value ?? capture.value?.text ?? '').replaceAll('\r\n', '\n');
export function typed(inField: string): void {
  const text = capture.value?.text.includes('\r\n') ? inField.replaceAll('\n', '\r\n') : inField;
  draft.value = text === capture.value?.text ? null : text;
  draftFaults.value = [];
  clearTimeout(trying);
  if (draft.value === null) return;
  trying = window.setTimeout(() => {
    ask('try', {text}).then((reply) => reply.json()).then(({faults}: {faults: Fault[]}) => {
      if (draft.value === text) draftFaults.value = faults.map((fault) => ({...fault, stops: true}));
    }).catch(() => undefined);
  }, 500);
}

/** Asks every second whether the file, or what `check` says of it, has changed. */
export function follow(): void {
  const look = async (): Promise<void> => {
    const now: Pulse = await (await ask('pulse')).json();
    if (!saving.value && now.mark !== capture.value?.pulse.mark) take(await (await ask('state')).json());
    else pulse.value = now;
  };
  const next = (): void => void setTimeout(() => {
    look().catch(() => (refusal.value = '`hookeye edit` does not answer any more. What was changed is in the file.')).finally(next);
  }, 1000);
  ask('state').then((reply) => reply.json()).then(take).catch((error: Error) => (refusal.value = error.message)).finally(next);
}

const placed = /^(.*?):(\d+):(?:(\d+):)? (.*)$/s;
/** A warning of `check`, whose place stands in front where it has one. */
function warning(text: string): Fault {
  const found = placed.exec(text);
  const words = found ? found[4] : text, at = words.lastIndexOf('; ');
  return {file: found?.[1] ?? '', line: Number(found?.[2] ?? 0), column: Number(found?.[3] ?? 0),
    wrong: at < 0 ? words : words.slice(0, at), right: at < 0 ? '' : words.slice(at + 2), stops: false};
}

/** All that is wrong with the text in the file, and what `check` warns of. */
export const faults = computed<Fault[]>(() => {
  const state = capture.value, check = pulse.value?.check;
  if (!state) return [];
  const out = state.faults.map((fault) => ({...fault, stops: true}));
  if (!check || check.state !== 'done' || check.mark !== state.pulse.mark) return out;
  if (check.error && !out.length)
    out.push({...check.error, wrong: check.error.wrong ?? check.error.message, right: check.error.right ?? '', stops: true});
  const inspected = check.inspected ?? [];
  for (const one of inspected) out.push({...one, wrong: one.seen, stops: false});
  for (const text of check.warnings ?? [])
    if (!inspected.some((one) => text.includes(one.seen))) out.push(warning(text));
  return out;
});

/** `check` has looked at the newest text and found nothing that stops it. */
export const passes = computed(() => {
  const check = pulse.value?.check;
  return check?.state === 'done' && check.mark === capture.value?.pulse.mark && !faults.value.some((fault) => fault.stops);
});

/** A name as a word of yaml. */
export const word = (name: string): string =>
  /^[A-Za-z][\w.-]*$/.test(name) && !/^(y|n|yes|no|on|off|true|false|null)$/i.test(name) ? name : JSON.stringify(name);
/** A number with no more digits than it is worth. */
export const plain = (value: number): string => String(Number(value.toPrecision(6)));
export const vector = (v: ArrayLike<number>): string => `[${Array.from(v, plain).join(', ')}]`;
