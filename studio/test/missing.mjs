// What the view of the ranked effects is held to.
import assert from 'node:assert/strict';

/** The leading effect's pictures, all in colour: the residual there is and what it would remove
 *  over the photo, and the latter on the body. */
export async function removedIsDrawn(page) {
  await page.click('#tab-missing');
  const coloured = () => page.$$eval('.removed canvas', (all) => all.map((canvas) => {
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
  for (const end = Date.now() + 30000; Date.now() < end; await page.waitForTimeout(300)) {
    const counts = await coloured();
    if (counts.length === 3 && counts.every((c) => c > 100)) return;
  }
  assert.fail(`what the effect would remove is not drawn: ${await coloured()}`);
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
  assert.match(told.gravity[3], /^\d+\.?\d* \/ \d/, `nothing is told of how far gravity got: ${told.gravity}`);
  assert.match(await page.textContent('.ranking p'), /tried for two steps on half-size photos it leaves χ [\d.]+ \/ [\d.]+, \w+/);
  const tried = rows.filter((cells) => /\d \/ \d/.test(cells[4] ?? '')).map(([effect]) => effect);
  for (const effect of [tried[tried.length - 1], tried[0]]) {
    await page.hover(`.ranking td:first-child:has-text("${effect}")`);
    await page.waitForSelector(`.removed figcaption:has-text("What ${effect} would change")`);
  }
}
