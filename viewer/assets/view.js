"use strict";
// Connects the parts of the page: state, controls, keys, the slider, and at most one drawing per
// screen refresh.

class Viewer {
  constructor(scene) {
    this.scene = scene;
    this.axes = [0, 1, 2].map((axis) => (axis < scene.axes ? axis : -1));
    this.on = { points: true, survivors: true, vertices: true, faces: true, edges: true, axes: true, web: false, cells: true };
    this.at = 0;
    this.picked = null;  // the id of a point
    this.facet = null;   // a result of facetFigures
    this.canvas = document.getElementById("canvas");
    this.overlay = new Overlay(document.getElementById("overlay"));
    this.stage = new Stage(this.canvas);
    this.rigs = { plot: new PlotRig(), solid: new Rig() };
    this.proportions = String(heightFactor(scene));
    this.colourBy = scene.frames.some((f) => f.colours) ? "file" : this.proportions !== "1" ? "2" : "role";
    this.measure = new Measure(this);
    this.clip = new Clip(this);
    this.dark = window.matchMedia("(prefers-color-scheme: dark)");
    this.dark.addEventListener("change", () => this.readColours());
    handle(this.canvas, () => this.rig, () => this.invalidate(), (x, y, radius) => this.click(x, y, radius));
    this.buildControls();
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    this.readColours();
    this.measureStage();
    this.reframe();
  }
  // True for a plot of two axes, false for a 3D picture that can be turned.
  get flat() {
    return this.axes[2] < 0;
  }
  get rig() {
    return this.flat ? this.rigs.plot : this.rigs.solid;
  }
  get names() {
    return this.axes.filter((a) => a >= 0).map((a) => axisName(a, this.scene.dimension));
  }
  get frame() {
    return this.scene.frames[this.at];
  }

