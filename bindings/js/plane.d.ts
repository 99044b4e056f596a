/** Coordinates `[x0, y0, x1, y1, …]`, or points `[[x0, y0], …]`. */
export type Points = Float64Array | ArrayLike<number> | ReadonlyArray<ArrayLike<number>>;

/** `code`: `invalid_argument`, `not_finite`, `out_of_memory` … */
export class CullhullError extends Error { readonly code: string; }

export interface Hull {
  /** The corners, counter-clockwise (y upwards), from the lowest id on. */
  vertices: Uint32Array;
  area: number;
  perimeter: number;
}
/** The arrays of delaunator. `triangles` are clockwise (y upwards). */
export interface Mesh {
  triangles: Uint32Array;
  /** The opposite of each half-edge, -1 at the border. */
  halfedges: Int32Array;
}
/** `hull`: all points of the border, clockwise; points on a line from end to end. */
export interface Delaunay extends Mesh { hull: Uint32Array; }
/** `edges`: pairs of ids, the lower first: the constraints, split at the points on them. */
export interface Constrained extends Mesh { edges: Uint32Array; }
/** `ring`: counter-clockwise (y upwards), from the lowest id on. */
export interface ConcaveHull { ring: Uint32Array; area: number; perimeter: number; }
/** In lists of vertices 0xffffffff is the end at infinity. */
export interface Voronoi {
  /** Pairs of coordinates. */
  vertices: Float64Array;
  /** The region of point i: the vertices `regions[offsets[i]]` to `regions[offsets[i + 1] - 1]`. */
  offsets: Uint32Array;
  regions: Uint32Array;
  /** Pairs: the points on both sides of each edge, and its ends. */
  ridgePoints: Uint32Array;
  ridges: Uint32Array;
  /** The vertex where each unbounded edge begins, and its direction. */
  rays: Uint32Array;
  directions: Float64Array;
}

export interface Plane {
  hull(points: Points): Hull;
  delaunay(points: Points): Delaunay;
  /** `edges`: pairs of ids. `insideOnly`: only triangles inside the outline (even-odd rule). */
  constrained(points: Points, edges: ArrayLike<number> | ReadonlyArray<readonly number[]>,
    options?: { insideOnly?: boolean }): Constrained;
  /** Removes edges longer than `length`, or than `ratio` (0.1) from the shortest to the longest. */
  concaveHull(points: Points, options?: { length?: number; ratio?: number }): ConcaveHull;
  voronoi(points: Points): Voronoi;
}
export function load(source?: BufferSource | WebAssembly.Module): Promise<Plane>;
