"use strict";
// Puts the page together: state, what a toggle, a key or the slider changes, and one drawing per
// screen refresh at most.

class Viewer {
  constructor(scene) {
    this.scene = scene;
    this.flat = scene.dimension <= 2;
    this.axes = [0, 1, 2].map((axis) => (axis < scene.axes ? axis : -1));
    this.on = { points: true, survivors: true, vertices: true, faces: true, edges: true, axes: true, stretch: false };
    this.at = 0;
    this.picked = null;  // an id
    this.canvas = document.getElementById("canvas");
    this.overlay = new Overlay(document.getElementById("overlay"));
    this.stage = new Stage(this.canvas, this.flat);
    this.rig = this.flat ? new PlotRig() : new Rig();
    this.dark = window.matchMedia("(prefers-color-scheme: dark)");
    this.dark.addEventListener("change", () => this.readColours());
    handle(this.canvas, () => this.rig, () => this.invalidate(), (x, y, radius) => this.pick(this.rowAt(x, y, radius)));
    this.buildControls();
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    this.readColours();
    this.measure();
    this.reframe();
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
    const names = this.axes.map((a) => (a < 0 ? undefined : axisName(a, this.scene.dimension)));
    this.overlay.begin(this.width, this.height, this.ratio, this.colours);
    if (this.on.axes && this.frame.vertices > 0) {
      if (this.flat) this.overlay.plot(this.space, this.rig, names);
      else this.overlay.box(this.space, this.rig, names);
    }
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
    for (const name of ["paper", "ink", "soft", "points", "survivors", "vertices", "hull", "edges", "axes"])
      this.colours[name] = style.getPropertyValue("--" + name).trim();
    this.stage.colour(this.colours);
    this.invalidate();
  }
  measure() {
    this.width = Math.max(1, this.canvas.clientWidth);
    this.height = Math.max(1, this.canvas.clientHeight);
    this.ratio = Math.min(3, window.devicePixelRatio || 1);
    this.stage.resize(this.width, this.height, this.ratio);
    this.rig.resize(this.width, this.height);
  }
  resize() {
    this.measure();
    this.draw();  // at once: a resized canvas is blank until drawn
  }

  // Other axes, or stretched: another space, seen whole.
  reframe() {
    this.space = new Space(this.scene, this.axes, this.on.stretch);
    this.rig.fit(this.space.extent);
    this.load();
  }
  load() {
    this.stage.load(this.frame, this.space);
    showFigures(this.frame.report);
    showNotes(this.scene, this.frame);
    this.showPick();
    this.invalidate();
  }

  placed(row) {
    const out = [0, 0, 0];
    this.space.place(this.frame.coordinates, row, out, 0);
    return out;
  }
  pickedRow() {
    if (this.picked === null) return null;
    const row = this.frame.ids.indexOf(this.picked);
    return row < 0 ? null : row;
  }
  pick(row) {
    this.picked = row === null ? null : this.frame.ids[row];
    this.showPick();
    this.invalidate();
  }
  showPick() {
    showPicked(this.scene, this.frame, this.pickedRow());
  }
  // The row drawn nearest to a place on the screen: vertices before others, near before far.
  rowAt(x, y, radius) {
    const { vertices, survivors, points } = this.frame;
    const groups = [["vertices", 0, vertices], ["survivors", vertices, survivors], ["points", vertices + survivors, points]];
    for (const [name, from, count] of groups) {
      if (!this.on[name]) continue;
      let best = null, least = Infinity;
      for (let row = from; row < from + count; ++row) {
        const [u, v, depth] = this.rig.project(this.placed(row));
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
    const count = this.frame.vertices;
    if (count === 0) return;
    const row = this.pickedRow();
    this.pick(row === null || row >= count ? (by > 0 ? 0 : count - 1) : (row + by + count) % count);
  }

  buildControls() {
    document.getElementById("title").textContent = document.title;
    for (const [id, act] of [["nearer", () => this.rig.zoom(1.3)], ["farther", () => this.rig.zoom(1 / 1.3)], ["reset", () => this.rig.fit(this.space.extent)]])
      document.getElementById(id).addEventListener("click", () => {
        act();
        this.invalidate();
      });
    this.buildToggles();
    if (this.scene.axes > 3) this.buildAxes();
    if (this.scene.frames.length > 1) this.timeline = new Timeline(this.scene, (at) => this.go(at));
    document.addEventListener("keydown", (event) => this.key(event));
  }
  buildToggles() {
    const any = (name) => this.scene.frames.some((f) => f[name] > 0 || f[name].length > 0);
    const toggles = [
      ["points", "Dropped", "P", "points", "", any("points")],
      ["survivors", "Survivors", "S", "survivors", "", any("survivors")],
      ["vertices", "Vertices", "V", "vertices", "", any("vertices")],
      ["faces", this.flat ? "Area" : "Faces", "F", "hull", "area", any("triangles")],
      ["edges", "Edges", "E", "edges", "stroke", any("edges")],
      ["axes", "Axes", "A", "axes", "stroke", true],
      ["stretch", "Stretch", "X", "", "", this.scene.axes > 1],
    ];
    this.keys = {};
    for (const [name, label, key, colour, shape, there] of toggles) {
      const box = element("input", { type: "checkbox", id: "show-" + name });
      box.checked = this.on[name] && there;
      box.disabled = !there;
      this.on[name] = box.checked;
      box.addEventListener("change", () => {
        this.on[name] = box.checked;
        if (name === "stretch") this.reframe();
        this.invalidate();
      });
      this.keys[key.toLowerCase()] = () => box.click();
      const line = element("label", there ? {} : { class: "none" }, box);
      if (colour) line.append(element("span", { class: "swatch " + shape, style: `background: var(--${colour})` }));
      line.append(label, element("kbd", {}, key));
      document.getElementById("toggles").append(line);
    }
  }
  buildAxes() {
    document.getElementById("axis-choice").hidden = false;
    [0, 1, 2].forEach((i) => {
      const choice = element("select", { id: "axis-" + i });
      for (let axis = 0; axis < this.scene.axes; ++axis)
        choice.append(element("option", { value: axis }, axisName(axis, this.scene.dimension)));
      choice.value = this.axes[i];
      choice.addEventListener("change", () => this.choose(i, Number(choice.value)));
      document.getElementById("axes").append(element("label", {}, ["Right", "Back", "Up"][i], choice));
    });
  }
  // An axis that is taken changes places.
  choose(i, axis) {
    const other = this.axes.indexOf(axis);
    if (other >= 0) this.axes[other] = this.axes[i];
    this.axes[i] = axis;
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
    else if (event.key === "Escape") this.pick(null);
    else if (event.key === " " && this.timeline && tag !== "BUTTON" && tag !== "INPUT" && tag !== "SUMMARY") this.timeline.toggle();
    else if (event.key === "," && this.timeline) this.timeline.step(-1);
    else if (event.key === "." && this.timeline) this.timeline.step(1);
    else if (event.key.toLowerCase() === "n") this.step(1);
    else if (event.key.toLowerCase() === "b") this.step(-1);
    else if (event.key.toLowerCase() === "r") this.rig.fit(this.space.extent);
    else if (this.keys[event.key.toLowerCase()]) this.keys[event.key.toLowerCase()]();
    else return;
    event.preventDefault();
    this.invalidate();
  }
}

// The slider of a moving set. Plays about twelve frames a second, over and over.
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
    this.when.textContent = `frame ${frame.index} of ${this.scene.frame_count}`;
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
    new Viewer(scene);
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
