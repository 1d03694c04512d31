import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';

// What must go with a script that holds others' code: the licences of the packages that its modules are of, as comments, which
// packages of the program read again (cmake/package/third_party.py).
export function noticesOf({ modules }) {
  const used = Object.entries(modules).filter(([, { renderedLength }]) => renderedLength > 0);
  const folders = used.map(([id]) => id.match(/^.*\/node_modules\/(?:@[^/]+\/)?[^/]+/)?.[0]);
  return [...new Set(folders)].filter(Boolean).sort().map((folder) => {
    const { name, version } = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8'));
    const file = readdirSync(folder).find((each) => /^licen[cs]e/i.test(each));
    if (!file) throw new Error(`${name}: no licence in ${folder}`);
    return `/*! notice of ${name} ${version}\n${readFileSync(join(folder, file), 'utf8').trim()}\n*/\n`;
  }).join('');
}
