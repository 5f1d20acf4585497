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
const page = await (await browser.newContext({viewport: {width: 1280, height: 2400}})).newPage();
await page.goto(pathToFileURL(report).href);
await page.click('#tab-falls');
await page.waitForTimeout(1500);
const section = page.locator('.falls section').first();
const all = await section.boundingBox();
const first = await section.getByText('Energy of').first().boundingBox();
const last = await section.locator('.note').last().boundingBox();
await page.screenshot({path: out, clip: {x: all.x, y: first.y - 8, width: all.width, height: last.y + last.height + 16 - first.y}});
await browser.close();
rmSync(folder, {recursive: true});
