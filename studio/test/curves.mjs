// The energy curves of a run's last step, with their bands and the strains that were visited.
//   node studio/test/curves.mjs HOOKEYE RUN docs/images/curves.png
import {execFileSync} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';
import {launch} from './browser.mjs';

const [hookeye, run, out] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'hookeye-curves-'));
const report = join(folder, 'report.html');
execFileSync(hookeye, ['report', run, '-o', report], {stdio: 'inherit'});
const browser = await launch();
const page = await (await browser.newContext({viewport: {width: 1280, height: 2200}})).newPage();
await page.goto(pathToFileURL(report).href);
await page.click('#tab-falls');
await page.waitForTimeout(1500);
await page.locator('.falls .curves').screenshot({path: out});
await browser.close();
rmSync(folder, {recursive: true});
