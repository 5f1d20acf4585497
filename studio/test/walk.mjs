// Walks report and studio of a small real run in a real browser.
//   node walk.mjs HOOKEYE [FOLDER]     exit status 77: not run, and why
// With FOLDER, screenshots are kept there.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {copyFileSync, cpSync, existsSync, mkdtempSync, readdirSync, readFileSync, renameSync, rmSync, statSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {createRequire} from 'node:module';
import {launch} from './browser.mjs';
import {addedHasIntervals, answerIsFirst, bodyIsWhole, headerIsLow, nothingRunsBesides, phoneSeesAPicture, policyIsClosed} from './answer.mjs';
import {broken, lost, oneCameraOver, withoutSteps} from './damaged.mjs';
import {choiceIsTold, hoverIsNoChoice, removedIsDrawn, whereToLook} from './missing.mjs';
import {smallCapture} from './small_capture.mjs';

const hookeye = process.argv[2];
const shots = process.argv[3];
const axeSource = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const verbs = ['answer', 'compare', 'fails', 'missing', 'add', 'falls', 'facts'];
const folder = mkdtempSync(join(tmpdir(), 'hookeye-page-'));
const run = join(folder, 'run');
const tell = (...args) => execFileSync(hookeye, args, {stdio: ['ignore', 'pipe', 'pipe']}).toString();
const runJson = () => JSON.parse(readFileSync(join(run, 'run.json'), 'utf8'));
let program;
const say = (what) => console.log('ok', what);

const browser = await launch();

/** A page that notes every error and every request that is not allowed to leave. */
async function open(url, size = {width: 1280, height: 800}, colorScheme = 'light') {
  const context = await browser.newContext({viewport: size, colorScheme});
  const page = await context.newPage();
  const faults = [];
  page.on('console', (m) => m.type() === 'error' && faults.push('console: ' + m.text()));
  page.on('pageerror', (e) => faults.push('error: ' + e.message));
  page.on('request', (r) => {
    const to = new URL(r.url());
    const stays = ['file:', 'data:', 'blob:'].includes(to.protocol) || to.hostname === '127.0.0.1';
    if (!stays) faults.push('request to ' + r.url());
  });
  await page.goto(url);
  await page.waitForSelector('[role=tab]');
  return {page, faults, close: () => context.close()};
}

/** Nothing in the page has changed over six frames after which it was idle: what the last act asked for is
 *  drawn, as a report holds all that it draws. The studio fetches it first. */
async function settled(page) {
  if (page.url().startsWith('http')) await page.waitForTimeout(300);
  await page.evaluate(() => new Promise((resolve) => {
    let quiet = 0, frames = 0;
    const watch = new MutationObserver(() => (quiet = 0));
    watch.observe(document, {subtree: true, childList: true, attributes: true, characterData: true});
    const frame = () => requestAnimationFrame(() => requestIdleCallback(() => {
      if (++quiet < 6 && ++frames < 600) return frame();  // what never rests is taken as it is
      watch.disconnect();
      resolve();
    }, {timeout: 1000}));
    frame();
  }));
}

/** Playwright's own waitForFunction needs eval, which the page's policy forbids. */
async function until(page, what, seconds = 30) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; await page.waitForTimeout(300))
    if (await page.evaluate(what)) return;
  throw new Error(`not within ${seconds} s: ${what}`);
}

const firstPaint = async (page) => Math.round(await page.evaluate(() =>
  performance.getEntriesByName('first-contentful-paint')[0]?.startTime));

async function walk(page, name) {
  for (const verb of verbs) {
    await page.click('#tab-' + verb);
    await page.waitForSelector(`#tab-${verb}[aria-selected=true]`);
    await settled(page);
    if (shots) await page.screenshot({path: join(shots, `${name}-${verb}.png`)});
  }
}

