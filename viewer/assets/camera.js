"use strict";
// The camera, and the mouse and touch input that moves it. A Rig turns around a target (3D); a
// PlotRig moves over a plane (1D and 2D). Both map points to the screen, in CSS pixels.

class Rig {
  constructor() {
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.target = new THREE.Vector3();
  }
  // `numbered`: leave room for the axes' numbers.
  fit(extent, numbered = true) {
    this.radius = Math.hypot(...extent) || 1;
    this.target.set(0, 0, 0);
    this.yaw = -0.9;
    // Flat sets are seen from higher up.
    this.pitch = extent[2] < 0.4 * Math.max(extent[0], extent[1]) ? 0.62 : 0.42;
    this.reach = 1;
    this.update();
    this.fill(extent, numbered);
  }
  // Moves as near as the bounding box and the numbers on its edges allow.
  fill(extent, numbered) {
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => extent.map((e, j) => (i & (1 << j) ? e : -e)));
    const rim = Math.min(numbered ? 70 : 24, 0.14 * Math.min(this.width, this.height));
    const seen = () => corners.map((c) => this.project(c));
    const fits = () => seen().every(([x, y, depth]) =>
      depth > 0 && x > rim && x < this.width - rim && y > rim && y < this.height - rim);
    // Centring the visible part makes room to come nearer.
    for (let round = 0; round < 3; ++round) {
      let near = 0.2, far = 2;
      for (let i = 0; i < 12; ++i) {
        this.reach = (near + far) / 2;
        this.update();
        if (fits()) far = this.reach;
        else near = this.reach;
      }
      this.reach = far;
      this.update();
      const off = [0, 1].map((i) => {
        const places = seen().map((s) => s[i]);
        return (Math.min(...places) + Math.max(...places)) / 2;
      });
      this.pan(this.width / 2 - off[0], this.height / 2 - off[1]);
    }
  }
  // At the distance of the target.
  pixelsPerUnit() {
    return this.height / (2 * this.distance * Math.tan((this.camera.fov / 2) * (Math.PI / 180)));
  }
  resize(width, height) {
    this.width = width;
    this.height = height;
    this.camera.aspect = width / height;
    if (this.radius) this.update();
  }
  update() {
    const half = Math.tan((this.camera.fov / 2) * (Math.PI / 180));
    const whole = (1.12 * this.radius) / Math.sin(Math.atan(half * Math.min(1, this.camera.aspect)));
    this.distance = whole * this.reach;
    const c = Math.cos(this.pitch);
    this.camera.position.set(Math.cos(this.yaw) * c, Math.sin(this.yaw) * c, Math.sin(this.pitch));
    this.camera.position.multiplyScalar(this.distance).add(this.target);
    this.camera.lookAt(this.target);
    const off = this.target.length() + this.radius;
    this.camera.near = Math.max(this.distance * 0.02, this.distance - 1.5 * off);
    this.camera.far = this.distance + 1.5 * off;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.camera.matrixWorldInverse.getInverse(this.camera.matrixWorld);
    this.matrix = new THREE.Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse).elements;
  }
  // [x, y, depth]; depth > 0 is in front of the camera.
  project([x, y, z]) {
    const m = this.matrix;
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    const u = (m[0] * x + m[4] * y + m[8] * z + m[12]) / w, v = (m[1] * x + m[5] * y + m[9] * z + m[13]) / w;
    return [(u + 1) * this.width / 2, (1 - v) * this.height / 2, w];
  }
  // The line of sight through a point of the screen: its start and its direction.
  sight(sx, sy) {
    const e = this.camera.matrixWorld.elements;
    const unit = Math.tan((this.camera.fov / 2) * (Math.PI / 180)) / (this.height / 2);
    const u = (sx - this.width / 2) * unit, v = (this.height / 2 - sy) * unit;
    return { from: [e[12], e[13], e[14]], along: [0, 1, 2].map((i) => u * e[i] + v * e[4 + i] - e[8 + i]) };
  }
  drag(dx, dy) {
    this.yaw -= dx * 0.008;
    this.pitch = Math.max(-1.55, Math.min(1.55, this.pitch + dy * 0.008));
    this.update();
  }
  pan(dx, dy) {
    const unit = 1 / this.pixelsPerUnit();
    const e = this.camera.matrixWorld.elements;
    for (const [i, name] of [[0, "x"], [1, "y"], [2, "z"]])
      this.target[name] += unit * (dy * e[4 + i] - dx * e[i]);
    this.update();
  }
  zoom(factor) {
    this.reach = Math.max(1e-4, Math.min(8, this.reach / factor));
    this.update();
  }
}

