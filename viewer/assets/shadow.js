"use strict";
// Shadows (projections) of hulls of four and more dimensions: on two axes a polygon computed here,
// on three a surface from the page's data (docs/viewer.md).

// Rows of the vertices that are corners of the shadow on the axes a and b, in order (Andrew's
// monotone chain). Signs are computed in doubles, which suffices for a picture.
function shadowPolygon(scene, frame, a, b) {
  const { coordinates, vertices } = frame, width = scene.axes;
  const x = (row) => coordinates[row * width + a], y = (row) => coordinates[row * width + b];
  const rows = Array.from({ length: vertices }, (_, i) => i).sort((p, q) => x(p) - x(q) || y(p) - y(q));
  const turn = (p, q, r) => (x(q) - x(p)) * (y(r) - y(p)) - (y(q) - y(p)) * (x(r) - x(p));
  const half = (order) => {
    const chain = [];
    for (const row of order) {
      while (chain.length > 1 && !(turn(chain[chain.length - 2], chain[chain.length - 1], row) > 0)) chain.pop();
      chain.push(row);
    }
    chain.pop();
    return chain;
  };
  return [...half(rows), ...half(rows.reverse())];
}

// What to draw of a frame on these axes: edges and triangles, as rows.
function shapeOn(scene, frame, axes) {
  const whole = { edges: frame.edges, triangles: frame.triangles, facets: frame.facets };
  if (frame.affine_dimension < 4) return whole;
  if (axes[2] < 0) {
    const polygon = shadowPolygon(scene, frame, axes[0], axes[1]);
    const edges = polygon.flatMap((row, i) => [row, polygon[(i + 1) % polygon.length]]);
    const triangles = polygon.slice(2).flatMap((row, i) => [polygon[0], polygon[i + 1], row]);
    return { edges: Uint32Array.from(edges), triangles: Uint32Array.from(triangles) };
  }
  const sorted = [...axes].sort((p, q) => p - q);
  const shadow = (frame.shadows || []).find((s) => s.axes.every((axis, i) => axis === sorted[i]));
  if (!shadow) return { edges: frame.edges, triangles: new Uint32Array(0) };
  // Axes in another order may reverse the orientation of the surface.
  const odd = (axes[0] > axes[1]) + (axes[0] > axes[2]) + (axes[1] > axes[2]);
  if (odd % 2 === 0) return shadow;
  const triangles = shadow.triangles.slice();
  for (let i = 0; i < triangles.length; i += 3) [triangles[i], triangles[i + 1]] = [triangles[i + 1], triangles[i]];
  return { edges: shadow.edges, triangles };
}

// A small picture of the shadow on two axes, with some of the points in it.
function drawThumbnail(canvas, scene, frame, a, b, colours) {
  const ratio = Math.min(3, window.devicePixelRatio || 1), size = canvas.clientWidth || 80, rim = 7;
  canvas.width = canvas.height = Math.round(size * ratio);
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  const longest = Math.max(...[a, b].map((axis) => scene.ranges[axis].high / 2 - scene.ranges[axis].low / 2)) || 1;
  const place = (row, axis, sign) => {
    const { low, high } = scene.ranges[axis];
    const value = frame.coordinates[row * scene.axes + axis];
    return size / 2 + (sign * (value - (low / 2 + high / 2)) * (size / 2 - rim)) / longest;
  };
  const at = (row) => [place(row, a, 1), place(row, b, -1)];
  const polygon = shadowPolygon(scene, frame, a, b);
  pen.beginPath();
  for (const row of polygon) pen.lineTo(...at(row));
  pen.closePath();
  pen.globalAlpha = 0.22;
  pen.fillStyle = colours.hull;
  pen.fill();
  const step = Math.max(1, Math.floor(frame.ids.length / 900));
  pen.globalAlpha = 0.55;
  for (let row = 0; row < frame.ids.length; row += step) {
    pen.fillStyle = row < frame.vertices ? colours.vertices : row < frame.vertices + frame.survivors ? colours.survivors : colours.points;
    pen.fillRect(at(row)[0] - 0.6, at(row)[1] - 0.6, 1.2, 1.2);
  }
  pen.globalAlpha = 1;
  pen.strokeStyle = colours.edges;
  pen.lineWidth = 1.2;
  pen.stroke();
}