/** Of the tabs named, which are those that show what no page before has shown. */
async function accessible(page, tabs = verbs) {
  await page.evaluate(axeSource);
  for (const verb of tabs) {
    await page.click('#tab-' + verb);
    await settled(page);
    const found = await page.evaluate(() => globalThis.axe.run(document, {
      runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa'], resultTypes: ['violations'],
    }));
    const serious = found.violations.filter((v) => ['serious', 'critical'].includes(v.impact));
    assert.deepEqual(serious.map((v) => `${verb}: ${v.id}: ${v.nodes.map((n) => n.target + ' ' + (n.any[0]?.message ?? '')).join(' | ')}`), []);
  }
}

/** Residual of the run's own EXR at a pixel, read by OpenImageIO's tool. */
function residualOf(step, photo, x, y) {
  const text = execFileSync('oiiotool', ['--dumpdata', join(run, 'steps', step, 'residuals', photo + '.exr')],
    {maxBuffer: 1 << 28}).toString();
  return Number(new RegExp(`Pixel \\(${x}, ${y}\\): (\\S+)`).exec(text)[1]);
}

async function pixelsAgree(page) {
  await page.click('#tab-compare');
  const name = 'push-front';
  const index = await page.evaluate((n) => JSON.parse(document.getElementById('document').textContent)
    .photos.findIndex((p) => p.name === n), name);
  await page.click('#photo-' + index);
  await until(page, () => document.querySelectorAll('.panels canvas').length === 3);
  await page.waitForTimeout(600);
  const box = await page.locator('.panels canvas').nth(2).boundingBox();
  let counted = 0;
  for (const [u, v] of [[0.5, 0.5], [0.45, 0.6], [0.4, 0.7], [0.55, 0.4]]) {
    await page.mouse.move(box.x + u * box.width, box.y + v * box.height);
    await page.waitForTimeout(60);
    const said = (await page.textContent('#readout')).replaceAll('−', '-');
    const [, x, y] = /\((\d+), (\d+)\)/.exec(said);
    const shown = /= (-?[\d.]+) σ/.exec(said);
    const stored = residualOf('00-base', name, x, y);
    if (!shown) {
      assert.ok(Number.isNaN(stored), said);
      continue;
    }
    counted += 1;
    assert.ok(Math.abs(Number(shown[1]) - stored) <= 1 / 64 + 0.0051, `${said}, but the EXR holds ${stored}`);
    const photo = Number(/photo ([\d.]+)/.exec(said)[1]), model = Number(/model ([\d.-]+)/.exec(said)[1]);
    assert.ok(Math.abs((model - photo) / 0.008 - stored) < 0.05, said);
  }
  assert.ok(counted >= 2, 'the pointer never met a pixel that counts');
}

async function keyboardOnly(page) {
  await page.evaluate(() => document.activeElement?.blur());
  for (const [key, verb] of [['2', 'fails'], ['3', 'missing'], ['5', 'falls'], ['a', 'answer'], ['1', 'compare']]) {
    await page.keyboard.press(key);
    await page.waitForSelector(`#tab-${verb}[aria-selected=true]`);
  }
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press('Tab');
    if (await page.evaluate(() => document.activeElement?.classList.contains('panels'))) break;
  }
  assert.ok(await page.evaluate(() => document.activeElement?.classList.contains('panels')), 'the pictures cannot be reached by Tab');
  await page.keyboard.press('ArrowRight');
  const before = /\((\d+), (\d+)\)/.exec(await page.textContent('#readout'));
  await page.keyboard.press('Shift+ArrowRight');
  await page.keyboard.press('ArrowDown');
  const after = /\((\d+), (\d+)\)/.exec(await page.textContent('#readout'));
  assert.deepEqual([after[1] - before[1], after[2] - before[2]], [10, 1]);
  await page.keyboard.press('?');
  await page.waitForSelector('dialog.help[open]');
  for (let i = 0; i < 3; ++i) {
    await page.keyboard.press('Tab');
    assert.ok(await page.evaluate(() => document.activeElement === document.body || document.activeElement.closest('dialog')),
      'Tab leaves the open help');
  }
  await page.keyboard.press('Escape');
  await page.waitForSelector('dialog.help[open]', {state: 'detached'});
  assert.ok(await page.evaluate(() => document.activeElement?.classList.contains('panels')), 'the focus is not given back');
}

