// Points of any dimension: hull and Delaunay triangulation. Types: space.d.ts.
import { CullhullError, Module, packed } from './wasm.js';

export { CullhullError };

/** The module, whose functions are synchronous. `source`: its bytes, or a WebAssembly.Module. */
export async function load(source) {
  const module = await Module.load('space.wasm', source);
  const call = (name, points, dimension, types) => {
    const rows = packed(points, dimension);
    return module.call(name, [rows, rows.length / dimension, dimension], types);
  };
  return {
    hull(points, dimension = 3) {
      const [vertices, simplices, [volume, area], [corners]] = call('cullhull_hull', points,
        dimension, [Uint32Array, Uint32Array, Float64Array, Uint32Array]);
      return { vertices, simplices, volume, area, corners };
    },
    delaunay(points, dimension = 3) {
      const [cells, neighbours, [corners]] =
        call('cullhull_delaunay', points, dimension, [Uint32Array, Int32Array, Uint32Array]);
      return { cells, neighbours, corners };
    },
  };
}
