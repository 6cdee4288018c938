#!/usr/bin/env node
// Runs conic.wasm in node on the files of this machine:
//   node conic.mjs build-wasi/bin/conic.wasm render scan.ply -o scan.png
import fs from 'node:fs';

import { errors, run } from './wasi.mjs';

const statuses = { EEXIST: errors.exists, ENOENT: errors.absent, EISDIR: errors.isFolder, ENOTDIR: errors.notFolder,
  ENOTEMPTY: errors.notEmpty };

function tried(step) {
  try {
    return step() ?? 0;
  } catch (error) {
    return statuses[error.code] ?? errors.failed;
  }
}

function describe(found) {
  return { isFolder: found.isDirectory(), size: found.size, number: found.ino, modified: found.mtimeMs };
}

const disk = {
  look(path) {
    const found = fs.statSync(path, { throwIfNoEntry: false });
    return found && describe(found);
  },
  open(path, { create, exclusive, truncate, writes }) {
    const c = fs.constants;
    return tried(() => {
      const found = fs.statSync(path, { throwIfNoEntry: false });
      if (found?.isDirectory())
        return { isFolder: true, descriptor: -1 };
      const flags = (writes || create ? c.O_RDWR : c.O_RDONLY) | (create ? c.O_CREAT : 0) | (exclusive ? c.O_EXCL : 0)
        | (truncate ? c.O_TRUNC : 0);
      const descriptor = fs.openSync(path, flags, 0o666);
      const entry = describe(fs.fstatSync(descriptor));
      Object.defineProperty(entry, 'size', { get: () => fs.fstatSync(descriptor).size });
      return Object.assign(entry, { descriptor });
    });
  },
  close: ({ descriptor }) => descriptor >= 0 && fs.closeSync(descriptor),
  read: ({ descriptor }, target, at) => fs.readSync(descriptor, target, 0, target.length, at),
  write: ({ descriptor }, bytes, at) => fs.writeSync(descriptor, bytes, 0, bytes.length, at),
  resize: ({ descriptor }, size) => fs.ftruncateSync(descriptor, size),
  names: (path) => fs.readdirSync(path),
  makeFolder: (path) => tried(() => fs.mkdirSync(path)),
  remove: (path, wantsFolder) => tried(() => (wantsFolder ? fs.rmdirSync(path) : fs.unlinkSync(path))),
  rename: (from, to) => tried(() => fs.renameSync(from, to)),
};

/* Who reads what is printed may have enough of it: that ends the program, as it does elsewhere. */
function print(descriptor, bytes) {
  try {
    return fs.writeSync(descriptor, bytes);
  } catch (error) {
    if (error.code === 'EPIPE')
      process.exit(128 + 13);
    throw error;
  }
}

const [program, ...words] = process.argv.slice(2);
const module = await WebAssembly.compile(fs.readFileSync(program));
process.exitCode = await run(module, ['conic', ...words], disk, print, ['/', process.cwd()]);
