// What the view of the ranked effects is held to.
import assert from 'node:assert/strict';

/** Pixels of each canvas that are no grey. */
const coloured = (page, canvases) => page.$$eval(canvases, (all) => all.map((canvas) => {
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const context = copy.getContext('2d');
  context.drawImage(canvas, 0, 0);  // the body's canvas has no pixels of its own to ask for
  const data = context.getImageData(0, 0, copy.width, copy.height).data;
  let count = 0;
  for (let i = 0; i < data.length; i += 4)
    if (Math.abs(data[i] - data[i + 2]) > 25) count += 1;
  return count;
}));

/** Waits for `count` pictures in colour. */
async function inColour(page, canvases, count) {
  for (const end = Date.now() + 30000; Date.now() < end; await page.waitForTimeout(300)) {
    const counts = await coloured(page, canvases);
    if (counts.length === count && counts.every((c) => c > 100)) return;
  }
  assert.fail(`${canvases} is not drawn: ${await coloured(page, canvases)}`);
}

/** The leading effect's pictures, all in colour: the residual there is and what it would remove
 *  over the photo, and the latter on the body. */
export async function removedIsDrawn(page) {
  await page.click('#tab-missing');
  await inColour(page, '.removed canvas', 3);
}

/** The fields of forces that a step's free_form.json tells, the best three of them: each is drawn
 *  when it is chosen, and the sentence is its own. */
export async function whereToLook(page, told) {
  await page.click('#tab-missing');
  await page.waitForSelector('.free-form');
  const choices = await page.$$('.free-form li button');
  assert.equal(choices.length, Math.min(3, told.length));
  const pictures = new Set();
  for (const [i, choice] of choices.entries()) {
    await choice.click();
    await page.waitForTimeout(500);
    await inColour(page, '.free-form canvas', 1);
    pictures.add(await page.$eval('.free-form canvas', (canvas) => canvas.toDataURL()));
    const said = await page.textContent('.free-form .note');
    assert.equal(said.slice(1, told[i].sentence.length), told[i].sentence.slice(1));
  }
  assert.equal(pictures.size, choices.length, 'two fields look the same');
}

/** Pointing at an effect only shows it; a click chooses it. */
export async function hoverIsNoChoice(page, until) {
  await page.click('#tab-missing');
  const chosen = () => page.textContent('.ranking tr[aria-selected=true] button');
  const told = () => page.textContent('.detail h3');
  assert.equal(await chosen(), 'gravity', 'the effect that was added is not shown first');
  await page.hover('.ranking tr:has-text("swelling")');
  await until(page, () => document.querySelector('.detail h3').textContent.startsWith('swelling'));
  assert.equal(await chosen(), 'gravity');
  await page.hover('.detail h3');
  await until(page, () => document.querySelector('.detail h3').textContent.startsWith('gravity'));
  await page.click('.ranking tr:has-text("swelling") td:nth-child(2)');
  await page.hover('.detail h3');
  assert.equal(await chosen(), 'swelling');
  assert.match(await told(), /^swelling/);
}

/** What was added tells what it was chosen from: how far each effect got that was tried, and what every
 *  effect that anything speaks for would change. */
export async function choiceIsTold(page) {
  await page.click('#tab-missing');
  const rows = await page.$$eval('.ranking tbody tr', (all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  const told = Object.fromEntries(rows.map(([effect, ...cells]) => [effect, cells]));
  assert.match(told.gravity[3], /^(\d+\.?\d*|floor) \/ (\d|floor)/, `nothing is told of how far gravity got: ${told.gravity}`);
  assert.match(await page.textContent('.ranking p'), /in the screening it leaves (floor|[\d.]+) \/ (floor|[\d.]+), \w+/);
  const tried = rows.filter((cells) => /(\d|floor) \/ (\d|floor)/.test(cells[4] ?? '')).map(([effect]) => effect);
  for (const effect of [tried[tried.length - 1], tried[0]]) {
    await page.hover(`.ranking td:first-child:has-text("${effect}")`);
    await page.waitForSelector(`.removed figcaption:has-text("What ${effect} would change")`);
  }
}
