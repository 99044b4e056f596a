// Points of the plane: hull, triangulations, Voronoi diagram, concave hull. Types: plane.d.ts.
import { CullhullError, Module, packed, packedIds } from './wasm.js';

export { CullhullError };

/** The module, whose functions are synchronous. `source`: its bytes, or a WebAssembly.Module. */
export async function load(source) {
  const module = await Module.load('plane.wasm', source);
  const call = (name, points, args, types) => {
    const rows = packed(points, 2);
    return module.call(name, [rows, rows.length / 2, ...args], types);
  };
  const mesh = [Uint32Array, Int32Array, Uint32Array];
  return {
    hull(points) {
      const [vertices, [area, perimeter]] =
        call('cullhull_hull', points, [], [Uint32Array, Float64Array]);
      return { vertices, area, perimeter };
    },
    delaunay(points) {
      const [triangles, halfedges, hull] = call('cullhull_delaunay', points, [], mesh);
      return { triangles, halfedges, hull };
    },
    constrained(points, edges, { insideOnly = false } = {}) {
      const ids = packedIds(edges);
      const [triangles, halfedges, pieces] =
        call('cullhull_constrained', points, [ids, ids.length, insideOnly], mesh);
      return { triangles, halfedges, edges: pieces };
    },
    concaveHull(points, { length, ratio = 0.1 } = {}) {
      const [ring, [area, perimeter]] = call('cullhull_concave', points,
        [length ?? ratio, length === undefined], [Uint32Array, Float64Array]);
      return { ring, area, perimeter };
    },
    voronoi(points) {
      const [vertices, offsets, regions, ridgePoints, ridges, rays, directions] =
        call('cullhull_voronoi', points, [], [Float64Array, Uint32Array, Uint32Array, Uint32Array,
          Uint32Array, Uint32Array, Float64Array]);
      return { vertices, offsets, regions, ridgePoints, ridges, rays, directions };
    },
  };
}
