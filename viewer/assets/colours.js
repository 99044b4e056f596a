"use strict";
// Colours of dots: by their role for the filter, from the file, or by a coordinate.

// Viridis (matplotlib, CC0), at nine points.
const scaleStops = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"]
  .map((c) => [1, 3, 5].map((i) => parseInt(c.slice(i, i + 2), 16)));

// The colour at t in [0, 1], as three bytes.
function scaleColour(t, out, at) {
  const place = Math.max(0, Math.min(1, t)) * (scaleStops.length - 1);
  const i = Math.min(scaleStops.length - 2, Math.floor(place)), f = place - i;
  for (let c = 0; c < 3; ++c) out[at + c] = Math.round(scaleStops[i][c] * (1 - f) + scaleStops[i + 1][c] * f);
}

// The number of a row by which it is coloured: of an axis ("2") or of an attribute ("a0").
function valueOf(scene, frame, by, row) {
  if (by[0] !== "a") return frame.coordinates[row * scene.axes + Number(by)];
  const attribute = (frame.attributes || [])[Number(by.slice(1))];
  return attribute ? attribute.values[row] : 0;
}
function colourName(scene, by) {
  if (by[0] !== "a") return axisName(Number(by), scene.dimension);
  const name = scene.frames.find((f) => f.attributes).attributes[Number(by.slice(1))].name;
  return name[0].toUpperCase() + name.slice(1).replaceAll("_", " ");
}

// The range of values that a colour scale covers: without the outermost two per cent at either end,
// so that a bird above a landscape does not compress all other colours. If most values are low,
// such as the ground between trees, the scale is t to a power, which gives them more of the
// colours.
function colourRange(scene, by) {
  const values = [];
  for (const frame of scene.frames) {
    const step = Math.max(1, Math.floor((frame.ids.length * scene.frames.length) / 20000));
    for (let row = 0; row < frame.ids.length; row += step) values.push(valueOf(scene, frame, by, row));
  }
  values.sort((a, b) => a - b);
  const at = (share) => values[Math.min(values.length - 1, Math.floor(share * values.length))] || 0;
  let low = at(0.02), high = at(0.98);
  if (!(low < high)) [low, high] = [values[0] || 0, values[values.length - 1] || 0];
  const median = (at(0.5) / 2 - low / 2) / (high / 2 - low / 2 || 1);
  const power = median > 0 && median < 1 ? Math.log(0.4) / Math.log(median) : 1;
  return { low, high, power: Math.max(0.4, Math.min(1, power)) };
}

// The scale as a bar, linear in the values.
function scaleGradient(range) {
  const stops = [], colour = [0, 0, 0];
  for (let i = 0; i <= 16; ++i) {
    scaleColour((i / 16) ** range.power, colour, 0);
    stops.push(`rgb(${colour.join(",")})`);
  }
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

// Three bytes for each row that is not a vertex; null for the stage's own colours.
function rowColours(scene, frame, by, range) {
  if (by === "role") return null;
  const count = frame.ids.length - frame.vertices;
  if (by === "file") return frame.colours ? frame.colours.subarray(3 * frame.vertices) : null;
  const span = range.high / 2 - range.low / 2 || 1;
  const out = new Uint8Array(3 * count);
  for (let i = 0; i < count; ++i) {
    const x = valueOf(scene, frame, by, frame.vertices + i);
    scaleColour(Math.max(0, (x / 2 - range.low / 2) / span) ** range.power, out, 3 * i);
  }
  return out;
}

// The factor by which heights of a thin set are enlarged, so that it does not look like a disc.
function heightFactor(scene) {
  if (scene.axes !== 3) return 1;
  const [x, y, z] = scene.ranges.map((r) => r.high / 2 - r.low / 2);
  const share = z / Math.max(x, y);
  if (!(share > 0) || share >= 1 / 8 || x === 0 || y === 0) return 1;
  return [2, 4, 8, 16].find((f) => share * f >= 1 / 7) || 16;
}