/** A point of the body, picked by the keyboard, is shown in the photos that see it; one leads there. */
async function pointIsShown(page) {
  await page.click('#tab-fails');
  await page.waitForTimeout(1500);
  await page.focus('.body3d canvas');
  await page.keyboard.press('Enter');
  await page.waitForSelector('.picked button');
  await page.waitForTimeout(600);
  const greys = await page.$$eval('.picked canvas', (all) => all.map((canvas) => {
    const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    return new Set(data).size;
  }));
  assert.ok(greys.length > 0 && greys.every((count) => count > 20), `the photos around the point: ${greys}`);
  const said = await page.textContent('.picked button');
  const [, x, y] = /\((\d+), (\d+)\)/.exec(said);
  await page.click('.picked button');
  await page.waitForSelector('#tab-compare[aria-selected=true]');
  await until(page, () => /^\(\d+, \d+\)/.test(document.getElementById('readout').textContent));
  assert.ok((await page.textContent('#readout')).startsWith(`(${x}, ${y})`), `${said}, but ${await page.textContent('#readout')}`);
}

/** Beside the shown step's residual stands that of the step it is compared with; and what was made to
 *  fit fits again after the whole picture was looked at. */
async function bothStepsAreRead(page) {
  const name = await page.evaluate(() => document.querySelector('.panel figcaption').textContent.replace('photo · ', '').replace(' ', '-'));
  const panel = page.locator('.panels canvas').nth(3);
  const box = await panel.boundingBox();
  for (const [u, v] of [[0.5, 0.5], [0.45, 0.6]]) {
    await page.mouse.move(box.x + u * box.width, box.y + v * box.height);
    await page.waitForTimeout(60);
    const said = (await page.textContent('#readout')).replaceAll('−', '-');
    const [, x, y] = /\((\d+), (\d+)\)/.exec(said);
    const shown = Number(/01-gravity: (-?[\d.]+) σ/.exec(said)?.[1]);
    const stored = residualOf('01-gravity', name, x, y);
    assert.ok(Math.abs(shown - stored) <= 1 / 64 + 0.0051, `${said}, but the EXR of 01-gravity holds ${stored}`);
  }
  await page.mouse.move(2, 2);
  const drawn = () => page.$eval('.panels canvas', (canvas) => canvas.toDataURL());
  await page.click('.toolbar button:text-is("Fit")');
  await page.waitForTimeout(200);
  const before = await drawn();
  await page.click('text=Whole');
  await page.waitForTimeout(200);
  assert.notEqual(await drawn(), before);
  await page.click('.toolbar button:text-is("Fit")');
  await page.waitForTimeout(200);
  assert.equal(await drawn(), before, 'Fit does not fit after Whole');
}

/** What a click makes the page save, as bytes. */
async function saved(page, control) {
  const [download] = await Promise.all([page.waitForEvent('download'), control.click()]);
  return {name: download.suggestedFilename(), bytes: readFileSync(await download.path())};
}

/** Every CSV and PNG button of every view gives a file that is one. */
async function figuresAreSaved(page) {
  let count = 0;
  for (const verb of verbs) {
    await page.click('#tab-' + verb);
    await settled(page);
    for (const control of await page.$$('#view button'))
      if (/^(CSV|PNG|VTU)$/.test((await control.textContent()).trim())) {
        const {name, bytes} = await saved(page, control);
        if (name.endsWith('.png')) assert.equal(bytes.subarray(1, 4).toString(), 'PNG', name);
        else assert.ok(bytes.toString().split('\n').length > 2, `${name} is empty`);
        count += 1;
      }
  }
  assert.ok(count > 20, `only ${count} figures can be saved`);
  say(`${count} figures saved as CSV and PNG`);
}

