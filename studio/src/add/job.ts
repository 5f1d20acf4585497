// Talking to the program that serves the page. A refit goes on when this page is closed.
import {effect} from '@preact/signals';
import type {JobState, PageDocument} from '../document';
import {chosenStep, job, run, withPhotos} from '../state';

/** Something is going on, be it only to its end. */
export const busy = (): boolean => job.value?.state === 'running' || job.value?.state === 'stopping';

async function ask<T>(path: string, body?: unknown): Promise<T> {
  const reply = await fetch(path, body === undefined ? {} : {
    method: 'POST',
    headers: {'Content-Type': 'application/json'},
    body: JSON.stringify(body),
  });
  if (!reply.ok) throw new Error((await reply.text()) || reply.statusText);
  return reply.json();
}

export async function reload(): Promise<void> {
  run.value = {...withPhotos(await ask<PageDocument>('document')), live: true};
}

export async function add(name: string, takeBack = false): Promise<void> {
  try {
    job.value = await ask<JobState>('add', {effect: name, take_back: takeBack});
  } catch (error) {
    job.value = {state: 'failed', message: (error as Error).message, steps: run.value.steps.length};
  }
}
/** Says so at once: the program comes to its end in its own time. */
export async function stop(): Promise<void> {
  if (job.value) job.value = {...job.value, state: 'stopping'};
  job.value = await ask<JobState>('stop', {});
}

async function look(): Promise<void> {
  const now = await ask<JobState>('job');
  const was = busy();
  job.value = now;
  const settled = was && !busy();
  if (now.steps !== run.value.steps.length || settled) {
    const more = now.steps > run.value.steps.length;
    await reload();
    if (more) chosenStep.value = -1;
  }
}

/** Asks every second while something is going on, else every four. */
export function follow(): void {
  let timer = 0;
  const next = (): void => {
    clearTimeout(timer);
    timer = window.setTimeout(() => {
      look()
        .catch(() => {
          job.value = {...(job.value ?? {steps: run.value.steps.length}), state: 'failed',
            message: 'hookeye studio does not answer any more; what is shown is kept in the run folder.'};
        })
        .finally(next);
    }, busy() ? 700 : 4000);
  };
  void look().catch(() => undefined).finally(next);
  let was = busy();
  effect(() => {
    const now = busy();
    if (now && !was) next();
    was = now;
  });
}
