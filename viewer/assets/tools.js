"use strict";
// Tools for a picture: facet details, measuring, clipping, saving.

// The first triangle that a line of sight meets in front of the camera and not clipped: its number
// and the point of intersection (in the picture's units), or null.
function triangleAt(positions, triangles, sight, clip) {
  const { from: o, along: d } = sight;
  let best = null;
  for (let t = 0; t < triangles.length / 3; ++t) {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[3 * t + k]);
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
    const px = d[1] * vz - d[2] * vy, py = d[2] * vx - d[0] * vz, pz = d[0] * vy - d[1] * vx;
    const det = ux * px + uy * py + uz * pz;
    if (det === 0) continue;
    const sx = o[0] - positions[a], sy = o[1] - positions[a + 1], sz = o[2] - positions[a + 2];
    const u = (sx * px + sy * py + sz * pz) / det;
    if (!(u >= 0 && u <= 1)) continue;
    const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
    const v = (d[0] * qx + d[1] * qy + d[2] * qz) / det;
    if (!(v >= 0 && u + v <= 1)) continue;
    const away = (vx * qx + vy * qy + vz * qz) / det;
    if (!(away > 0) || (best !== null && away >= best.away)) continue;
    const place = [0, 1, 2].map((i) => o[i] + away * d[i]);
    if (clip.x * place[0] + clip.y * place[1] + clip.z * place[2] > clip.w) continue;
    best = { triangle: t, away, place };
  }
  return best;
}

// The triangle of a plot that a place is in: its number, or null.
function flatTriangleAt(positions, triangles, [x, y]) {
  for (let t = 0; t < triangles.length / 3; ++t) {
    const corners = [0, 1, 2].map((k) => 3 * triangles[3 * t + k]);
    const turns = corners.map((a, k) => {
      const b = corners[(k + 1) % 3];
      return (positions[b] - positions[a]) * (y - positions[a + 1]) - (positions[b + 1] - positions[a + 1]) * (x - positions[a]);
    });
    if (turns.every((turn) => turn >= 0) || turns.every((turn) => turn <= 0)) return t;
  }
  return null;
}

// Area, outward unit normal, offset and corners of a facet of a 3D hull, from the exact
// coordinates. Computed in doubles relative to the first corner: accurate to about 12 digits.
function facetFigures(scene, frame, facet) {
  const at = (row) => [0, 1, 2].map((i) => frame.coordinates[row * scene.axes + i]);
  const sum = [0, 0, 0], corners = new Set(), triangles = [];
  for (let t = 0; t < frame.facets.length; ++t) {
    if (frame.facets[t] !== facet) continue;
    triangles.push(t);
    const rows = frame.triangles.slice(3 * t, 3 * t + 3);
    for (const row of rows) corners.add(frame.ids[row]);
    const [a, b, c] = [...rows].map(at);
    const u = b.map((x, i) => x - a[i]), v = c.map((x, i) => x - a[i]);
    sum[0] += u[1] * v[2] - u[2] * v[1];
    sum[1] += u[2] * v[0] - u[0] * v[2];
    sum[2] += u[0] * v[1] - u[1] * v[0];
  }
  const length = Math.hypot(...sum);
  const normal = sum.map((x) => x / length);
  const first = at(frame.triangles[3 * triangles[0]]);
  const offset = -(normal[0] * first[0] + normal[1] * first[1] + normal[2] * first[2]);
  return { id: facet, area: length / 2, normal, offset, corners: [...corners].sort((a, b) => a - b), triangles };
}

