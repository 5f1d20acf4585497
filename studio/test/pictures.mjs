// The pictures of the README, from the run of the demo.
//   node studio/test/pictures.mjs HOOKEYE RUN docs/images
import {execFileSync} from 'node:child_process';
import {copyFileSync, mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';
import {launch} from './browser.mjs';

const [hookeye, run, out] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'hookeye-pictures-'));
const report = join(folder, 'report.html');
execFileSync(hookeye, ['report', run, '-o', report], {stdio: 'inherit'});
const browser = await launch();
const page = await (await browser.newContext({viewport: {width: 1280, height: 800}})).newPage();
await page.goto(pathToFileURL(report).href);
for (const [verb, name] of [['compare', 'report'], ['falls', 'falls']]) {
  await page.click('#tab-' + verb);
  await page.waitForTimeout(1500);
  await page.screenshot({path: join(out, name + '.png')});
}
await browser.close();
rmSync(folder, {recursive: true});
const base = join(run, 'steps', '00-base');
copyFileSync(join(base, 'compare', 'side-cam0.png'), join(out, 'compare.png'));
copyFileSync(join(base, 'removed', 'gravity', 'side-cam0.png'), join(out, 'removed.png'));
