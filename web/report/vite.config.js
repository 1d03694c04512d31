import { gzipSync } from 'node:zlib';
import { defineConfig } from 'vite';

import { noticesOf } from '../notices.js';

// Everything in one page, compressed, beside which the program puts what was measured.
function onePage() {
  return {
    name: 'one-page',
    enforce: 'post',
    generateBundle(_, bundle) {
      const file = (ending) => Object.values(bundle).find(({ fileName }) => fileName.endsWith(ending));
      const script = noticesOf(file('.js')) + file('.js').code;
      if (script.includes('</script')) throw new Error('a script that ends itself');
      const page = file('.html')
        .source.replace(/\s*<(script type="module"|link rel="stylesheet")[^>]*>(<\/script>)?/g, '')
        .replace('</head>', () => `  <style>\n${file('.css').source.trim()}\n</style>\n  </head>`)
        .replace('</body>', () => `  <script type="module">\n${script.trim()}\n</script>\n  </body>`);
      for (const name of Object.keys(bundle)) delete bundle[name];
      this.emitFile({ type: 'asset', fileName: 'report.html.gz', source: gzipSync(page, { level: 9 }) });
    },
  };
}

export default defineConfig({
  root: import.meta.dirname,
  publicDir: false,
  build: {
    outDir: process.env.VESALIUS_REPORT_BUNDLE ?? '../../training/report/bundle',
    emptyOutDir: false,
    target: 'es2022',
    modulePreload: false,
  },
  plugins: [onePage()],
});
