// Debian's Chromium, which makes no request of its own.
import {existsSync} from 'node:fs';
import {chromium} from 'playwright-core';

/** Ends the program with status 77 where there is none. */
export async function launch() {
  const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
  if (!executablePath) {
    console.log('NOT RUN: chromium is not there (packages.txt), so the page was not tried in a browser');
    process.exit(77);
  }
  return chromium.launch({
    executablePath,
    args: ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync'],
  });
}
