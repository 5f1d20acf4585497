import {createHash} from 'node:crypto';
import {defineConfig, type Plugin} from 'vite';
import {viteSingleFile} from 'vite-plugin-singlefile';

/** The page's policy allows its own script and style by their hashes, and no other. */
function withHashes(html: string): string {
  for (const kind of ['script', 'style']) {
    const own = [...html.matchAll(new RegExp(`<${kind}[^>]*>([\\s\\S]*?)</${kind}>`, 'g'))];
    const hashes = own.map(([, text]) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`);
    const closed = `${kind}-src 'none'`;
    if (!own.length || !html.includes(closed)) throw new Error(`the page has lost its ${kind} or its policy`);
    html = html.replace(closed, `${kind}-src ${hashes.join(' ')}`);
  }
  return html;
}

// The script stands in the body as a plain script, so that the page is drawn before the embedded
// pictures behind it have been read (a module would wait for the end of the file).
function scriptBeforeParts(): Plugin {
  return {
    name: 'script-before-parts',
    enforce: 'post',
    generateBundle(_, bundle) {
      for (const file of Object.values(bundle)) {
        if (file.type !== 'asset' || !file.fileName.endsWith('.html')) continue;
        let html = String(file.source);
        const script = /<script type="module"[^>]*>([\s\S]*?)<\/script>/.exec(html);
        if (!script) throw new Error('the page has no inlined script');
        html = html.replace(script[0], '');
        const mark = '<!--hookeye:script-->';
        if (!html.includes(mark)) throw new Error('the page has lost its mark ' + mark);
        html = html.replace(mark, () => `<script>${script[1]}</script>`);
        file.source = withHashes(html);
      }
    },
  };
}

export default defineConfig({
  base: './',
  esbuild: {jsx: 'automatic', jsxImportSource: 'preact'},
  plugins: [viteSingleFile({removeViteModuleLoader: true}), scriptBeforeParts()],
  build: {
    target: 'es2021',
    emptyOutDir: false,
    modulePreload: false,
    chunkSizeWarningLimit: 2000,
    rollupOptions: {input: 'page.html', output: {format: 'iife'}},
  },
});
