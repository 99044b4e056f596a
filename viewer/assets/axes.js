"use strict";
// Axes with round numbers: on the frame of a plot, or on three edges of the bounding box of a 3D
// set.

// About `wanted` round values in [low, high], and a function that formats them so that they differ.
function niceTicks(low, high, wanted) {
  const span = high / 2 - low / 2;
  const write = (v) => String(Number(v.toPrecision(6)));
  if (!(span > 0)) return { values: [low], write };
  const rough = span / (wanted / 2);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.7) || rough;
  const largest = Math.max(Math.abs(low), Math.abs(high));
  const values = [];
  // Neighbouring doubles may be farther apart than the step.
  if (step > largest * 1e-14 && step > 0 && Number.isFinite(step))
    for (let k = Math.ceil(low / step); values.length < 40; ++k) {
      const v = k * step;
      if (!(v <= high)) break;
      values.push(v);
    }
  if (values.length === 0) return { values: [low, high], write: (v) => String(v) };
  const digits = Math.min(15, Math.max(0, Math.round(Math.log10(largest) - Math.floor(Math.log10(step)))));
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  if (largest >= 1e7 || step < 1e-5)
    return { values, write: (v) => (v === 0 ? "0" : v.toExponential(Math.min(digits, 12)).replace(/\.?0+e/, "e").replace("e+", "e").replace("-", "−")) };
  return { values, write: (v) => v.toFixed(Math.min(decimals, 15)).replace("-", "−") };
}

