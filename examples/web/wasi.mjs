// Runs a program of WebAssembly that asks for WASI (preview 1). The disk stands behind one small interface, so that the
// same program works in a page, whose files are in memory, and in node, whose files are on a disk.

export const errors = { badDescriptor: 8, exists: 20, wrong: 28, failed: 29, isFolder: 31, absent: 44, unknown: 52,
  notFolder: 54, notEmpty: 55 };

/** Files in memory: `files` has the bytes of each path, without a leading slash. */
export class MemoryDisk {
  constructor(files = {}) {
    this.entries = new Map([['', { isFolder: true }]]);
    for (const [path, bytes] of Object.entries(files))
      this.entries.set(path, { bytes, size: bytes.length });
  }

  look(path) {
    return this.entries.get(path);
  }

  open(path, { create, exclusive, truncate }) {
    let entry = this.entries.get(path);
    if (entry && create && exclusive)
      return errors.exists;
    if (!entry && !create)
      return errors.absent;
    if (!entry)
      this.entries.set(path, entry = { bytes: new Uint8Array(0), size: 0 });
    if (truncate && !entry.isFolder)
      entry.size = 0;
    return entry;
  }

  close() {}

  read(entry, target, at) {
    const part = entry.bytes.subarray(Math.min(at, entry.size), Math.min(at + target.length, entry.size));
    target.set(part);
    return part.length;
  }

  resize(entry, size) {
    if (size > entry.bytes.length) {
      const room = new Uint8Array(Math.max(size, 2 * entry.bytes.length));
      room.set(entry.bytes.subarray(0, entry.size));
      entry.bytes = room;
    }
    entry.bytes.fill(0, Math.min(entry.size, size), Math.max(entry.size, size));
    entry.size = size;
  }

  write(entry, bytes, at) {
    if (at + bytes.length > entry.size)
      this.resize(entry, at + bytes.length);
    entry.bytes.set(bytes, at);
  }

  names(path) {
    const start = path ? `${path}/` : '';
    return [...this.entries.keys()].filter((name) => name && name.startsWith(start)
      && !name.slice(start.length).includes('/')).map((name) => name.slice(start.length));
  }

  makeFolder(path) {
    if (this.entries.has(path))
      return errors.exists;
    this.entries.set(path, { isFolder: true });
    return 0;
  }

  remove(path, wantsFolder) {
    const entry = this.entries.get(path);
    if (!entry || !path)
      return errors.absent;
    if (Boolean(entry.isFolder) !== wantsFolder)
      return wantsFolder ? errors.notFolder : errors.isFolder;
    if (wantsFolder && this.names(path).length > 0)
      return errors.notEmpty;
    this.entries.delete(path);
    return 0;
  }

  rename(from, to) {
    const entry = this.entries.get(from);
    if (!entry)
      return errors.absent;
    this.entries.delete(from);
    this.entries.set(to, entry);
    return 0;
  }

  /** The bytes of a file that the program wrote, or undefined. */
  bytesOf(path) {
    const entry = this.entries.get(path);
    return entry && !entry.isFolder ? entry.bytes.slice(0, entry.size) : undefined;
  }
}

class Exit extends Error {
  constructor(code) {
    super(`exit code ${code}`);
    this.code = code;
  }
}

// "a/./b/../c" as "a/c".
function plain(path) {
  const steps = [];
  for (const step of path.split('/'))
    if (step === '..')
      steps.pop();
    else if (step && step !== '.')
      steps.push(step);
  return steps.join('/');
}

/**
 * Runs `module` (a WebAssembly.Module) as `words` and returns its exit code. `disk`: as MemoryDisk; `roots`: what the
 * folders "/" and "." are called on it; `write(descriptor, bytes)` takes what goes to standard output (1) and
 * error (2).
 */