/** The program's own pictures, and the plan, of the same diagnosis. */
function plannedAndPictured() {
  const step = join(run, 'steps', '00-base');
  const effects = JSON.parse(readFileSync(join(step, 'diagnosis.json'), 'utf8')).effects;
  assert.equal(effects[0].pictures, `removed/${effects[0].effect}`);
  assert.ok(existsSync(join(step, effects[0].pictures, 'push-front.png')));
  const planned = JSON.parse(tell('plan', run, '--between', 'gravity,swelling', '--json'));
  assert.deepEqual(planned.confused, ['gravity', 'swelling']);
  assert.ok(planned.candidates.length > 10);
  assert.ok(planned.candidates[0].worst_pair.evidence >= planned.now.evidence);
  assert.throws(() => tell('plan', run, '--between', 'gravity,swilling'), /did you mean 'swelling'/);
  const lines = tell('plan', run).split('\n');
  const wide = lines.filter((line) => /^ +\d/.test(line) && line.length > 100);
  assert.deepEqual(wide, [], 'a table wider than 100 columns');
  say(`plan: ${planned.sentence}`);
}

async function report() {
  const html = join(folder, 'report.html');
  tell('report', run, '-o', html);
  for (const scheme of ['light', 'dark']) {
    const {page, faults, close} = await open('file://' + html, undefined, scheme);
    console.log(`   first paint after ${await firstPaint(page)} ms`);
    await walk(page, 'report-' + scheme);
    await removedIsDrawn(page);
    await accessible(page);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    assert.deepEqual(faults, []);
    await close();
  }
  const phone = await open('file://' + html, {width: 390, height: 844});
  await walk(phone.page, 'phone');
  await accessible(phone.page);
  assert.ok(await phone.page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'wider than a phone');
  assert.deepEqual(phone.faults, []);
  await phone.close();
  say('the report: five verbs, light, dark and on a phone, no serious fault by axe');
}

async function studio() {
  program = spawn(hookeye, ['studio', run], {stdio: ['ignore', 'pipe', 'inherit']});
  const ended = new Promise((resolve) => program.on('exit', resolve));
  const address = await new Promise((resolve, reject) => {
    let text = '';
    program.stdout.on('data', (more) => {
      text += more;
      const found = /http:\/\/\S+/.exec(text);
      if (found) resolve(found[0]);
    });
    program.on('exit', () => reject(new Error('the studio ended')));
  });
  assert.throws(() => tell('studio', run), /open on this run already/);
  const bad = await fetch(new URL('/', address));
  assert.equal(bad.status, 404);
  assert.equal((await fetch(address + 'add', {method: 'POST', body: '{"effect":"gravity"}'})).status, 403);
  assert.equal((await fetch(address + 'file?name=' + encodeURIComponent('../capture/capture.yaml'))).status, 404);
  assert.equal((await fetch(address + 'part?name=' + encodeURIComponent('field/../../x'))).status, 404);

  let {page, faults, close} = await open(address);
  await pixelsAgree(page);
  say('the pixel under the pointer is the EXR’s');
  await keyboardOnly(page);
  say('keyboard only');
  await page.click('#tab-add');
  await page.click('[data-add=gravity]');
  await page.waitForSelector('.job.running');
  assert.deepEqual(faults, []);
  await close();  // the refit goes on without the page
  ({page, faults, close} = await open(address));
  await page.click('#tab-add');
  await until(page, () => document.querySelector('.job.done, .job.failed'), 300);
  assert.equal(await page.locator('.job.failed').count(), 0, await page.textContent('.job'));
  // rows and verdict arrive one after the other
  await until(page, () => document.querySelectorAll('.steps tbody tr').length === 2 &&
    !document.querySelector('.verdict').textContent.startsWith('not judged yet'), 60);
  const chis = await page.$$eval('.steps tbody tr', (rows) => rows.map((r) => Number(r.cells[1].textContent)));
  const stored = runJson().steps.map((s) => s.chi_fit);
  assert.ok(chis[1] < 0.7 * chis[0], `the error does not fall: ${chis}`);
  chis.forEach((chi, i) => assert.ok(Math.abs(chi - stored[i]) < 1e-3 * stored[i] + 1e-3));
  assert.match(await page.textContent('.verdict'), /^at the noise floor The model with gravity leaves [\d.]+ times the noise floor \(.*on held-out photos\)\. /);
  await walk(page, 'studio');
  await accessible(page);
  assert.deepEqual(faults, []);
  await close();
  program.kill('SIGINT');
  assert.equal(await ended, 0);
  assert.ok(!existsSync(join(run, '.studio')));
  say(`Add gravity by one click: chi ${chis[0]} -> ${chis[1]}, in the page and in run.json; clean end`);
}