class Overlay {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
  }
  begin(width, height, ratio, colours) {
    this.width = width;
    this.height = height;
    this.colours = colours;
    // Setting the size clears the canvas. Clearing it alone left the old picture on the screen.
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.pen.font = "12px system-ui, 'Segoe UI', 'Liberation Sans', sans-serif";
    this.pen.lineWidth = 1;
    this.taken = [];
  }
  // Omits numbers that would overlap others.
  number(text, x, y, align, baseline) {
    const width = this.pen.measureText(text).width + 6;
    const left = x - { left: 0, center: width / 2, right: width }[align];
    const top = y - { top: 0, middle: 8, bottom: 16 }[baseline];
    if (this.taken.some(([l, t, w]) => left < l + w && l < left + width && top < t + 16 && t < top + 16)) return;
    this.taken.push([left, top, width]);
    this.text(text, x, y, align, baseline);
  }
  // A remark in the corner of the picture.
  remark(text) {
    this.text(text, this.width - 14, this.height - 12, "right", "bottom");
  }
  line(x1, y1, x2, y2) {
    this.pen.beginPath();
    this.pen.moveTo(x1, y1);
    this.pen.lineTo(x2, y2);
    this.pen.stroke();
  }
  // Text with an outline in the background colour, readable on anything.
  text(text, x, y, align, baseline, colour) {
    const pen = this.pen;
    pen.textAlign = align;
    pen.textBaseline = baseline;
    pen.lineWidth = 3;
    pen.lineJoin = "round";
    pen.strokeStyle = this.colours.paper;
    pen.strokeText(text, x, y);
    pen.fillStyle = colour || this.colours.soft;
    pen.fillText(text, x, y);
    pen.lineWidth = 1;
  }

  // The frame of a plot, with ticks at the left and bottom margins.
  plot(space, rig, names) {
    const { pen, colours, height, width } = this;
    const margin = rig.margin;
    const right = width - margin.right, bottom = height - margin.bottom;
    pen.strokeStyle = colours.axes;
    pen.strokeRect(margin.left + 0.5, margin.top + 0.5, right - margin.left, bottom - margin.top);
    const [x0, y1] = rig.toPicture(margin.left, margin.top), [x1, y0] = rig.toPicture(right, bottom);
    const across = niceTicks(space.toValue(0, x0), space.toValue(0, x1), Math.max(2, (right - margin.left) / 110));
    for (const v of across.values) {
      const x = Math.round(rig.toScreen(space.toPicture(0, v), 0)[0]) + 0.5;
      pen.strokeStyle = colours.axes;
      this.line(x, bottom, x, bottom + 5);
      this.number(across.write(v), x, bottom + 8, "center", "top");
    }
    this.text(names[0], right, bottom + 23, "right", "top", colours.ink);
    if (names[1] === undefined) return;
    const up = niceTicks(space.toValue(1, y0), space.toValue(1, y1), Math.max(2, (bottom - margin.top) / 70));
    for (const v of up.values) {
      const y = Math.round(rig.toScreen(0, space.toPicture(1, v))[1]) + 0.5;
      pen.strokeStyle = colours.axes;
      this.line(margin.left - 5, y, margin.left, y);
      this.number(up.write(v), margin.left - 8, y, "right", "middle");
    }
    this.text(names[1], margin.left - 8, margin.top - 4, "right", "bottom", colours.ink);
  }

  // Numbers each axis on the edge of the box where they overlap least: x and y on the lowest edge
  // on the screen, z on the leftmost.
  box(space, rig, names) {
    const e = space.extent;
    const [cx, cy] = rig.project([0, 0, 0]);
    for (let axis = 0; axis < 3; ++axis) {
      if (names[axis] === undefined || e[axis] === 0) continue;
      const [p, q] = [0, 1, 2].filter((i) => i !== axis);
      let best = null;
      for (const [s, t] of [[-1, -1], [-1, 1], [1, -1], [1, 1]]) {
        const at = (place) => {
          const corner = [0, 0, 0];
          corner[axis] = place;
          corner[p] = s * e[p];
          corner[q] = t * e[q];
          return rig.project(corner);
        };
        const middle = at(0);
        const score = axis === 2 ? -middle[0] : middle[1];
        if (best === null || score > best.score + 0.5) best = { score, at, middle };
      }
      this.edge(space, axis, best, names[axis], cx, cy);
    }
  }
  edge(space, axis, { at, middle }, name, cx, cy) {
    const { pen, colours } = this;
    const from = at(-space.extent[axis]), to = at(space.extent[axis]);
    if (from[2] <= 0 || to[2] <= 0) return;  // behind the camera
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (length < 30) return;
    // Outward from the middle of the picture, orthogonal to the edge.
    let nx = -(to[1] - from[1]) / length, ny = (to[0] - from[0]) / length;
    if (nx * (middle[0] - cx) + ny * (middle[1] - cy) < 0) [nx, ny] = [-nx, -ny];
    const align = nx > 0.5 ? "left" : nx < -0.5 ? "right" : "center";
    const baseline = ny > 0.5 ? "top" : ny < -0.5 ? "bottom" : "middle";
    const ticks = niceTicks(space.toValue(axis, -space.extent[axis]), space.toValue(axis, space.extent[axis]), Math.max(2, length / 80));
    for (const v of ticks.values) {
      const [x, y] = at(space.toPicture(axis, v));
      pen.strokeStyle = colours.axes;
      this.line(x, y, x + 5 * nx, y + 5 * ny);
      this.number(ticks.write(v), x + 8 * nx, y + 8 * ny, align, baseline);
    }
    const far = 8 + (align === "center" ? 18 : 46);
    // Inside of the picture, which is narrow on phones.
    const wide = this.pen.measureText(name).width + 4;
    const [before, behind] = { left: [0, wide], center: [wide / 2, wide / 2], right: [wide, 0] }[align];
    const x = Math.max(before + 2, Math.min(this.width - behind - 2, middle[0] + far * nx));
    const y = Math.max(16, Math.min(this.height - 16, middle[1] + far * ny));
    this.text(name, x, y, align, baseline, colours.ink);
  }

  dot(x, y) {
    const { pen, colours } = this;
    for (const [colour, radius] of [[colours.paper, 6], [colours.picked, 4]]) {
      pen.fillStyle = colour;
      pen.beginPath();
      pen.arc(x, y, radius, 0, 2 * Math.PI);
      pen.fill();
    }
  }
  // A measuring line, labelled with its length.
  measure(from, to, label) {
    const { pen, colours } = this;
    for (const [colour, width] of [[colours.paper, 5], [colours.picked, 2]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      this.line(from[0], from[1], to[0], to[1]);
    }
    pen.lineWidth = 1;
    this.dot(from[0], from[1]);
    this.dot(to[0], to[1]);
    pen.font = "600 14px system-ui, 'Segoe UI', 'Liberation Sans', sans-serif";
    this.text(label, (from[0] + to[0]) / 2, (from[1] + to[1]) / 2 - 8, "center", "bottom", colours.ink);
  }

  ring(x, y, label) {
    const { pen, colours } = this;
    for (const [colour, width] of [[colours.paper, 5], [colours.survivors, 2]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.beginPath();
      pen.arc(x, y, 8, 0, 2 * Math.PI);
      pen.stroke();
    }
    pen.lineWidth = 1;
    this.text(label, x + 13, y - 9, "left", "bottom", colours.ink);
  }
}
