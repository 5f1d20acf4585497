// Runs with parts lost, damaged or altered: the page says so and shows the rest. Each tells what it tried.
import assert from 'node:assert/strict';
import {cpSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';

const read = (run) => JSON.parse(readFileSync(join(run, 'run.json'), 'utf8'));

/** run.json cut short, and a step without its metrics. */
export async function broken({folder, run, tell, open, walk}) {
  const half = join(folder, 'half');
  cpSync(run, half, {recursive: true});
  writeFileSync(join(half, 'run.json'), readFileSync(join(half, 'run.json'), 'utf8').slice(0, 400));
  rmSync(join(half, 'steps', '00-base', 'metrics.json'));
  tell('report', half, '-o', join(folder, 'half.html'));
  const {page, faults, close} = await open('file://' + join(folder, 'half.html'));
  await page.waitForSelector('.faults');
  assert.match(await page.textContent('.faults'), /run\.json is damaged/);
  await walk(page, 'half');
  assert.deepEqual(faults, []);
  await close();
  return 'a broken run opens and says what is not there';
}

/** The capture has moved, a body is damaged, a residual is gone: each says so, the rest is shown. */
export async function lost({folder, run, tell, open, walk, until}) {
  const part = join(folder, 'lost');
  cpSync(run, part, {recursive: true});
  const document = read(run);
  document.capture = join(folder, 'moved', 'capture.yaml');
  writeFileSync(join(part, 'run.json'), JSON.stringify(document));
  writeFileSync(join(part, 'steps', '00-base', 'page', 'example-push.json'), '{"damaged');
  rmSync(join(part, 'steps', '00-base', 'residuals', 'push-front.exr'));
  tell('report', part, '-o', join(folder, 'lost.html'));
  const {page, faults, close} = await open('file://' + join(folder, 'lost.html'));
  await page.click('#tab-compare');
  await page.click('.photos li:has-text("push front")');
  await page.waitForSelector('.panel:nth-child(3) .absent');
  assert.equal(await page.textContent('.panel:nth-child(3) .absent'), 'Its residual is not here.');
  await page.click('.photos li:has-text("push left")');
  await until(page, () => document.querySelectorAll('.absent').length === 2);
  await page.click('#tab-fails');
  await page.waitForSelector('.body3d .empty');
  assert.equal(await page.textContent('.body3d .empty'), 'The body in push cannot be read.');
  assert.equal(await page.locator('.thumbnails canvas').count(), 2);
  await walk(page, 'lost');
  assert.deepEqual(faults, []);
  await close();
  return 'a moved capture, a damaged body and a lost residual';
}

export async function withoutSteps({folder, run, tell, open, walk}) {
  const none = join(folder, 'none');
  cpSync(run, none, {recursive: true});
  for (const step of readdirSync(join(none, 'steps'))) rmSync(join(none, 'steps', step), {recursive: true});
  writeFileSync(join(none, 'run.json'), JSON.stringify({hookeye: 1, capture: read(run).capture, steps: []}));
  tell('report', none, '-o', join(folder, 'none.html'));
  const {page, faults, close} = await open('file://' + join(folder, 'none.html'));
  await walk(page, 'none');
  assert.deepEqual(faults, []);
  await close();
  return 'a run without steps';
}

/** All photos together are at the floor, those of one camera are not: nor is the step. */
export async function oneCameraOver({folder, run, tell, open}) {
  const altered = join(folder, 'one-camera');
  cpSync(run, altered, {recursive: true});
  const newest = join(altered, 'steps', readdirSync(join(altered, 'steps')).sort().at(-1), 'metrics.json');
  const metrics = JSON.parse(readFileSync(newest, 'utf8'));
  const {camera, times, its_own} = metrics.most_over_floor;
  assert.ok(Object.hasOwn(metrics.floor.by_camera, camera) && times < 1.3 && !its_own, JSON.stringify(metrics.most_over_floor));
  Object.assign(metrics.most_over_floor, {times: 1.45, its_own: true});
  writeFileSync(newest, JSON.stringify(metrics));
  tell('report', altered, '-o', join(folder, 'one-camera.html'));
  const {page, faults, close} = await open('file://' + join(folder, 'one-camera.html'));
  assert.match(await page.textContent('.verdict'),
    new RegExp(`^above the noise floor.*, but 1.45 times its own in the (fitted|held-out) photos of camera '${camera}'\\. `));
  assert.deepEqual(faults, []);
  await close();
  return 'one camera over its own floor';
}
