// What the page is held to before anything is clicked: the answer first, little above it, whole
// bodies, and a policy that lets nothing in.
import assert from 'node:assert/strict';
import {createHash} from 'node:crypto';

/** The material with its interval and what follows, the verdict, the misfit: as the run's files have them. */
export async function answerIsFirst(page, material, misfit) {
  await page.click('#tab-answer');
  const rows = await page.$$eval('.material tbody tr', (all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  const told = Object.fromEntries(rows.map(([name, ...rest]) => [name.split(' ')[0], rest]));
  const card = material.cards[0];
  for (const value of [...card.parameters, ...card.small_strain]) {
    const [shown, interval, unit] = told[value.name];
    assert.ok(Math.abs(Number(shown.replace('−', '-')) - value.value) <= 1e-3 * Math.abs(value.value), `${value.name}: ${shown}`);
    assert.equal(unit, value.unit);
    if (value.low === undefined) assert.match(interval, /as given|not identifiable/);
    else assert.match(interval, /\d \.\. \S*\d/);
  }
  for (const name of ['mu', 'kappa', 'E', 'nu']) assert.ok(told[name], `${name} is not told`);
  assert.ok((await page.textContent('.yaml')).startsWith(material.yaml));
  const text = await page.textContent('.answer .card');
  const at = (what) => text.toLowerCase().indexOf(what.toLowerCase());
  assert.ok(at('shear modulus') >= 0 && at('shear modulus') < at('Verdict') && at('Verdict') < at(misfit), text);
  for (const sentence of material.depends) assert.ok(at(sentence) > 0, sentence);
  assert.match(await page.textContent('.charts'), /Stress over stretch/);
}

/** What a step added has its values with their intervals on the card, as run.json has them. */
export async function addedHasIntervals(page, step) {
  await page.click('#tab-answer');
  const rows = await page.$$eval('.found-values tbody tr', (all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  const own = step.parameters.filter((one) => one.name.startsWith(step.added + '.'));
  assert.equal(rows.length, own.length);
  own.forEach((one, i) => {
    const [name, value, interval, unit] = rows[i];
    assert.ok(name.startsWith(one.name.slice(step.added.length + 1)), name);
    assert.ok(Math.abs(Number(value.replace('−', '-')) - one.value) <= 1e-3 * Math.abs(one.value), `${name}: ${value}`);
    assert.match(interval, /\d \.\. \S*\d/);
    assert.equal(unit, one.unit);
  });
}

/** What stands above the view, on every tab. */
export async function headerIsLow(page, verbs) {
  for (const verb of verbs) {
    await page.click('#tab-' + verb);
    const top = await page.evaluate(() => document.querySelector('main').getBoundingClientRect().top);
    assert.ok(top <= 120, `${top} px stand above ${verb}`);
  }
}

/** The first screen of a phone shows a photo, all of it. */
export async function phoneSeesAPicture(page) {
  await page.waitForSelector('.shots canvas');
  await page.waitForTimeout(500);
  const box = await page.locator('.shots canvas').first().boundingBox();
  assert.ok(box && box.y + box.height <= page.viewportSize().height && box.height > 80, JSON.stringify(box));
  const greys = await page.$eval('.shots canvas', (canvas) =>
    new Set(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data).size);
  assert.ok(greys > 20, 'the photo is empty');
}

/** Nothing that is drawn of a body touches the edge of its canvas: it is all there. */
export async function bodyIsWhole(page, selector) {
  await page.waitForSelector(selector);
  let edge = [];
  for (const end = Date.now() + 20000; Date.now() < end; await page.waitForTimeout(300)) {
    const [inside, border] = await page.$eval(selector, (canvas) => {
      const copy = document.createElement('canvas');
      [copy.width, copy.height] = [canvas.width, canvas.height];
      const context = copy.getContext('2d');
      context.drawImage(canvas, 0, 0);
      const {data} = context.getImageData(0, 0, copy.width, copy.height);
      const at = (x, y) => [...data.slice(4 * (y * copy.width + x), 4 * (y * copy.width + x) + 3)].join();
      const colours = new Set();
      for (let x = 0; x < copy.width; ++x) colours.add(at(x, 0)).add(at(x, copy.height - 1));
      for (let y = 0; y < copy.height; ++y) colours.add(at(0, y)).add(at(copy.width - 1, y));
      let other = 0;
      for (let i = 0; i < data.length; i += 4) other += data[i] !== data[0] || data[i + 1] !== data[1] ? 1 : 0;
      return [other / (data.length / 4), [...colours]];
    });
    edge = border;
    if (inside > 0.03 && border.length === 1) return;
  }
  assert.fail(`${selector} is cut, or empty: ${edge}`);
}

/** The policy names the page's own script and style, by what they are, and nothing inline besides. */
export function policyIsClosed(html) {
  const policy = /http-equiv="Content-Security-Policy" content="([^"]*)"/.exec(html)[1];
  assert.ok(!policy.includes('unsafe'), policy);
  for (const kind of ['script', 'style']) {
    const own = new RegExp(`<${kind}(?: rel="stylesheet"[^>]*| crossorigin)?>([\\s\\S]*?)</${kind}>`).exec(html)[1];
    const hash = createHash('sha256').update(own).digest('base64');
    assert.ok(policy.includes(`${kind}-src 'sha256-${hash}';`), `${kind} is not the one that ${policy} allows`);
  }
}

/** Scripts, handlers and styles that somebody brings in do nothing. */
export async function nothingRunsBesides(page) {
  await page.evaluate(() => {
    const script = document.createElement('script');
    script.textContent = 'window.broughtIn = true';
    document.body.append(script);
    document.body.insertAdjacentHTML('beforeend', '<img src="data:," onerror="window.broughtIn = true"><style>body{color:rgb(1,2,3)}</style>');
  });
  await page.waitForTimeout(300);
  assert.deepEqual(await page.evaluate(() => [window.broughtIn, getComputedStyle(document.body).color === 'rgb(1, 2, 3)']), [undefined, false]);
}
