// Walks `hookeye edit` in a real browser: from a capture without regions, supports and loads, and with a
// fault, to one that passes `check`. By the mouse on a screen, by the keyboard alone on a phone.
//   node edit.mjs HOOKEYE [FOLDER]     exit status 77: not run, and why
// With FOLDER, screenshots are kept there.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {launch} from './browser.mjs';
import {smallCapture} from './small_capture.mjs';

const [hookeye, shots] = process.argv.slice(2);
const axeSource = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const folder = mkdtempSync(join(tmpdir(), 'hookeye-edit-'));
const say = (what) => console.log('ok', what);
const forms = ['case', 'regions', 'faults', 'text'];
let program;

const browser = await launch();

async function open(url, size, colorScheme = 'light') {
  const context = await browser.newContext({viewport: size, colorScheme});
  const page = await context.newPage();
  const faults = [];
  // A refused change is answered with 400, which the browser logs by itself.
  page.on('console', (m) => m.type() === 'error' && !/status of 400/.test(m.text()) && faults.push('console: ' + m.text()));
  page.on('pageerror', (e) => faults.push('error: ' + e.message));
  page.on('request', (r) => {
    const to = new URL(r.url());
    if (!['data:', 'blob:'].includes(to.protocol) && to.hostname !== '127.0.0.1') faults.push('request to ' + r.url());
  });
  await page.goto(url);
  await page.waitForSelector('main.editor');
  return {page, faults, close: () => context.close()};
}

async function until(page, what, seconds = 60) {
  for (const end = Date.now() + 1000 * seconds; Date.now() < end; await page.waitForTimeout(200))
    if (await page.evaluate(what)) return;
  throw new Error(`not within ${seconds} s: ${what}; the page says ${await page.textContent('.verdict-button')} ${(await page.$$eval('.notice', (all) => all.map((one) => one.textContent))).join(' ')}`);
}
const saved = (page) => until(page, () => [...document.querySelectorAll('.tools .note')].some((one) => one.textContent === 'saved'));
const shot = async (page, name) => shots && page.screenshot({path: join(shots, `edit-${name}.png`)});

