import type { Points } from './plane.js';
export { CullhullError, Points } from './plane.js';

export interface Hull {
  /** Extreme points, ascending. */
  vertices: Uint32Array;
  /** Rows of `corners` ids: triangles in space, counter-clockwise from outside. */
  simplices: Uint32Array;
  volume: number;
  area: number;
  /** The dimension of the flat that the points span. */
  corners: number;
}
export interface Delaunay {
  /** Rows of `corners` ids: tetrahedra in space. */
  cells: Uint32Array;
  /** The cell opposite to each vertex of a cell, -1 at the border. */
  neighbours: Int32Array;
  corners: number;
}
export interface Space {
  hull(points: Points, dimension?: number): Hull;
  delaunay(points: Points, dimension?: number): Delaunay;
}
export function load(source?: BufferSource | WebAssembly.Module): Promise<Space>;
