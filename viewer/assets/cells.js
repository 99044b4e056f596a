"use strict";
// The cells of a triangulation: all triangles; of tetrahedra their sections by the clip plane.

// A number in [0, 1) for each cell, a hash, so that neighbours look different.
function cellTone(cell) {
  let h = Math.imul(cell + 1, 0x9e3779b1);
  h = Math.imul(h ^ (h >>> 15), 0x85ebca6b);
  return ((h ^ (h >>> 13)) >>> 0) / 0x100000000;
}

// Triangles with a tone for each corner, and lines, as lists of positions.
class CellShape {
  constructor() {
    this.places = [];
    this.tones = [];
    this.lines = [];
  }
  // Adds a convex polygon, given by its corners.
  add(polygon, tone) {
    for (let i = 2; i < polygon.length; ++i)
      for (const place of [polygon[0], polygon[i - 1], polygon[i]]) {
        this.places.push(place[0], place[1], place[2]);
        this.tones.push(tone);
      }
    polygon.forEach((a, i) => {
      const b = polygon[(i + 1) % polygon.length];
      this.lines.push(a[0], a[1], a[2], b[0], b[1], b[2]);
    });
  }
  done() {
    return { places: Float32Array.from(this.places), tones: Float32Array.from(this.tones), lines: Float32Array.from(this.lines) };
  }
}

// Of an outline the edges of one cell alone.
function triangleCells(frame, placed) {
  const { cells, outline } = frame, count = cells.length;
  const places = new Float32Array(3 * count), tones = new Float32Array(count), lines = new Float32Array(6 * count);
  const end = (i) => cells[i % 3 === 2 ? i - 2 : i + 1];
  const edge = (i) => Math.min(cells[i], end(i)) * 0x100000000 + Math.max(cells[i], end(i));
  const border = new Set();
  if (outline) for (let i = 0; i < count; ++i) if (!border.delete(edge(i))) border.add(edge(i));
  let line = 0;
  for (let i = 0; i < count; ++i) {
    const inner = outline && !border.has(edge(i));
    for (let k = 0; k < 3; ++k) {
      places[3 * i + k] = placed[3 * cells[i] + k];
      if (inner) continue;
      lines[line + k] = places[3 * i + k];
      lines[line + 3 + k] = placed[3 * end(i) + k];
    }
    if (!inner) line += 6;
    tones[i] = outline ? 0.5 : cellTone(Math.floor(i / 3));
  }
  return { places, tones, lines: lines.subarray(0, line) };
}

// The sections of tetrahedra by a plane (a, b, c, w): three or four corners each.
function cutCells(frame, placed, plane) {
  const { cells } = frame;
  const count = placed.length / 3, off = new Float64Array(count);
  for (let row = 0; row < count; ++row)
    off[row] = plane.x * placed[3 * row] + plane.y * placed[3 * row + 1] + plane.z * placed[3 * row + 2] - plane.w;
  const between = (a, b) => {
    const t = off[a] / (off[a] - off[b]);
    return [0, 1, 2].map((k) => placed[3 * a + k] + t * (placed[3 * b + k] - placed[3 * a + k]));
  };
  const shape = new CellShape();
  for (let i = 0; i < cells.length; i += 4) {
    const over = [], under = [];
    for (let k = 0; k < 4; ++k) (off[cells[i + k]] > 0 ? over : under).push(cells[i + k]);
    if (over.length === 0 || under.length === 0) continue;
    const polygon = over.length === 2
      ? [between(over[0], under[0]), between(over[0], under[1]), between(over[1], under[1]), between(over[1], under[0])]
      : (over.length === 1 ? under.map((u) => between(over[0], u)) : over.map((o) => between(o, under[0])));
    shape.add(polygon, cellTone(i / 4));
  }
  return shape.done();
}

// What to draw of a frame's cells; null: nothing. `plane`: the clip plane, or null.
function cellShape(frame, placed, plane) {
  if (frame.cell_corners === 3) return triangleCells(frame, placed);
  if (frame.cell_corners === 4 && plane) return cutCells(frame, placed, plane);
  return null;
}