// Measures the distance between two points, one click each, using all coordinates.
class Measure {
  constructor(viewer) {
    this.viewer = viewer;
    this.on = false;
    this.ends = [];
    this.button = document.getElementById("measure");
    this.box = document.getElementById("measured");
    this.button.addEventListener("click", () => this.toggle());
  }
  toggle() {
    this.on = !this.on;
    this.ends = [];
    this.button.setAttribute("aria-pressed", String(this.on));
    if (this.on) document.documentElement.dataset.measuring = "yes";
    else delete document.documentElement.dataset.measuring;
    this.show();
  }
  // `end`: coordinates and a name; null: the click hit nothing.
  add(end) {
    if (end === null) return;
    if (this.ends.length === 2) this.ends = [];
    this.ends.push(end);
    this.show();
  }
  distance() {
    const [a, b] = this.ends.map((e) => e.coordinates);
    return Math.hypot(...a.map((x, i) => b[i] - x));
  }
  show() {
    this.box.hidden = !this.on;
    this.viewer.invalidate();
    if (!this.on) return;
    if (this.ends.length < 2) {
      this.box.replaceChildren(element("span", { class: "soft" }, this.ends.length === 0 ? "Click where to begin." : `From ${this.ends[0].name}. Click where to end.`));
      return;
    }
    const [a, b] = this.ends;
    const rows = [["Distance", numberCell(this.distance())]];
    a.coordinates.forEach((x, i) => rows.push(["Along " + axisName(i, this.viewer.scene.dimension), numberCell(b.coordinates[i] - x)]));
    this.box.replaceChildren(element("strong", {}, `${a.name} to ${b.name}`), tableOf(rows));
  }
  draw(overlay, rig, space) {
    const seen = this.ends.map((e) => rig.project(space.axes.map((axis, i) => (axis < 0 ? 0 : space.toPicture(i, e.coordinates[axis])))));
    if (seen.some((s) => s[2] <= 0)) return;
    if (seen.length === 2) overlay.measure(seen[0], seen[1], numberText(this.distance()));
    else for (const [x, y] of seen) overlay.dot(x, y);
  }
}

// A clip plane orthogonal to an axis; hides what is beyond it.
class Clip {
  constructor(viewer) {
    this.viewer = viewer;
    this.axis = document.getElementById("clip-axis");
    this.place = document.getElementById("clip-place");
    this.flip = document.getElementById("clip-flip");
    this.sign = 1;
    for (const input of [this.axis, this.place]) input.addEventListener("input", () => this.apply());
    this.flip.addEventListener("click", () => {
      this.sign = -this.sign;
      this.apply();
    });
  }
  offer(names) {
    const chosen = this.axis.options.length > 0 ? this.axis.value : this.first();
    this.axis.replaceChildren(element("option", { value: "" }, "Off"),
      ...names.map((name, i) => element("option", { value: i }, "Across " + name)));
    this.axis.value = chosen !== "" && Number(chosen) < names.length ? chosen : "";
    document.getElementById("clip-choice").hidden = names.length < 3;
    if (names.length < 3) this.axis.value = "";
    this.apply();
  }
  // Tetrahedra are visible only in the section; it starts at the front.
  first() {
    if (!this.viewer.scene.frames.some((f) => f.cell_corners === 4)) return "";
    this.sign = -1;
    return "1";
  }
  get on() {
    return this.axis.value !== "";
  }
  apply() {
    const { on } = this;
    this.place.parentElement.hidden = !on;
    this.flip.disabled = !on;
    const clip = this.viewer.stage.clip.value;
    if (!on) clip.set(0, 0, 0, 1);
    else {
      const normal = [0, 0, 0], i = Number(this.axis.value);
      normal[i] = this.sign;
      clip.set(...normal, this.sign * (2 * (this.place.value / 1000) - 1) * this.viewer.space.extent[i]);
    }
    if (this.viewer.cells) this.viewer.cut();
    this.viewer.invalidate();
  }
}

function saveBlob(blob, name) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
function fileStem() {
  return document.title.replace(/\.[a-z0-9]+$/i, "").replace(/[^\w.-]+/g, "-") || "hull";
}

// Saves the picture with its labels. Draws it again, because a canvas may be empty when read later.
function savePicture(viewer) {
  viewer.draw();
  const from = [viewer.canvas, document.getElementById("overlay")];
  const canvas = element("canvas", { width: from[0].width, height: from[0].height });
  const pen = canvas.getContext("2d");
  for (const layer of from) pen.drawImage(layer, 0, 0, canvas.width, canvas.height);
  canvas.toBlob((blob) => saveBlob(blob, fileStem() + ".png"));
}

// The hull as drawn, as a PLY file of triangles with all digits.
function meshText(scene, frame, axes, shape) {
  const used = [...new Set(shape.triangles)].sort((a, b) => a - b);
  const number = new Map(used.map((row, i) => [row, i]));
  const lines = ["ply", "format ascii 1.0", "comment convex hull, from a page of cullhull view", `element vertex ${used.length}`,
    "property double x", "property double y", "property double z", `element face ${shape.triangles.length / 3}`,
    "property list uchar int vertex_indices", "end_header"];
  for (const row of used)
    lines.push(axes.map((axis) => (axis < 0 ? 0 : frame.coordinates[row * scene.axes + axis])).join(" "));
  for (let i = 0; i < shape.triangles.length; i += 3)
    lines.push("3 " + [0, 1, 2].map((k) => number.get(shape.triangles[i + k])).join(" "));
  return lines.join("\n") + "\n";
}
