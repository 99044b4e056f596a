// Runs a module of WebAssembly: copies arrays in and results out, makes errors of its errors.

/** An error of the library: `code` is one of its names, `message` its one line. */
export class CullhullError extends Error {
  constructor(code, message) {
    super(message);
    this.name = 'CullhullError';
    this.code = code;
  }
}

async function compile(file, source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source !== undefined) return WebAssembly.compile(source);
  const url = new URL(file, import.meta.url);
  if (url.protocol === 'file:') {
    const { readFile } = await import('node:fs/promises');
    return WebAssembly.compile(await readFile(url));
  }
  const response = await fetch(url);
  if (!response.ok) throw new CullhullError('io', `${url}: ${response.status}`);
  return WebAssembly.compile(await response.arrayBuffer());
}

/** A module, and the memory that its calls share. */
export class Module {
  static async load(file, source) {
    const module = new Module();
    module.compiled = await compile(file, source);
    module.start();
    return module;
  }

  start() {
    // The module reads no file and prints nothing: all but these fails with ENOSYS.
    const ours = {
      clock_time_get: (...a) => this.clock(...a),
      emscripten_notify_memory_growth() {},
      proc_exit() { throw new WebAssembly.RuntimeError('abort'); },
    };
    const imports = {};
    for (const { module, name } of WebAssembly.Module.imports(this.compiled)) {
      imports[module] ??= {};
      imports[module][name] = ours[name] ?? (() => 52);
    }
    this.wasm = new WebAssembly.Instance(this.compiled, imports).exports;
    this.wasm._initialize?.();
  }

  clock(id, precision, time) {
    new DataView(this.wasm.memory.buffer)
      .setBigUint64(time >>> 0, BigInt(Math.round(performance.now() * 1e6)), true);
    return 0;
  }

  /** Copies a typed array into the module. */
  place(array) {
    const size = Math.max(array.byteLength, 8);
    const at = size < 2 ** 32 ? this.wasm.malloc(size) >>> 0 : 0;
    if (at === 0) throw new CullhullError('out_of_memory', 'not enough memory for the input');
    new array.constructor(this.wasm.memory.buffer, at, array.length).set(array);
    return at;
  }

  /**
   * Calls a function with the places of `arrays` among its arguments, and returns copies of the
   * parts of its result, which are of the types `types`.
   */
  call(name, args, types) {
    const placed = [];
    try {
      const status = this.wasm[name](...args.map(a => {
        if (!ArrayBuffer.isView(a)) return a;
        placed.push(this.place(a));
        return placed.at(-1);
      }));
      if (status !== 0) throw this.error();
      const parts = new DataView(this.wasm.memory.buffer, this.wasm.cullhull_parts() >>> 0);
      return types.map((Type, i) => {
        const size = parts.getUint32(8 * i + 4, true);
        return size === 0 ? new Type(0)
          : new Type(this.wasm.memory.buffer, parts.getUint32(8 * i, true),
            size / Type.BYTES_PER_ELEMENT).slice();
      });
    } catch (error) {
      if (error instanceof CullhullError) throw error;
      placed.length = 0;  // with the memory of the instance that broke off
      this.start();
      throw new CullhullError('out_of_memory', 'not enough memory for the call');
    } finally {
      for (const at of placed) this.wasm.free(at);
      this.wasm.cullhull_free_result();
    }
  }

  error() {
    const bytes = new Uint8Array(this.wasm.memory.buffer);
    const begin = this.wasm.cullhull_error() >>> 0;
    const text = new TextDecoder().decode(bytes.slice(begin, bytes.indexOf(0, begin)));
    const end = text.indexOf('\n');
    return new CullhullError(text.slice(0, end), text.slice(end + 1));
  }
}

/** Points as packed doubles: of a typed array, of a flat array, or of an array of points. */
export function packed(points, dimension) {
  if (!Number.isInteger(dimension) || dimension < 1)
    throw new CullhullError('invalid_argument', `points have no ${dimension} coordinates`);
  if (!Array.isArray(points) && (!ArrayBuffer.isView(points) || points instanceof DataView))
    throw new CullhullError('invalid_argument', 'points are an array of numbers or of points');
  if (points.length === 0) attached(points);
  if (points instanceof Float64Array) return whole(points, dimension);
  if (typeof points[0] === 'number') return whole(Float64Array.from(points), dimension);
  const rows = new Float64Array(points.length * dimension);
  let at = 0;
  for (const point of points) {
    if (point?.length !== dimension)
      throw new CullhullError('invalid_argument', `each point has ${dimension} coordinates`);
    for (let j = 0; j < dimension; ++j) rows[at++] = point[j];
  }
  return rows;
}

/** Ids as packed integers: of a typed array, of a flat array, or of an array of lists. */
export function packedIds(ids) {
  const all = ids?.flat?.() ?? ids;
  if (!Array.isArray(all) && (!ArrayBuffer.isView(all) || all instanceof DataView))
    throw new CullhullError('invalid_argument', 'ids are an array of numbers or of lists');
  if (all.length === 0) attached(all);
  if (!all.every(id => Number.isInteger(id) && id >= 0 && id < 2 ** 32))
    throw new CullhullError('invalid_argument', 'ids are whole numbers from 0 on');
  return Uint32Array.from(all);
}

/** Refuses an array whose buffer was sent elsewhere: it has no length any more. */
function attached(array) {
  try {
    if (array.buffer) new Uint8Array(array.buffer);
  } catch {
    throw new CullhullError('invalid_argument', 'the array has been detached');
  }
}

function whole(rows, dimension) {
  if (rows.length % dimension === 0) return rows;
  throw new CullhullError('invalid_argument',
    `${rows.length} numbers are no points of ${dimension} coordinates`);
}