class PlotRig {
  constructor() {
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 10);
    this.camera.position.set(0, 0, 5);
    this.margin = { left: 70, right: 20, top: 62, bottom: 48 };
  }
  fit(extent) {
    this.extent = extent;
    this.x = this.y = 0;
    const m = this.margin;
    const w = Math.max(50, this.width - m.left - m.right), h = Math.max(50, this.height - m.top - m.bottom);
    this.unit = Math.max((2 * extent[0]) / w, (2 * extent[1]) / h) * 1.08 || 0.01;  // per pixel
    this.whole = this.unit;
    this.update();
  }
  resize(width, height) {
    const moved = this.unit !== this.whole || this.x !== 0 || this.y !== 0;
    this.width = width;
    this.height = height;
    this.margin.left = width < 500 ? 54 : 70;
    if (!this.extent) return;
    if (moved) this.update();
    else this.fit(this.extent);
  }
  pixelsPerUnit() {
    return 1 / this.unit;
  }
  // The point of the canvas that shows (x, y): the middle of the frame, not of the canvas.
  middle() {
    const m = this.margin;
    return [(this.width + m.left - m.right) / 2, (this.height + m.top - m.bottom) / 2];
  }
  update() {
    const [mx, my] = this.middle();
    const c = this.camera;
    c.left = this.x - mx * this.unit;
    c.right = this.x + (this.width - mx) * this.unit;
    c.top = this.y + my * this.unit;
    c.bottom = this.y - (this.height - my) * this.unit;
    c.updateProjectionMatrix();
    c.updateMatrixWorld();
    c.matrixWorldInverse.getInverse(c.matrixWorld);
  }
  toScreen(x, y) {
    const [mx, my] = this.middle();
    return [mx + (x - this.x) / this.unit, my - (y - this.y) / this.unit];
  }
  toPicture(sx, sy) {
    const [mx, my] = this.middle();
    return [this.x + (sx - mx) * this.unit, this.y - (sy - my) * this.unit];
  }
  project([x, y]) {
    return [...this.toScreen(x, y), 1];
  }
  drag(dx, dy) {
    this.pan(dx, dy);
  }
  pan(dx, dy) {
    this.x -= dx * this.unit;
    this.y += dy * this.unit;
    this.update();
  }
  zoom(factor, sx, sy) {
    const [mx, my] = sx === undefined ? this.middle() : [sx, sy];
    const [x, y] = this.toPicture(mx, my);
    this.unit = Math.max(this.whole * 1e-6, Math.min(this.whole * 8, this.unit / factor));
    const [nx, ny] = this.toPicture(mx, my);
    this.x += x - nx;
    this.y += y - ny;
    this.update();
  }
}

// Handles mouse, pen and touch. Calls `changed` after every change, `picked(x, y, radius)` on a
// click.
function handle(canvas, rig, changed, picked) {
  const held = new Map();
  let travelled = 0;
  const local = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    held.set(event.pointerId, local(event));
    if (held.size === 1) travelled = 0;
    else travelled = Infinity;
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = held.get(event.pointerId);
    if (before === undefined) return;
    const now = local(event);
    const dx = now[0] - before[0], dy = now[1] - before[1];
    travelled += Math.abs(dx) + Math.abs(dy);
    if (held.size === 1) {
      if (travelled < 4) return;  // still a click
      if (event.buttons & 2 || event.buttons & 4 || event.shiftKey) rig().pan(dx, dy);
      else rig().drag(dx, dy);
    } else if (held.size === 2) {
      const other = [...held].find(([id]) => id !== event.pointerId)[1];
      const was = Math.hypot(before[0] - other[0], before[1] - other[1]);
      const is = Math.hypot(now[0] - other[0], now[1] - other[1]);
      rig().pan(dx / 2, dy / 2);
      if (was > 10) rig().zoom(is / was, (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
    }
    held.set(event.pointerId, now);
    changed();
  });
  const release = (event) => {
    if (held.delete(event.pointerId) && event.type === "pointerup" && travelled < 4 && event.button === 0)
      picked(...local(event), event.pointerType === "touch" ? 24 : 14);
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    rig().zoom(Math.exp(-Math.max(-300, Math.min(300, event.deltaY * lines)) * 0.0018), ...local(event));
    changed();
  }, { passive: false });
}