async function accessible(page, name) {
  await page.evaluate(axeSource);
  for (const form of forms) {
    await page.click('#tab-' + form);
    await page.waitForTimeout(300);
    await shot(page, `${name}-${form}`);
    const found = await page.evaluate(() => globalThis.axe.run(document, {runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa'], resultTypes: ['violations']}));
    const serious = found.violations.filter((v) => ['serious', 'critical'].includes(v.impact));
    assert.deepEqual(serious.map((v) => `${form}: ${v.id}: ${v.nodes.map((n) => n.target + ' ' + (n.any[0]?.message ?? '')).join(' | ')}`), []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${form} is wider than the screen`);
  }
}

/** The sample's capture with its photos, mesh and cameras; of the rest only what a folder tells. */
function bare(whole) {
  const rest = whole.slice(0, whole.indexOf('regions:'));
  const shots = (name) => `  ${name}:   # photos of ${name}\n    photos: {front: photos/${name}_front.png, left: photos/${name}_left.png}\n`;
  return rest.replace('law: neo-hookean', 'lau: neo-hookean') + 'examples:\n' + shots('rest') + shots('push') + shots('pull');
}

function serve(capture) {
  program = spawn(hookeye, ['edit', capture], {stdio: ['ignore', 'pipe', 'inherit']});
  return new Promise((resolve, reject) => {
    let text = '';
    program.stdout.on('data', (more) => {
      text += more;
      const found = /http:\/\/\S+/.exec(text);
      if (found) resolve(found[0]);
    });
    program.on('exit', () => reject(new Error('the editor ended')));
  });
}
async function end() {
  const ended = new Promise((resolve) => program.on('exit', resolve));
  program.kill('SIGINT');
  assert.equal(await ended, 0);
}

/** The fault in the text is listed, a click leads to its line, and it is mended there. */
async function faultIsMended(page, read) {
  assert.equal(await page.textContent('.verdict-button'), '1 fault');
  await page.click('.verdict-button');
  assert.match(await page.textContent('.faults-found li'), /lau/);
  await shot(page, 'fault');
  await page.click('.faults-found button.fault');
  await page.waitForSelector('#tab-text[aria-selected=true]');
  await page.waitForTimeout(300);
  const selected = await page.$eval('textarea', (box) => box.value.slice(box.selectionStart, box.selectionEnd));
  assert.match(selected, /lau: neo-hookean/);
  await page.waitForSelector('.in-line .stops');
  await shot(page, 'fault-in-text');
  await page.keyboard.insertText(selected.replace('lau:', 'low:'));
  await until(page, () => /1 fault of reading/.test(document.querySelector('.text-pane .note').textContent));
  assert.match(read(), /lau: neo-hookean/, 'what is typed is not written before it is saved');
  await page.click('text=Discard');
  await page.$eval('textarea', (box) => {
    const at = box.value.indexOf('lau:');
    box.focus();
    box.setSelectionRange(at, at + 4);
  });
  await page.keyboard.insertText('law:');
  await page.keyboard.press('Control+s');
  await saved(page);
  assert.match(read(), /law: neo-hookean/);
  say('a fault is listed, found by a click, and mended in the text');
}

/** Where the canvas shows the photo's pixel. */
async function pixel(page, x, y, width = 200) {
  const box = await page.locator('.panels canvas').boundingBox();
  const scale = Math.min(box.width, box.height) / width;
  return [box.x + box.width / 2 + (x - (width - 1) / 2) * scale, box.y + box.height / 2 + (y - (width - 1) / 2) * scale];
}

/** The drawn outline is where the photo's body ends: along a row the photo is bright inside of it, dark outside. */
async function outlineIsThere(page) {
  await page.uncheck('text=loads');
  await page.waitForTimeout(500);
  const found = await page.$eval('.panels canvas', (canvas) => {
    const context = canvas.getContext('2d');
    const {data, width, height} = context.getImageData(0, 0, canvas.width, canvas.height);
    let orange = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i] > 200 && data[i + 1] > 90 && data[i + 1] < 170 && data[i + 2] < 90) ++orange;
    return {orange, pixels: width * height};
  });
  assert.ok(found.orange > 300, `an outline of ${found.orange} pixels`);
  await page.check('text=loads');
}

async function regionByClick(page, name, x, y, read) {
  await page.click('#tab-regions');
  await page.mouse.click(...await pixel(page, x, y));
  await until(page, () => Number(document.querySelector('form.add p[role=status] b')?.textContent) === 2);
  await page.fill('form.add label:has-text("Name") input', name);
  await shot(page, 'picked-' + name);
  await page.click('form.add button[type=submit]');
  await until(page, `document.querySelector('.regions')?.textContent.includes(${JSON.stringify(name)})`);
  assert.match(read(), new RegExp(`"?${name}"?: \\{(box|faces)`));
}

async function act(page, region, kind, values) {
  const form = 'form[aria-label="Add a support or a load"]';
  await page.selectOption(`${form} label:has-text("On") select`, region);
  await page.selectOption(`${form} [aria-label=Kind]`, kind);
  for (const [i, value] of values.entries()) await page.fill(`${form} .vector input >> nth=${i}`, value);
  const before = await page.locator('.acts .act').count();
  await page.click(`${form} button[type=submit]`);
  await until(page, `document.querySelectorAll('.acts .act').length === ${before + 1}`);
}

async function byMouse(address, read) {
  const {page, faults, close} = await open(address, {width: 1280, height: 800});
  await faultIsMended(page, read);
  await page.waitForTimeout(1500);
  await outlineIsThere(page);
  assert.match(await page.textContent('.legend'), /outline of the body at rest/);
  await regionByClick(page, 'top', 103, 37, read);
  assert.match(await page.textContent('.legend'), /region top/);
  await page.click('button:text-is("Body in space")');
  await page.waitForTimeout(800);
  await page.click('#tab-regions');
  await page.click('.choice button:text-is("−z")');
  await page.fill('form.add label:has-text("Name") input', 'base');
  await page.click('form.add button[type=submit]');
  await until(page, () => document.querySelectorAll('.regions .act').length === 2);
  await page.click('#tab-case');
  const loads = {push: ['1.0', '0.3', '0'], pull: ['0', '0.5', '2.5']};
  for (const name of ['rest', 'push', 'pull']) {
    await page.selectOption('.choose select', name);
    await act(page, 'base', 'hold', ['0', '0', '0']);
    if (loads[name]) await act(page, 'top', 'force', loads[name]);
  }
  await shot(page, 'loads-in-space');
  await page.click('.uses input[value=validate]');
  await until(page, () => document.querySelector('.uses input[value=validate]').checked);
  await saved(page);
  assert.match(read(), /pull:   # photos of pull\n(.*\n)*    "?use"?: validate/);
  await page.click('button:text-is("Body over photo")');
  await page.waitForTimeout(1000);
  await shot(page, 'loads-over-photo');
  await until(page, () => document.querySelector('.verdict-button').textContent.startsWith('passes check'), 120);
  say(`by the mouse: ${await page.textContent('.verdict-button')}`);
  await accessible(page, 'light');
  assert.deepEqual(faults, []);
  await close();
}

/** Small steps of the body are written, and taken back by the keyboard; the picture follows. */
async function nudgedAndBack(page, read) {
  const before = read();
  await page.click('#tab-faults');
  const drawn = () => page.$eval('.panels canvas', (canvas) => canvas.toDataURL());
  const first = await drawn();
  await page.selectOption('.nudge select', '25');
  await page.click('.nudge button[aria-label="Move right"]');
  await saved(page);
  await page.waitForTimeout(1500);
  assert.match(read(), /\n  placement: \{rotation: /);
  assert.notEqual(await drawn(), first);
  await shot(page, 'nudged');
  await until(page, () => /1? ?warning/.test(document.querySelector('.verdict-button').textContent) || /pose|silhouette|overlap/.test(document.querySelector('.faults-found').textContent), 120);
  await page.keyboard.press('Control+z');
  await saved(page);
  assert.equal(read(), before);
  await page.keyboard.press('Control+y');
  await saved(page);
  assert.match(read(), /placement/);
  await page.keyboard.press('Control+z');
  await saved(page);
  assert.equal(read(), before);
  say('a pose that is off by 25 px is drawn, and taken back');
}

/** How far the told placement takes the body's middle. */
function displaced(text) {
  const [, rows, t] = /placement: \{rotation: (\[\[.*?\]\]), translation: (\[.*?\])/.exec(text).map((one, i) => (i ? JSON.parse(one) : one));
  const middle = [0, 0, 20];
  return Math.hypot(...rows.map((row, i) => row.reduce((sum, r, k) => sum + r * middle[k], t[i]) - middle[i]));
}
/** The pixel of the front camera in which a point stands that the capture's own pose tells. */
function pixelOf(text, point) {
  const [, rows, t] = /front:[^]*?rotation: (\[\[.*?\]\]), translation: (\[.*?\])/.exec(text).map((one, i) => (i ? JSON.parse(one) : one));
  const [x, y, z] = rows.map((row, i) => row.reduce((sum, r, k) => sum + r * point[k], t[i]));
  return [480 * x / z + 99.5, 480 * y / z + 99.5];
}
/** What is told of an earlier pose may stand there still: the capture itself tells when this one is found. */
async function placed(page, button, read) {
  const before = read();
  await page.click(button);
  for (const end = Date.now() + 180000; read() === before || !displaced(read()); await page.waitForTimeout(200))
    assert.ok(Date.now() < end, 'no pose was found within 180 s');
  await until(page, () => /Turned by/.test(document.querySelector('.pose .note')?.textContent ?? ''));
  return displaced(read());
}

/** A pose that is off is found by the outline, and by pairs of points and pixels. */
async function poseIsFound(page, read) {
  const before = read();
  await page.click('.nudge button[aria-label="Move right"]');
  await saved(page);
  const off = displaced(read());
  assert.ok(off > 5, `moved by ${off}`);
  const byOutline = await placed(page, '.pose button:text-is("by the outline")', read);
  assert.ok(byOutline < 1.5, `by the outline the body is ${byOutline} mm off`);
  await page.click('button:text-is("Undo")');
  await saved(page);
  assert.equal(displaced(read()), off);
  await page.click('.pose button:has-text("by pairs")');
  for (const [dx, dy] of [[0, 0], [-50, -90], [60, 60], [-40, 120], [70, -100], [10, -40]]) {
    await page.waitForTimeout(1200);
    const box = await page.locator('.body3d canvas').first().boundingBox();
    await page.mouse.click(box.x + box.width / 2 + dx, box.y + box.height / 2 + dy);
    await until(page, () => /now click/.test(document.querySelector('.pairs-picked .note').textContent));
    const said = (await page.textContent('.pairs-picked .note')).replaceAll('−', '-');
    const point = JSON.parse(`[${/\((.*?)\)/.exec(said)[1]}]`);
    await page.waitForTimeout(800);
    await page.mouse.click(...await pixel(page, ...pixelOf(before, point)));
    await until(page, () => !/now click/.test(document.querySelector('.pairs-picked .note').textContent));
    await page.click('text=Next point');
  }
  await shot(page, 'pairs');
  await page.click('button:text-is("Body over photo")');
  const byPairs = await placed(page, '.pose button:has-text("Place by 6 pairs")', read);
  assert.ok(byPairs < 1.5, `by pairs the body is ${byPairs} mm off`);
  await page.waitForTimeout(1000);
  await shot(page, 'placed');
  await page.click('.pose button:has-text("by pairs …")');
  for (let i = 0; i < 2; ++i) {
    await page.click('button:text-is("Undo")');
    await saved(page);
  }
  assert.equal(read(), before);
  say(`a pose ${off.toFixed(1)} mm off is found: to ${byOutline.toFixed(2)} mm by the outline, to ${byPairs.toFixed(2)} mm by six pairs`);
}

/** Another program's change is told, taken in on a click, and undone to what was here. */
async function outsideIsTold(page, file, read) {
  const mine = read(), theirs = mine + '# theirs\n';
  writeFileSync(file, theirs);
  await page.waitForSelector('.notice:has-text("Another program")');
  await page.click('#tab-case');
  await page.click('.uses input[value=test]');
  await page.waitForSelector('.notice.failed');
  assert.equal(read(), theirs, 'it was written over');
  await shot(page, 'outside');
  await page.click('text=Take its text in');
  await page.waitForSelector('.notice:has-text("Another program")', {state: 'detached'});
  await page.click('button:text-is("Undo")');
  await saved(page);
  assert.equal(read(), mine);
  say('a change by another program is told, and nothing is written over it');
}

async function inTheDark(address, file, read) {
  const {page, faults, close} = await open(address, {width: 1280, height: 800}, 'dark');
  await page.waitForTimeout(1500);
  await nudgedAndBack(page, read);
  await poseIsFound(page, read);
  await outsideIsTold(page, file, read);
  await page.click('button:text-is("Blink")');
  await page.waitForTimeout(700);
  await page.click('button:text-is("Blink")');
  await accessible(page, 'dark');
  assert.deepEqual(faults, []);
  await close();
}

/** Tab leads to an element; then keys are pressed. */
async function tabTo(page, selector) {
  for (let i = 0; i < 160; ++i) {
    if (await page.evaluate((wanted) => document.activeElement?.matches(wanted), selector)) return;
    await page.keyboard.press('Tab');
  }
  throw new Error(`${selector} cannot be reached by Tab`);
}
async function typedInto(page, selector, text) {
  await tabTo(page, selector);
  await page.keyboard.press('Control+a');
  await page.keyboard.type(text);
}

async function byKeyboard(address, read) {
  const {page, faults, close} = await open(address, {width: 390, height: 844});
  await page.waitForTimeout(1000);
  assert.equal(await page.$eval('.legend', (box) => box.open), false, 'the legend takes the room of the photo');
  await page.keyboard.press('4');
  await tabTo(page, 'textarea');
  await page.keyboard.press('Control+Home');
  await page.evaluate(() => {
    const box = document.activeElement, at = box.value.indexOf('lau:');
    box.setSelectionRange(at, at + 4);
  });
  await page.keyboard.type('law:');
  await page.keyboard.press('Control+s');
  await saved(page);
  await page.evaluate(() => document.activeElement.blur());
  for (const [name, sign] of [['base', '−z'], ['top', '+z']]) {
    await page.keyboard.press('2');
    await tabTo(page, '.choice[aria-label="End of the body"] button');
    for (let i = 0; i < 6 && (await page.evaluate(() => document.activeElement.textContent)) !== sign; ++i) await page.keyboard.press('Tab');
    await page.keyboard.press('Enter');
    await typedInto(page, 'form.add label input:not([type])', name);
    await page.keyboard.press('Enter');
    await until(page, `document.querySelector('.regions').textContent.includes(${JSON.stringify(name)})`);
    await page.evaluate(() => document.activeElement.blur());
  }
  await page.keyboard.press('1');
  const add = 'form[aria-label="Add a support or a load"]';
  for (const force of [null, ['1', '0.3', '0'], ['0', '0.5', '2.5']]) {
    await tabTo(page, `${add} label:first-of-type select`);
    await page.keyboard.type('base');
    await tabTo(page, `${add} select[aria-label=Kind]`);
    await page.keyboard.type('held');
    await tabTo(page, `${add} button[type=submit]`);
    await page.keyboard.press('Enter');
    await until(page, () => document.querySelectorAll('.acts .act').length === 1);
    if (force) {
      await page.evaluate(() => document.activeElement.blur());
      await tabTo(page, `${add} label:first-of-type select`);
      await page.keyboard.type('top');
      await tabTo(page, `${add} select[aria-label=Kind]`);
      await page.keyboard.type('force');
      for (const [i, value] of force.entries()) await typedInto(page, `${add} .vector input:nth-of-type(${i + 1})`, value);
      await page.keyboard.press('Enter');
      await until(page, () => document.querySelectorAll('.acts .act').length === 2);
    }
    await page.evaluate(() => document.activeElement.blur());
    if (force?.[2] === '2.5') break;
    await page.keyboard.press('n');
    await page.waitForTimeout(300);
  }
  await tabTo(page, '.uses input');
  await page.keyboard.press('ArrowDown');
  await until(page, () => document.querySelector('.uses input[value=validate]').checked);
  await saved(page);
  assert.match(read(), /pull:(.*\n)*    "?use"?: validate/);
  await until(page, () => document.querySelector('.verdict-button').textContent.startsWith('passes check'), 120);
  say(`by the keyboard on a phone: ${await page.textContent('.verdict-button')}`);
  await accessible(page, 'phone');
  assert.deepEqual(faults, []);
  await close();
}

try {
  const capture = smallCapture(hookeye, folder);
  const file = join(capture, 'capture.yaml');
  const read = () => readFileSync(file, 'utf8');
  const whole = read();
  writeFileSync(file, bare(whole));
  const address = await serve(capture);
  assert.equal((await fetch(address + 'undo', {method: 'POST', body: '{}'})).status, 403);
  await byMouse(address, read);
  await inTheDark(address, file, read);
  await end();
  assert.ok(!readdirSync(capture).some((name) => name.startsWith('.')), 'something is left behind');
  const checked = JSON.parse(execFileSync(hookeye, ['check', '--quick', '--json', capture]).toString());
  assert.deepEqual(checked.examples.map((one) => [one.supports.length, one.loads.length, one.use]), [[1, 0, 'fit'], [1, 1, 'fit'], [1, 1, 'validate']]);
  writeFileSync(file, bare(whole));
  await byKeyboard(await serve(capture), read);
  await end();
  const again = JSON.parse(execFileSync(hookeye, ['check', '--quick', '--json', capture]).toString());
  assert.deepEqual(again.examples.map((one) => one.loads), checked.examples.map((one) => one.loads));
  assert.ok(existsSync(file));
} finally {
  if (program?.exitCode === null) program.kill('SIGTERM');
  await browser.close();
  rmSync(folder, {recursive: true, force: true});
}