  invalidate() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }
  draw() {
    this.stage.show(this.on);
    this.stage.render(this.rig);
    this.overlay.begin(this.width, this.height, this.ratio, this.colours);
    if (this.on.axes && this.frame.vertices > 0) {
      if (this.flat) this.overlay.plot(this.space, this.rig, this.names);
      else this.overlay.box(this.space, this.rig, this.names);
      if (!this.flat && Number(this.proportions) > 1) this.overlay.remark(`${this.names[2]} × ${this.proportions}`);
    }
    this.measure.draw(this.overlay, this.rig, this.space);
    const row = this.pickedRow();
    if (row !== null) {
      const [x, y, depth] = this.rig.project(this.placed(row));
      if (depth > 0) this.overlay.ring(x, y, String(this.picked));
    }
    document.documentElement.dataset.drawn = String(Number(document.documentElement.dataset.drawn || 0) + 1);
  }

  readColours() {
    const style = getComputedStyle(document.documentElement);
    this.colours = {};
    for (const name of ["paper", "ink", "soft", "points", "survivors", "vertices", "hull", "lit", "shade", "picked", "edges", "axes"])
      this.colours[name] = style.getPropertyValue("--" + name).trim();
    this.stage.colour(this.colours);
    this.drawPairs();
    this.invalidate();
  }
  measureStage() {
    this.width = Math.max(1, this.canvas.clientWidth);
    this.height = Math.max(1, this.canvas.clientHeight);
    this.ratio = Math.min(3, window.devicePixelRatio || 1);
    this.stage.resize(this.width, this.height, this.ratio);
    for (const rig of Object.values(this.rigs)) rig.resize(this.width, this.height);
  }
  resize() {
    this.measureStage();
    this.draw();  // at once: a resized canvas is blank until drawn
  }

  // For other axes or proportions: creates a new space and shows all of it.
  reframe() {
    this.space = new Space(this.scene, this.axes, this.proportions);
    this.rig.fit(this.space.extent, this.on.axes);
    this.clip.offer(this.names);
    document.getElementById("glass-choice").hidden = this.flat;
    this.load();
  }
  load() {
    const frame = this.frame;
    this.shape = shapeOn(this.scene, frame, this.axes);
    this.stage.load(frame, this.space, this.shape, this.flat);
    this.cells = frame.cells && this.space.positions(frame, 0, frame.ids.length);
    this.cut();
    this.tint();
    if (this.facet) this.pickFacet(null);
    showFigures(frame.report);
    showNotes(this.scene, frame);
    this.showPick();
    this.drawPairs();
    this.invalidate();
  }
  // Loads the visible cells, cut by the clip plane if there is one.
  cut() {
    this.stage.loadCells(this.cells ? cellShape(this.frame, this.cells, this.clip.on ? this.stage.clip.value : null) : null);
  }
  tint() {
    const byAxis = this.colourBy !== "role" && this.colourBy !== "file";
    if (byAxis) {
      this.ranges = this.ranges || {};
      this.ranges[this.colourBy] = this.ranges[this.colourBy] || colourRange(this.scene, this.colourBy);
    }
    const range = byAxis ? this.ranges[this.colourBy] : null;
    this.stage.tint(rowColours(this.scene, this.frame, this.colourBy, range), this.frame.survivors);
    document.getElementById("legend").hidden = !byAxis;
    if (byAxis) {
      const name = colourName(this.scene, this.colourBy);
      document.querySelector("#legend i").style.background = scaleGradient(range);
      document.getElementById("legend-low").textContent = `${name} ${numberText(Number(range.low.toPrecision(4)))}`;
      document.getElementById("legend-high").textContent = numberText(Number(range.high.toPrecision(4)));
    }
    this.invalidate();
  }

  placed(row) {
    const out = [0, 0, 0];
    this.space.place(this.frame.coordinates, row, out, 0);
    return out;
  }
  // Of a diagram sites are picked, whose rows are behind the corners of their cells.
  get firstPicked() {
    return this.frame.measures ? this.frame.vertices : 0;
  }
  pickedRow() {
    if (this.picked === null) return null;
    const row = this.frame.ids.indexOf(this.picked, this.firstPicked);
    return row < 0 ? null : row;
  }
  pick(row) {
    this.picked = row === null ? null : this.frame.ids[row];
    if (this.facet) this.pickFacet(null);
    this.showPick();
    this.invalidate();
  }
  get hasFacets() {
    return !this.flat && Boolean(this.shape && this.shape.facets);
  }
  pickFacet(facet) {
    this.facet = facet === null ? null : facetFigures(this.scene, this.frame, facet);
    this.stage.mark(this.facet && this.facet.triangles);
    if (this.facet) this.picked = null;
    this.showPick();
    this.invalidate();
  }
  showPick() {
    const row = this.pickedRow();
    if (this.facet) showPickedFacet(this.scene, this.facet);
    else if (row !== null) showPickedRow(this.scene, this.frame, row);
    else showNothingPicked(this.hasFacets, Boolean(this.frame.measures));
  }
  // Handles a click: it picks a vertex, else the facet in front, else any point.
  click(x, y, radius) {
    if (this.frame.measures && !this.measure.on) return this.pick(this.siteAt(x, y));
    const vertex = this.rowAt(x, y, radius, ["vertices"]);
    const hit = vertex === null ? this.surfaceAt(x, y) : null;
    const row = vertex !== null || hit ? vertex : this.rowAt(x, y, radius, ["survivors", "points"]);
    if (this.measure.on) this.measure.add(this.endOf(row, hit));
    else if (hit && this.hasFacets) this.pickFacet(this.shape.facets[hit.triangle]);
    else this.pick(row);
  }
  // Of a diagram: the row of the site whose cell is there, or null.
  siteAt(x, y) {
    const { frame } = this;
    let triangle = null;
    if (this.flat) triangle = flatTriangleAt(this.stage.hull, frame.triangles, this.rig.toPicture(x, y));
    else {
      const hit = this.surfaceAt(x, y);
      if (hit) triangle = hit.triangle;
    }
    return triangle === null ? null : frame.vertices + frame.ids[frame.triangles[3 * triangle]];
  }
  surfaceAt(x, y) {
    if (this.flat || !this.on.faces || this.scene.axes > 3) return null;
    return triangleAt(this.stage.hull, this.shape.triangles, this.rig.sight(x, y), this.stage.clip.value);
  }
  // One end of a measuring line.
  endOf(row, hit) {
    if (row !== null) {
      const coordinates = [...this.frame.coordinates.slice(row * this.scene.axes, (row + 1) * this.scene.axes)];
      return { coordinates, name: `${rowKind(this.frame, row).toLowerCase()} ${this.frame.ids[row]}` };
    }
    if (!hit) return null;
    const coordinates = hit.place.map((p, i) => this.space.toValue(i, p)).slice(0, this.scene.axes);
    return { coordinates, name: "a place on the hull" };
  }
  // The row drawn nearest to a point of the screen; nearer groups first.
  rowAt(x, y, radius, names) {
    const { vertices, survivors, points } = this.frame;
    const groups = [["vertices", 0, vertices], ["survivors", vertices, survivors], ["points", vertices + survivors, points]];
    const clip = this.stage.clip.value;
    for (const [name, from, count] of groups) {
      if (!this.on[name] || !names.includes(name)) continue;
      let best = null, least = Infinity;
      for (let row = from; row < from + count; ++row) {
        const place = this.placed(row);
        if (clip.x * place[0] + clip.y * place[1] + clip.z * place[2] > clip.w) continue;
        const [u, v, depth] = this.rig.project(place);
        const off = Math.hypot(u - x, v - y);
        if (depth <= 0 || off > radius) continue;
        const score = off / radius + (this.flat ? 0 : depth / this.rig.radius);
        if (score < least) [best, least] = [row, score];
      }
      if (best !== null) return best;
    }
    return null;
  }
  step(by) {
    const first = this.firstPicked, count = this.frame.measures ? this.frame.survivors : this.frame.vertices;
    if (count === 0) return;
    const row = this.pickedRow(), at = row === null ? count : row - first;
    this.pick(first + (at >= count ? (by > 0 ? 0 : count - 1) : (at + by + count) % count));
  }
  stepFacet(by) {
    if (!this.hasFacets) return;
    const count = this.frame.report.facet_count;
    this.pickFacet(this.facet === null ? (by > 0 ? 0 : count - 1) : (this.facet.id + by + count) % count);
  }

  buildControls() {
    document.getElementById("title").textContent = document.title;
    for (const [id, act] of [["nearer", () => this.rig.zoom(1.3)], ["farther", () => this.rig.zoom(1 / 1.3)], ["reset", () => this.rig.fit(this.space.extent, this.on.axes)]])
      document.getElementById(id).addEventListener("click", () => {
        act();
        this.invalidate();
      });
    this.buildToggles();
    this.buildChoices();
    if (this.scene.axes > 3) this.buildAxes();
    document.getElementById("save-picture").addEventListener("click", () => savePicture(this));
    const mesh = document.getElementById("save-mesh");
    mesh.disabled = this.scene.frames.every((f) => f.triangles.length === 0 && !f.shadows);
    mesh.addEventListener("click", () =>
      saveBlob(new Blob([meshText(this.scene, this.frame, this.axes, this.shape)], { type: "application/octet-stream" }), fileStem() + "-hull.ply"));
    if (this.scene.frames.length > 1) this.timeline = new Timeline(this.scene, (at) => this.go(at));
    document.addEventListener("keydown", (event) => this.key(event));
  }
  buildToggles() {
    const any = (name) => this.scene.frames.some((f) => f[name] > 0 || f[name].length > 0);
    const high = this.scene.frames.some((f) => f.affine_dimension > 3);
    const shadowed = high && this.scene.frames.some((f) => f.shadows);
    const toggles = [
      ["points", "Dropped", "P", "points", "", any("points")],  // none where nothing was filtered
      ["survivors", this.scene.frames.some((f) => f.point_name) ? "Sites" : this.scene.frames.some(wasFiltered) ? "Survivors" : "Points", "S", "survivors", "", any("survivors")],
      ["vertices", "Vertices", "V", "vertices", "", any("vertices")],
      ["faces", this.flat ? "Area" : "Faces", "F", "hull", "area", high || any("triangles")],
      ["edges", high ? "Outline" : "Edges", "E", "edges", "stroke", any("edges")],
      ["axes", "Axes", "A", "axes", "stroke", true],
    ];
    if (this.scene.frames.some((f) => f.cells)) toggles.splice(4, 0, ["cells", "Cells", "C", "lit", "area", this.scene.frames.some((f) => f.cell_corners > 2)]);
    if (high) toggles.push(["web", "All edges", "W", "edges", "stroke", any("edges")]);
    this.on.web = high && !shadowed;
    this.keys = {};
    for (const [name, label, key, colour, shape, there] of toggles) {
      const box = element("input", { type: "checkbox", id: "show-" + name });
      box.checked = this.on[name] && there;
      box.disabled = !there;
      this.on[name] = box.checked;
      box.addEventListener("change", () => {
        this.on[name] = box.checked;
        this.invalidate();
      });
      this.keys[key.toLowerCase()] = () => box.click();
      const line = element("label", there ? {} : { class: "none" }, box);
      if (colour) line.append(element("span", { class: "swatch " + shape, style: `background: var(--${colour})` }));
      line.append(label, element("kbd", {}, key));
      document.getElementById("toggles").append(line);
    }
  }
  buildChoices() {
    const choice = (id, options, value, act) => {
      const select = document.getElementById(id);
      select.replaceChildren(...options.map(([v, text]) => element("option", { value: v }, text)));
      select.value = value;
      select.addEventListener("change", () => act(select.value));
      document.getElementById(id === "colour-by" ? "colour-choice" : "proportions-choice").hidden = options.length < 2;
    };
    const dots = this.scene.frames.some((f) => f.survivors + f.points > 0);
    const by = dots ? [["role", this.scene.frames.some(wasFiltered) ? "Kept or dropped" : "One colour"]] : [];
    if (dots && this.scene.frames.some((f) => f.colours)) by.push(["file", "Colours of the file"]);
    for (let axis = 0; dots && axis < this.scene.axes; ++axis)
      by.push([String(axis), axis === 2 && this.scene.dimension === 3 ? "Height (z)" : axisName(axis, this.scene.dimension)]);
    const attributed = this.scene.frames.find((f) => f.attributes);
    for (let k = 0; dots && attributed && k < attributed.attributes.length; ++k)
      by.push(["a" + k, colourName(this.scene, "a" + k)]);
    choice("colour-by", by, this.colourBy, (value) => {
      this.colourBy = value;
      this.tint();
    });
    const heights = this.scene.axes === 3 ? ["2", "4", "8", "16"].map((f) => [f, `Heights × ${f}`]) : [];
    const proportions = this.scene.axes > 1 ? [["1", "True"], ...heights, ["equal", "Equal sides"]] : [];
    choice("proportions", proportions, this.proportions, (value) => {
      this.proportions = value;
      this.reframe();
    });
    // If dots are coloured, the hull is more transparent.
    this.stage.glass = this.colourBy === "role" ? 0.5 : 0.14;
    const glass = document.getElementById("glass");
    glass.value = 100 * this.stage.glass;
    glass.addEventListener("input", () => {
      this.stage.glass = glass.value / 100;
      this.invalidate();
    });
  }

  buildAxes() {
    document.getElementById("axis-choice").hidden = false;
    [0, 1, 2].forEach((i) => {
      const choice = element("select", { id: "axis-" + i });
      for (let axis = 0; axis < this.scene.axes; ++axis)
        choice.append(element("option", { value: axis }, axisName(axis, this.scene.dimension)));
      if (i === 2) choice.append(element("option", { value: -1 }, "None"));
      choice.value = this.axes[i];
      choice.addEventListener("change", () => this.choose(i, Number(choice.value)));
      document.getElementById("axes").append(element("label", {}, ["Right", "Back", "Up"][i], choice));
    });
    // A small picture for every pair of axes; for more than 8 axes there would be too many.
    this.pairs = [];
    for (let a = 0; this.scene.axes <= 8 && a < this.scene.axes; ++a)
      for (let b = a + 1; b < this.scene.axes; ++b) {
        const canvas = element("canvas", { "aria-hidden": "true" });
        const name = `${axisName(a, this.scene.dimension)}, ${axisName(b, this.scene.dimension)}`;
        const button = element("button", { type: "button", id: `pair-${a}-${b}`, title: `Plot of ${name}` }, canvas, name);
        button.addEventListener("click", () => this.project([a, b, -1]));
        document.getElementById("pairs").append(button);
        this.pairs.push({ a, b, canvas, button });
      }
  }
  drawPairs() {
    for (const { a, b, canvas, button } of this.pairs || []) {
      button.setAttribute("aria-pressed", String(this.flat && this.axes[0] === a && this.axes[1] === b));
      drawThumbnail(canvas, this.scene, this.frame, a, b, this.colours);
    }
  }
  // Choosing an axis that is in use swaps the two; at most one axis can be "none".
  choose(i, axis) {
    const axes = [...this.axes];
    const other = axis < 0 ? -1 : axes.indexOf(axis);
    if (other >= 0) axes[other] = axes[i] >= 0 ? axes[i] : [0, 1, 2].find((a) => !axes.includes(a));
    axes[i] = axis;
    this.project(axes);
  }
  project(axes) {
    this.axes = axes;
    this.axes.forEach((a, j) => (document.getElementById("axis-" + j).value = a));
    this.reframe();
  }

  go(at) {
    this.at = at;
    this.load();
  }

  key(event) {
    const tag = event.target.tagName;
    const typing = tag === "SELECT" || (tag === "INPUT" && event.target.type !== "checkbox");
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (typing && (event.key.startsWith("Arrow") || tag === "SELECT")) return;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const arrow = arrows[event.key];
    if (arrow) {
      if (event.target !== this.canvas) return;  // elsewhere they scroll
      const [dx, dy] = arrow;
      if (event.shiftKey || this.flat) this.rig.pan(-dx * 30, -dy * 30);
      else this.rig.drag(dx * 18, dy * 18);
    } else if (event.key === "+" || event.key === "=") this.rig.zoom(1.2);
    else if (event.key === "-") this.rig.zoom(1 / 1.2);
    else if (event.key === "Escape") {
      if (this.measure.on) this.measure.toggle();
      this.pick(null);
    } else if (event.key.toLowerCase() === "m") this.measure.toggle();
    else if (event.key === "]") this.stepFacet(1);
    else if (event.key === "[") this.stepFacet(-1);
    else if (event.key === " " && this.timeline && tag !== "BUTTON" && tag !== "INPUT" && tag !== "SUMMARY") this.timeline.toggle();
    else if (event.key === "," && this.timeline) this.timeline.step(-1);
    else if (event.key === "." && this.timeline) this.timeline.step(1);
    else if (event.key.toLowerCase() === "n") this.step(1);
    else if (event.key.toLowerCase() === "b") this.step(-1);
    else if (event.key.toLowerCase() === "r") this.rig.fit(this.space.extent, this.on.axes);
    else if (this.keys[event.key.toLowerCase()]) this.keys[event.key.toLowerCase()]();
    else return;
    event.preventDefault();
    this.invalidate();
  }
}