/** The finished run's report tells by itself what was compared, what failed, what was missing and
 *  how far the error fell, in the figures of run.json; run.json and the bodies are in it. */
async function retold() {
  const html = join(folder, 'finished.html');
  tell('report', run, '-o', html);
  const {page, faults, close} = await open('file://' + html);
  const {steps} = runJson();
  const told = async (verb) => (await page.textContent('#told-' + verb)).replaceAll('−', '-');
  const number = (text, before) => Number(new RegExp(before + ' ?(-?[\\d.]+)').exec(text)?.[1]);
  const near = (a, b) => assert.ok(Math.abs(a - b) <= 0.006 * Math.abs(b), `${a} is not ${b}`);
  assert.match(await told('compare'), /^6 photos of 3 load cases by 2 cameras, 2 of them held out/);
  near(number(await told('fails'), 'normalised RMS'), steps[0].chi_fit);
  assert.match(await told('missing'), /^gravity would remove \d+ % of the excess misfit/);
  near(number(await told('missing'), 'log Bayes factor'), steps[0].diagnosis.find((e) => e.effect === 'gravity').evidence);
  assert.match(await told('add'), /\+ gravity .*gravity\.z -\d+ mm\/s\^2, 95 % interval/);
  near(number(await told('falls'), 'residual'), steps[0].chi_fit);
  near(number(await told('falls'), '→'), steps[1].chi_fit);
  await addedHasIntervals(page, steps[1]);
  await page.click('#tab-compare');
  await page.waitForSelector('.panel:nth-child(4) canvas');  // both residuals side by side
  await bothStepsAreRead(page);
  await pointIsShown(page);
  await page.click('text=blink');
  await page.click('text=residuals of both steps');
  await page.waitForSelector('figcaption:has-text("residual of 01-gravity")');
  await page.click('text=side by side');
  await hoverIsNoChoice(page, until);
  await figuresAreSaved(page);
  await accessible(page);
  await page.click('#tab-facts');
  const kept = await saved(page, await page.$('.files a[download="run.json"]'));
  assert.equal(JSON.stringify(JSON.parse(kept.bytes.toString())), JSON.stringify(runJson()));
  const body = await saved(page, await page.$('.files a[download="00-base-push.vtu"]'));
  assert.deepEqual(body.bytes, readFileSync(join(run, 'steps', '00-base', 'deformed', 'push.vtu')));
  assert.deepEqual(faults, []);
  await close();
  say('the finished report tells its run, and holds run.json and the deformed bodies');
}

/** A run whose step was chosen by `discover`, which writes what it was chosen from. */
async function chosen() {
  const folderOfRun = join(folder, 'chosen');
  cpSync(run, folderOfRun, {recursive: true});
  const document = runJson();
  const stoodOut = document.steps[0].diagnosis.filter((e) => e.named).map((e) => e.effect);
  document.steps[1].raced = ['gravity', ...stoodOut.filter((e) => e !== 'gravity')]
    .map((effect, i) => ({effect, chi_fit: 0.3 + i, chi_validate: 0.4 + i}));
  writeFileSync(join(folderOfRun, 'run.json'), JSON.stringify(document));
  const html = join(folder, 'chosen.html');
  tell('report', folderOfRun, '-o', html);
  const {page, faults, close} = await open('file://' + html);
  await choiceIsTold(page);
  await accessible(page, ['missing', 'add']);
  assert.deepEqual(faults, []);
  await close();
  say('what was added tells what it was chosen from');
}

