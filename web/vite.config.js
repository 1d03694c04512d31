import { mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';
import { defineConfig } from 'vite';

import { noticesOf } from './notices.js';

// The program holds the files compressed, as it sends them. A gzip header has no time in it, so that the same sources
// give the same files.
function compress(from, to) {
  return {
    name: 'compress',
    closeBundle() {
      mkdirSync(to, { recursive: true });
      for (const file of readdirSync(from)) {
        writeFileSync(join(to, `${file}.gz`), gzipSync(readFileSync(join(from, file)), { level: 9 }));
      }
      rmSync(from, { recursive: true });
    },
  };
}

function withNotices() {
  return {
    name: 'notices',
    enforce: 'post',
    generateBundle(_, bundle) {
      for (const file of Object.values(bundle)) {
        if (file.type === 'chunk') file.code = noticesOf(file) + file.code;
      }
    },
  };
}

const to = process.env.VESALIUS_BUNDLE ?? '../src/view/bundle';

export default defineConfig({
  base: './',
  publicDir: false,
  build: {
    outDir: 'dist',
    target: 'es2022',
    modulePreload: false,
    chunkSizeWarningLimit: 1000,
    rollupOptions: {
      output: { entryFileNames: 'view.js', assetFileNames: 'view[extname]', inlineDynamicImports: true },
    },
  },
  plugins: [withNotices(), compress('dist', to)],
});