// The slider of a moving set. Plays about twelve frames per second in a loop.
class Timeline {
  constructor(scene, go) {
    this.scene = scene;
    this.go = go;
    this.play = document.getElementById("play");
    this.time = document.getElementById("time");
    this.when = document.getElementById("when");
    document.getElementById("timeline").hidden = false;
    document.documentElement.dataset.moving = "yes";
    this.time.max = scene.frames.length - 1;
    this.time.addEventListener("input", () => this.show(Number(this.time.value)));
    this.play.addEventListener("click", () => this.toggle());
    this.label();
  }
  label() {
    const frame = this.scene.frames[this.time.value];
    this.when.textContent = `Frame ${frame.index + 1} of ${this.scene.frame_count}`;
  }
  show(at) {
    this.time.value = at;
    this.label();
    this.go(at);
  }
  step(by) {
    const count = this.scene.frames.length;
    this.show((Number(this.time.value) + by + count) % count);
  }
  toggle() {
    const playing = this.timer === undefined;
    if (playing) this.timer = setInterval(() => this.step(1), 80);
    else this.timer = clearInterval(this.timer);
    this.play.textContent = playing ? "Pause" : "Play";
  }
}

function start() {
  const message = document.getElementById("message");
  const scene = readScene();
  if (scene.frames.every((f) => f.vertices === 0)) {
    message.textContent = "There are no points to show.";
    message.hidden = false;
  }
  try {
    window.viewer = new Viewer(scene);
  } catch (error) {
    message.textContent = "This browser offers no WebGL, which the picture needs. The figures are all here.";
    message.hidden = false;
    document.getElementById("title").textContent = document.title;
    showFigures(scene.frames[0].report);
    showNotes(scene, scene.frames[0]);
    console.warn(error);
  }
}
start();
