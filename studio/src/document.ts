// The document that the program puts into the page (app/report/run_view.cpp writes it).

export interface Quantum {
  step: number;
  zero: number;
}
export interface Picture {
  blob: string;
  shrink: number;
  quantum: Quantum;
}
export interface PhotoEntry {
  name: string;
  example: string;
  camera: string;
  use: 'fit' | 'validate';
  width: number;
  height: number;
  file: string;
  /** Left out where the capture could not be read. */
  photo?: Picture;
  /** Standard deviation of the noise: as a picture, or from the intensity. */
  sigma?: Picture;
  noise?: {read: number; full_well: number; factor: number};
}
export interface ParameterValue {
  name: string;
  unit: string;
  long_name?: string;
  value: number;
  low?: number;
  high?: number;
  /** `open`: a place that may be anywhere along this axis. */
  known?: 'fitted' | 'given' | 'open';
}
export interface EffectScore {
  effect: string;
  testable?: boolean;
  /** Whether the program would name it; runs of older versions do not tell. */
  named?: boolean;
  why_not?: string;
  /** Which guard keeps it from being named, with its figures. */
  why_not_named?: string;
  variant?: string;
  explains?: number;
  explains_held_out?: number;
  dof?: number;
  evidence?: number;
  p_value?: number;
  weight?: number;
  confused_with?: string[];
  confusion?: {effect: string; cosine: number}[];
  why?: string;
  predicted?: ParameterValue[];
}
export interface PhotoFigures {
  example: string;
  camera: string;
  plane: number;
  use: string;
  chi: number;
  rms_px: number;
  pixels: number;
  whiteness_p: number;
  only_noise: boolean;
}
export interface Metrics {
  chi_fit: number;
  chi_validate: number;
  rms_px_fit: number;
  rms_px_validate: number;
  floor: {chi: number; source: string; per_px2?: number};
  photos: PhotoFigures[];
  chi_by_example: Record<string, number>;
  chi_by_camera: Record<string, number>;
  chi_by_region?: Record<string, number>;
  /** The camera that keeps most over the floor of its own rest photos; whether it alone keeps the photos from being
   *  explained. */
  most_over_floor?: {camera: string; times: number; use: string; its_own?: boolean};
  /** How photos of many pixels were read, by camera; left out by older programs. */
  read?: Record<string, {width_over: number; motion_kept: number; tiles: number}>;
  /** What all pixels say of a model that was fitted to a part of them. */
  all_pixels?: AllPixels;
  measured: Measured[];
  undetermined: string[];
  converged: boolean;
  iterations: number;
  mesh: {nodes: number; elements: number; order: number; mean_edge: number};
  energy?: EnergyCurve[];
  ellipticity?: {smallest: number; elements_lost: number; example: string} | null;
  additive?: unknown;  // there: `energy` has the addends of an additive material
}
export interface AllPixels {
  share: number;
  pixels: number;
  read_pixels: number;
  chi_fit: number;
  chi_validate: number | null;
  /** `moved`: by how much all pixels would move it. `added_by_reading`: to the standard error, in quadrature. */
  parameters: {name: string; value: number; moved: number; standard_error: number; standard_error_read: number; added_by_reading: number}[];
}
/** Where the time of one command went (runs/kept_work.h): CPU-seconds by stage and part. */
export interface CommandWork {
  first_step: number;
  steps: number;
  wall_s: number;
  cpu_s: Record<string, Record<string, number>>;
}
export interface Measured {
  example: string;
  kind: string;
  words?: string;
  region: string;
  measured: number[];
  predicted: number[];
  unit?: string;
  sigma: number | number[];
  over_sigma: number[];
}
/** A value of the material; an interval where it was fitted. */
export interface MaterialValue extends ParameterValue {
  known: 'fitted' | 'given' | 'open';
}
/** Nominal stress of a bar over its stretch; null where it has none, a band where the data hold it. */
export interface StressCurve {
  name: string;
  axis: string;
  unit: string;
  stretch: number[];
  value: (number | null)[];
  low: (number | null)[];
  high: (number | null)[];
  visited: [number, number];
}
/** What the fit makes of the material (estimation/output/material_card.h). */
export interface Material {
  cards: {
    region: string;
    law: string;
    parameters: MaterialValue[];
    /** Left out of the second and later ones where laws are blended over the body. */
    small_strain?: MaterialValue[];
    curves?: StressCurve[];
  }[];
  blended: boolean;
  beside: string[];
  depends: string[];
  yaml: string;
}
/** An effect in the newest step's model (runs/report/effect_values.h). */
export interface FoundEffect {
  effect: string;
  says: string;
  /** `factor`: it was fitted as its logarithm. */
  values: (ParameterValue & {factor?: boolean})[];
}
/** What a run has found (runs/report/answer.h). */
export interface Answer {
  material: Material | null;
  headline: string;
  sentence: string;
  misfit: string;
  tested?: string;
  effects?: FoundEffect[];
  /** The material as plain text. */
  text: string;
}
export interface EnergyCurve {
  name: string;
  unit: string;
  axis?: string;  // what `stretch` holds; left out: stretch
  stretch: number[];
  value: number[];
  low: number[];
  high: number[];
  visited?: [number, number];
  at?: Record<string, number>;  // the other component of an addend of two
  beyond?: number;  // elements with a strain beyond the control points, of `elements` over all examples
  elements?: number;
}
export interface TimelineStep {
  name: string;
  added: string | null;
  dropped?: string[];  // effects of earlier steps that the added one made idle
  effects?: string[];  // all that stand in this step's model
  chi_fit: number;
  chi_validate: number | null;
  rms_px_fit: number;
  rms_px_validate: number | null;
  converged?: boolean;
  iterations?: number;
  undetermined?: string[];
  parameters: ParameterValue[];
  diagnosis: EffectScore[];
  gate?: number;
  /** What the added effect was chosen from, best first: left after two steps of a refit, at half size. */
  raced?: {effect: string; chi_fit: number; chi_validate: number | null; floor?: number}[];
  /** Those of them that were refitted to the end: their score less the winner's. */
  rivals?: {effect: string; score: number; chi_fit?: number; chi_validate?: number | null}[];
  command?: string;
  /** The folder that it ran in. */
  made_in?: string;
  made_by?: Record<string, string>;
}
/** One line of decisions.jsonl (estimation/fit/decision.h). */
export interface DecisionLine {
  asked: 'named' | 'screened' | 'refitted' | 'ranked' | 'stands' | 'widened' | 'dropped' | 'swapped' | 'tied' | 'paired' | 'ended' | 'scored';
  candidate: string;
  accepted: boolean;
  value: number | null;
  limit: number | null;
  option: string;
  why: string;
  where: string;
  cpu_s?: number;
}
export interface StepEntry {
  folder: string;
  metrics: Metrics | null;
  /** `energy`: as of the metrics, its bands reaching for the mesh. */
  diagnosis: {effects: EffectScore[]; gate: number; whiteness_p: number; mesh_note?: string; energy?: EnergyCurve[]} | null;
  /** Left out by older programs. */
  decisions?: DecisionLine[];
  residuals: Record<string, Picture>;
  fields: Record<string, string>;
  /** The whole bodies as VTK files; none where a report had no room for them. */
  deformed: {name: string; blob: string}[];
  files: string[];
}
export interface Act {
  region: string;
  text: string;
  /** A support that moves, a force, a pressure; none of them: a support that stands. */
  move?: number[];
  force?: number[];
  pressure?: number;
}
export interface CaptureFacts {
  title: string;
  file: string;
  units: {length: string; force: string; stress: string};
  fit: string[];
  texture: string;
  laws: string[];
  cameras: {name: string; width: number; height: number; projection: string}[];
  examples: {
    name: string;
    use: string;
    supports: string[];
    loads: string[];
    /** The same, to be drawn on the body. */
    acts?: Act[];
    photos: number;
    measured: number;
  }[];
}
export interface PageDocument {
  hookeye: 1;
  page: 1;
  version: string;
  run: string;
  live?: boolean;
  /** The page of `hookeye edit`: a capture, and no run. */
  edit?: boolean;
  answer: Answer;
  timeline: {
    verdict?: string;
    sentence?: string;
    tie?: string[];
    floor?: {chi: number; source: string; per_px2?: number};
    steps: TimelineStep[];
    capture?: string;
  };
  steps: StepEntry[];
  photos: PhotoEntry[];
  capture: CaptureFacts | null;
  practice: {name: string; value: string}[];
  /** Left out by older programs. */
  work?: CommandWork[];
  faults: string[];
  reduction?: string;
}

export interface JobState {
  state: 'idle' | 'running' | 'stopping' | 'done' | 'failed' | 'stopped';
  effect?: string;
  take_back?: boolean;
  stage?: string;
  iteration?: number;
  of?: number;
  chi?: number;
  seconds?: number;
  /** Of the whole work. */
  share?: number;
  seconds_left?: number | null;
  message?: string;
  steps: number;
}