export async function run(module, words, disk, write, roots = ['', '']) {
  const text = { in: new TextDecoder(), out: new TextEncoder() };
  const folders = ['/', '.'];
  const opened = [{ stream: 0 }, { stream: 1 }, { stream: 2 },
    ...folders.map((name, i) => ({ folder: name, path: roots[i], entry: { isFolder: true } }))];
  let instance, memory = new DataView(new ArrayBuffer(0));

  const view = () => {
    if (memory.buffer !== instance.exports.memory.buffer)
      memory = new DataView(instance.exports.memory.buffer);
    return memory;
  };
  const bytes = (at, n) => new Uint8Array(view().buffer, at >>> 0, n >>> 0);
  const pathOf = (descriptor, at, n) => {
    const base = opened[descriptor]?.path ?? '', name = plain(`${base}/${text.in.decode(bytes(at, n))}`);
    return base.startsWith('/') ? `/${name}` : name;
  };
  const list = (items, pointers, at) => {
    for (const item of items) {
      view().setUint32(pointers, at, true);
      bytes(at, item.length).set(item);
      pointers += 4;
      at += item.length;
    }
    return 0;
  };
  const described = (at, entry) => {
    bytes(at, 64).fill(0);
    view().setBigUint64(at + 8, BigInt(entry.number ?? 0), true);
    view().setUint8(at + 16, entry.isFolder ? 3 : entry.isStream ? 2 : 4);
    view().setBigUint64(at + 24, 1n, true);
    view().setBigUint64(at + 32, BigInt(entry.size ?? 0), true);
    for (let i = 40; i < 64; i += 8)
      view().setBigUint64(at + i, BigInt(Math.round(1e6 * (entry.modified ?? 0))), true);
    return 0;
  };
  // Calls step(part) for each part of the program's memory that a list of them names, until one is not filled.
  const each = (parts, n, step) => {
    let sum = 0;
    for (let i = 0; i < n; i++) {
      const part = bytes(view().getUint32(parts + 8 * i, true), view().getUint32(parts + 8 * i + 4, true));
      const done = step(part);
      sum += done;
      if (done < part.length)
        break;
    }
    return sum;
  };
  const store = (at, number) => {
    view().setUint32(at, number, true);
    return 0;
  };
  const read = (file, parts, n, at, told) => {
    if (!file?.entry || file.entry.isFolder)
      return file?.stream === 0 ? store(told, 0) : errors.badDescriptor;
    return store(told, each(parts, n, (part) => {
      const done = disk.read(file.entry, part, at);
      at += done;
      return done;
    }));
  };
  const put = (file, parts, n, at, told) => {
    if (!file || (!file.entry && !file.stream))
      return errors.badDescriptor;
    if (file.isAppended)
      at = file.at = file.entry.size;
    return store(told, each(parts, n, (part) => {
      if (file.entry)
        disk.write(file.entry, part, at);
      else
        write(file.stream, part.slice());
      at += part.length;
      return part.length;
    }));
  };
  const moved = (file, told, step) => { // read and put, from where the file stands
    const status = step(file?.at ?? 0);
    if (status === 0 && file?.entry)
      file.at += view().getUint32(told, true);
    return status;
  };
  const args = words.map((word) => text.out.encode(`${word}\0`));
  const sizes = (items, n, room) => store(n, items.length)
    || store(room, items.reduce((sum, { length }) => sum + length, 0));

  const calls = {
    args_get: (pointers, at) => list(args, pointers, at),
    args_sizes_get: (n, room) => sizes(args, n, room),
    environ_get: () => 0,
    environ_sizes_get: (n, room) => sizes([], n, room),
    clock_time_get: (clock, precision, at) => {
      const milliseconds = clock === 0 ? Date.now() : performance.now();
      view().setBigUint64(at, BigInt(Math.round(1e6 * milliseconds)), true);
      return 0;
    },
    random_get: (at, n) => {
      crypto.getRandomValues(bytes(at, n));
      return 0;
    },
    proc_exit: (code) => { throw new Exit(code); },
    poll_oneoff: () => errors.unknown,
    path_readlink: () => errors.wrong,
    fd_prestat_get: (fd, at) => (opened[fd]?.folder ? store(at, 0) || store(at + 4, opened[fd].folder.length)
      : errors.badDescriptor),
    fd_prestat_dir_name: (fd, at, n) => {
      bytes(at, n).set(text.out.encode(opened[fd].folder));
      return 0;
    },
    fd_fdstat_get: (fd, at) => {
      const file = opened[fd];
      if (!file)
        return errors.badDescriptor;
      bytes(at, 24).fill(0);
      view().setUint8(at, file.entry?.isFolder ? 3 : file.entry ? 4 : 2);
      view().setBigUint64(at + 8, ~0n, true); // every right
      view().setBigUint64(at + 16, ~0n, true);
      return 0;
    },
    fd_fdstat_set_flags: () => 0,
    fd_filestat_get: (fd, at) => (opened[fd] ? described(at, opened[fd].entry ?? { isStream: true })
      : errors.badDescriptor),
    fd_filestat_set_size: (fd, size) => {
      if (!opened[fd]?.entry)
        return errors.badDescriptor;
      disk.resize(opened[fd].entry, Number(size));
      return 0;
    },
    fd_close: (fd) => {
      if (!opened[fd])
        return errors.badDescriptor;
      if (opened[fd].entry && !opened[fd].folder)
        disk.close(opened[fd].entry);
      delete opened[fd];
      return 0;
    },
    fd_seek: (fd, offset, from, told) => {
      const file = opened[fd];
      if (!file?.entry)
        return file ? 70 : errors.badDescriptor; // a pipe has no place
      const at = Number(offset) + [0, file.at, file.entry.size][from];
      if (at < 0)
        return errors.wrong;
      file.at = at;
      view().setBigUint64(told, BigInt(at), true);
      return 0;
    },
    fd_tell: (fd, told) => calls.fd_seek(fd, 0n, 1, told),
    fd_read: (fd, parts, n, told) => moved(opened[fd], told, (at) => read(opened[fd], parts, n, at, told)),
    fd_write: (fd, parts, n, told) => moved(opened[fd], told, (at) => put(opened[fd], parts, n, at, told)),
    fd_pread: (fd, parts, n, at, told) => read(opened[fd], parts, n, Number(at), told),
    fd_pwrite: (fd, parts, n, at, told) => put(opened[fd], parts, n, Number(at), told),
    fd_readdir: (fd, at, room, cookie, told) => {
      if (!opened[fd]?.entry?.isFolder)
        return errors.notFolder;
      const names = disk.names(opened[fd].path), start = at;
      for (let i = Number(cookie); i < names.length && at < start + room; i++) {
        const name = text.out.encode(names[i]), record = new Uint8Array(24 + name.length);
        const about = new DataView(record.buffer);
        about.setBigUint64(0, BigInt(i + 1), true);
        about.setUint32(16, name.length, true);
        about.setUint8(20, disk.look(plainOf(opened[fd].path, names[i]))?.isFolder ? 3 : 4);
        record.set(name, 24);
        const part = record.subarray(0, start + room - at);
        bytes(at, part.length).set(part);
        at += part.length;
      }
      return store(told, at - start);
    },
    path_open: (fd, look, name, n, flags, rights, inherited, fdFlags, told) => {
      const path = pathOf(fd, name, n);
      const entry = disk.open(path, { create: flags & 1, exclusive: flags & 4, truncate: flags & 8,
        writes: (rights & 64n) !== 0n });
      if (typeof entry === 'number')
        return entry;
      if (flags & 2 && !entry.isFolder)
        return errors.notFolder;
      let free = 3;
      while (opened[free])
        free++;
      opened[free] = { path, entry, at: 0, isAppended: fdFlags & 1 };
      return store(told, free);
    },
    path_filestat_get: (fd, flags, name, n, at) => {
      const entry = disk.look(pathOf(fd, name, n));
      return entry ? described(at, entry) : errors.absent;
    },
    path_create_directory: (fd, name, n) => disk.makeFolder(pathOf(fd, name, n)),
    path_remove_directory: (fd, name, n) => disk.remove(pathOf(fd, name, n), true),
    path_unlink_file: (fd, name, n) => disk.remove(pathOf(fd, name, n), false),
    path_rename: (fd, from, nFrom, toFd, to, nTo) => disk.rename(pathOf(fd, from, nFrom), pathOf(toFd, to, nTo)),
  };
  const plainOf = (folder, name) => (folder.startsWith('/') ? '/' : '') + plain(`${folder}/${name}`);

  instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: calls });
  try {
    instance.exports._start();
    return 0;
  } catch (error) {
    if (error instanceof Exit)
      return error.code;
    throw error;
  }
}