/** A run that ended unexplained, because nothing of the catalogue was allowed, shows where to look. */
async function unexplained(capture) {
  const folderOfRun = join(folder, 'unexplained');
  const effects = runJson().steps[0].diagnosis.map((e) => e.effect);
  tell('discover', capture, '-o', folderOfRun, ...effects.flatMap((effect) => ['--without', effect]));
  const html = join(folder, 'unexplained.html');
  tell('report', folderOfRun, '-o', html);
  const told = JSON.parse(readFileSync(join(folderOfRun, 'steps', '00-base', 'free_form.json'), 'utf8'));
  const {page, faults, close} = await open('file://' + html);
  await whereToLook(page, told);
  if (shots) await page.screenshot({path: join(shots, 'unexplained-missing.png'), fullPage: true});
  await accessible(page, ['answer', 'missing']);
  assert.deepEqual(faults, []);
  await close();
  say('what no effect explains is drawn as forces on the body');
}

/** Names as long as people give them do not make any view wider than a phone. */
async function longNames() {
  const long = join(folder, 'long');
  const name = 'gravity_and_many_words_more_that_no_phone_has_room_for';
  cpSync(run, long, {recursive: true});
  renameSync(join(long, 'steps', '01-gravity'), join(long, 'steps', '01-' + name));
  const document = runJson();
  document.steps[1].name = name;
  writeFileSync(join(long, 'run.json'), JSON.stringify(document));
  const html = join(folder, 'long.html');
  tell('report', long, '-o', html);
  const {page, faults, close} = await open('file://' + html, {width: 390, height: 844});
  for (const verb of verbs) {
    await page.click('#tab-' + verb);
    await settled(page);
    const wide = await page.evaluate(() => [document.documentElement, document.querySelector('main')]
      .map((box) => box.scrollWidth - box.clientWidth));
    assert.deepEqual(wide, [0, 0], `${verb} is wider than a phone`);
  }
  await accessible(page);
  assert.deepEqual(faults, []);
  await close();
  say('a long name of a step on a phone');
}

/** Residuals of pure noise, 3 Mpx each: nothing that could be packed well. Each is packed by itself, so
 *  that all may be the same. */
async function large() {
  const big = join(folder, 'big'), noise = join(folder, 'noise.exr');
  cpSync(run, big, {recursive: true});
  execFileSync('oiiotool', ['--create', '1700x1700', '1', '--noise:type=gaussian:mean=0:stddev=3',
    '-d', 'half', '-o', noise]);
  for (const step of readdirSync(join(big, 'steps')))
    for (const file of readdirSync(join(big, 'steps', step, 'residuals')))
      if (file.endsWith('.exr')) copyFileSync(noise, join(big, 'steps', step, 'residuals', file));
  const html = join(folder, 'big.html');
  const {reduction} = JSON.parse(tell('report', big, '-o', html, '--json'));
  const size = statSync(html).size;
  assert.ok(size > 3e6 && size < 30e6, `${size} bytes`);
  assert.match(reduction, /pictures are shrunk to 1\/\d+ of their width; \.vtu files are left out/);
  const {page, faults, close} = await open('file://' + html);
  console.log(`   first paint after ${await firstPaint(page)} ms`);
  assert.ok((await page.textContent('.faults')).includes(reduction));
  await walk(page, 'large');
  assert.deepEqual(faults, []);
  await close();
  say(`a run too large for one file: ${(1e-6 * size).toFixed(1)} MB. ${reduction}`);
}

try {
  const capture = smallCapture(hookeye, folder);
  tell('fit', capture, '-o', run);
  tell('diagnose', run);
  plannedAndPictured();
  await report();
  await studio();
  await retold();
  await chosen();
  await unexplained(capture);
  await longNames();
  await large();
  for (const tried of [broken, lost, withoutSteps, oneCameraOver]) say(await tried({folder, run, tell, open, walk, until}));
} finally {
  if (program?.exitCode === null) program.kill('SIGTERM');
  await browser.close();
  rmSync(folder, {recursive: true, force: true});
}
