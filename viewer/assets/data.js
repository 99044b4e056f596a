"use strict";
// The page's data: frames of rows (docs/viewer.md), and the position of each row in the picture.

function decodeBytes(text) {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes.buffer;
}

function readScene() {
  const scene = JSON.parse(document.getElementById("scene").textContent);
  const bytes = decodeBytes(document.getElementById("bytes").textContent);
  const kinds = { u8: Uint8Array, u16: Uint16Array, u32: Uint32Array, f32: Float32Array, f64: Float64Array };
  const unpack = (holder, names) => {
    for (const name of names) {
      if (!holder[name]) continue;  // colours, facets and cells are not in every page
      const [offset, length, kind] = holder[name];
      holder[name] = new kinds[kind](bytes, offset, length);
    }
  };
  for (const frame of scene.frames) {
    unpack(frame, ["ids", "coordinates", "colours", "edges", "triangles", "facets", "cells", "measures"]);
    for (const attribute of frame.attributes || []) unpack(attribute, ["values"]);
    for (const shadow of frame.shadows || []) unpack(shadow, ["edges", "triangles"]);
  }
  scene.ranges = axisRanges(scene);
  return scene;
}

// Least and greatest coordinate of every axis. Vertices suffice, as all other points are inside.
function axisRanges(scene) {
  const ranges = [];
  for (let axis = 0; axis < scene.axes; ++axis) {
    let low = Infinity, high = -Infinity;
    for (const frame of scene.frames)
      for (let row = 0; row < frame.vertices; ++row) {
        const x = frame.coordinates[row * scene.axes + axis];
        if (x < low) low = x;
        if (x > high) high = x;
      }
    ranges.push(low <= high ? { low, high } : { low: 0, high: 0 });
  }
  return ranges;
}

// Maps coordinates to the picture's units, in which the longest axis runs from -1 to 1.
// `proportions`: "equal", or the factor of the last axis. Computed in doubles from halves of
// coordinates, so that nothing overflows; only the results are converted to floats.
class Space {
  constructor(scene, axes, proportions) {
    this.width = scene.axes;
    this.axes = axes;
    const half = axes.map((a) => (a < 0 ? 0 : scene.ranges[a].high / 2 - scene.ranges[a].low / 2));
    const longest = Math.max(...half);
    this.centre = axes.map((a) => (a < 0 ? 0 : scene.ranges[a].high / 2 + scene.ranges[a].low / 2));
    const factors = [1, 1, proportions === "equal" ? 1 : Number(proportions)];
    this.scale = half.map((h, i) => (proportions === "equal" ? h : longest / factors[i]) || 1);
    this.extent = half.map((h, i) => h / this.scale[i]);
  }
  place(coordinates, row, out, at) {
    for (let i = 0; i < 3; ++i) {
      const axis = this.axes[i];
      out[at + i] = axis < 0 ? 0 : this.toPicture(i, coordinates[row * this.width + axis]);
    }
  }
  toPicture(i, value) {
    return (value - this.centre[i]) / this.scale[i];
  }
  toValue(i, place) {
    const most = Number.MAX_VALUE;
    return Math.max(-most, Math.min(most, this.centre[i] + place * this.scale[i]));
  }
  positions(frame, from, count) {
    const out = new Float32Array(3 * count);
    for (let i = 0; i < count; ++i) this.place(frame.coordinates, from + i, out, 3 * i);
    return out;
  }
}

function axisName(axis, dimension) {
  return dimension <= 3 ? "xyz"[axis] : "x" + (axis + 1);
}
