"use strict";
// The picture, drawn by three.js in a fixed order: inner dots, the hull's far side, then its near
// side. The near side is first drawn to the depth buffer only. So far edges and vertices, drawn
// faintly, are distinguished from near ones even if the surface is hidden.

// A clip plane (a, b, c, w) hides all points with a x + b y + c z > w.
const clipped = {
  vertex: "varying vec3 inside;\n",
  fragment: "uniform vec4 clip;\nvarying vec3 inside;\nvoid cut() { if (dot(clip.xyz, inside) > clip.w) discard; }\n",
};

const shaders = {
  dot: {
    vertex: `uniform float size, near, far;
attribute vec3 tint;
varying float fade;
varying vec3 own;
void main() {
  inside = position;
  own = tint;
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * seen;
  gl_PointSize = size;
  fade = clamp((-seen.z - near) / (far - near), 0.0, 1.0);
}`,
    fragment: `uniform vec3 colour, paper;
uniform float alpha, haze, tinted;
varying float fade;
varying vec3 own;
void main() {
  cut();
  vec2 from = 2.0 * gl_PointCoord - 1.0;
  if (dot(from, from) > 1.0) discard;
  gl_FragColor = vec4(mix(mix(colour, own, tinted), paper, haze * fade), alpha);
}`,
  },
  line: {
    vertex: `void main() {
  inside = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`,
    fragment: `uniform vec3 colour;
uniform float alpha;
void main() {
  cut();
  gl_FragColor = vec4(colour, alpha);
}`,
  },
  // A cell of a triangulation, lighter or darker than its neighbours.
  cell: {
    vertex: `attribute float tone;
varying float own;
void main() {
  inside = position;
  own = tone;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`,
    fragment: `uniform vec3 lit, paper;
uniform float alpha;
varying float own;
void main() {
  cut();
  gl_FragColor = vec4(mix(lit, paper, 0.75 * own), alpha);
}`,
  },
  // Each facet has one normal, so that its shade distinguishes it from others. Like glass, the
  // surface is less transparent where the line of sight is nearly parallel to it.
  surface: {
    vertex: `varying vec3 seen;
void main() {
  inside = position;
  vec4 at = modelViewMatrix * vec4(position, 1.0);
  seen = at.xyz;
  gl_Position = projectionMatrix * at;
}`,
    fragment: `uniform vec3 lit, shade;
uniform float alpha, plain;
varying vec3 seen;
void main() {
  cut();
  if (plain > 0.5) {
    gl_FragColor = vec4(lit, alpha);
    return;
  }
  vec3 toEye = normalize(-seen);
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  float facing = dot(normal, toEye);
  if (facing < 0.0) { normal = -normal; facing = -facing; }
  float light = max(0.0, dot(normal, normalize(vec3(-0.55, 0.75, 0.6))));
  float rim = 1.0 - facing;
  vec3 colour = mix(shade, lit, 0.12 + 0.88 * light);
  gl_FragColor = vec4(colour, alpha + (1.0 - alpha) * 0.45 * rim * rim);
}`,
  },
};

// Antialiasing doubles the drawing time on machines without a GPU, and is not visible if pixels are
// small.
function smoothingPays() {
  if (window.devicePixelRatio >= 2) return false;
  const probe = document.createElement("canvas").getContext("webgl");
  if (!probe) return true;
  const named = probe.getExtension("WEBGL_debug_renderer_info");
  const name = named ? probe.getParameter(named.UNMASKED_RENDERER_WEBGL) : "";
  const lose = probe.getExtension("WEBGL_lose_context");
  if (lose) lose.loseContext();
  return !/swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

class Stage {
  constructor(canvas) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: smoothingPays() });
    this.scene = new THREE.Scene();
    this.clip = { value: new THREE.Vector4(0, 0, 0, 1) };
    this.glass = 0.5;
    this.parts = {};
    this.make();
  }

  material(kind, own, settings) {
    const uniforms = { clip: this.clip };
    for (const name in own) uniforms[name] = name === "clip" ? own.clip : { value: own[name] };
    return new THREE.ShaderMaterial({
      uniforms, vertexShader: clipped.vertex + shaders[kind].vertex, fragmentShader: clipped.fragment + shaders[kind].fragment,
      extensions: { derivatives: kind === "surface" }, transparent: true, ...settings,
    });
  }
  make() {
    const colour = () => new THREE.Color();
    const dots = (order, settings) => this.part(new THREE.Points(new THREE.BufferGeometry(), this.material("dot",
      { size: 1, near: 0, far: 1, alpha: 1, haze: 0, tinted: 0, colour: colour(), paper: colour() }, settings)), order);
    const lines = (order, settings = {}, own = {}) => this.part(new THREE.LineSegments(new THREE.BufferGeometry(),
      this.material("line", { colour: colour(), alpha: 1, ...own }, { depthWrite: false, ...settings })), order);
    const surface = (order, settings) => this.part(new THREE.Mesh(new THREE.BufferGeometry(),
      this.material("surface", { lit: colour(), shade: colour(), alpha: 1, plain: 0 }, { depthWrite: false, ...settings })), order);
    const whole = { value: new THREE.Vector4(0, 0, 0, 1) };
    // Cells in the clip plane are not clipped.
    const cells = (order, settings) => this.part(new THREE.Mesh(new THREE.BufferGeometry(),
      this.material("cell", { lit: colour(), paper: colour(), alpha: 1, clip: whole }, { side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1, ...settings })), order);
    this.parts = {
      box: lines(0, {}, { alpha: 0.55, clip: whole }),
      cells: cells(0.5, {}),
      cellEdges: lines(2.5, {}, { clip: whole }),
      points: dots(1, {}),
      survivors: dots(2, {}),
      back: surface(3, { side: THREE.BackSide }),
      depth: surface(4, { side: THREE.DoubleSide, depthWrite: true, colorWrite: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2 }),
      farEdges: lines(5, { depthFunc: THREE.GreaterDepth }),
      farVertices: dots(5, { depthFunc: THREE.GreaterDepth, depthWrite: false }),
      front: surface(6, { side: THREE.FrontSide }),
      facet: surface(6.5, { side: THREE.DoubleSide }),
      web: lines(7),
      edges: lines(7),
      vertices: dots(8, { depthWrite: false }),
    };
  }
  part(object, order) {
    object.renderOrder = order;
    object.frustumCulled = false;
    this.scene.add(object);
    return object;
  }

  // Shows a frame on the axes of `space`. `shape`: edges and triangles, as rows. All parts of the
  // hull share one list of positions.
  load(frame, space, shape, flat) {
    const { vertices, survivors, points } = frame;
    this.flat = flat;
    const hull = space.positions(frame, 0, vertices);
    this.hull = hull;
    this.shape = shape;
    this.fill(["vertices", "farVertices"], hull);
    this.fill(["edges", "farEdges"], hull, shape.edges);
    this.fill(["web"], hull, frame.affine_dimension > 3 ? frame.edges : new Uint32Array(0));
    this.fill(["front", "back", "depth"], hull, shape.triangles);
    this.fill(["survivors"], space.positions(frame, vertices, survivors));
    this.fill(["points"], space.positions(frame, vertices + survivors, points));
    this.fill(["box"], boxEdges(space.extent));
    this.mark(null);
    // If the hull has no thickness in some direction, it has no near and far side.
    this.solid = !flat && shape.triangles.length > 0 && frame.affine_dimension >= 3 && space.extent.every((e) => e > 0);
    this.parts.front.material.side = this.solid ? THREE.FrontSide : THREE.DoubleSide;
    for (const name of ["front", "back", "facet"]) this.parts[name].material.uniforms.plain.value = flat ? 1 : 0;
    this.style(frame);
  }
  fill(names, positions, index) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    if (index) geometry.setIndex(new THREE.BufferAttribute(index, 1));
    const old = new Set(names.map((name) => this.parts[name].geometry));
    for (const name of names) this.parts[name].geometry = geometry;
    for (const geometry of old) geometry.dispose();
  }
  // `shape`: a result of cellShape (cells.js), or null.
  loadCells(shape) {
    const none = new Float32Array(0);
    this.fill(["cells"], shape ? shape.places : none);
    this.parts.cells.geometry.setAttribute("tone", new THREE.BufferAttribute(shape ? shape.tones : none, 1));
    this.fill(["cellEdges"], shape ? shape.lines : none);
    this.parts.cells.material.depthWrite = !this.flat;
    this.cellCount = shape ? shape.lines.length / 18 : 0;
  }
  // Three bytes for each survivor, then for each discarded point; null: the parts' own colours.
  tint(bytes, survivors) {
    for (const [name, from, to] of [["survivors", 0, 3 * survivors], ["points", 3 * survivors, undefined]]) {
      const part = this.parts[name];
      part.material.uniforms.tinted.value = bytes ? 1 : 0;
      if (bytes) part.geometry.setAttribute("tint", new THREE.BufferAttribute(bytes.slice(from, to), 3, true));
    }
  }
  // Highlights one facet, given by its triangles.
  mark(triangles) {
    const index = [];
    for (const t of triangles || []) index.push(...this.shape.triangles.slice(3 * t, 3 * t + 3));
    this.fill(["facet"], this.hull, Uint32Array.from(index));
    this.parts.facet.visible = index.length > 0;
  }

  // Few items are drawn large, many small and thin. Sizes on the hull depend on the distance
  // between items there, so that dots do not hide a dense hull, and details grow when zooming in.
  style(frame) {
    const p = this.parts;
    const dot = (part, size, alpha) => {
      part.userData.size = size;
      part.material.uniforms.alpha.value = alpha;
    };
    dot(p.points, eased(frame.points, 100, 30000, 4, 2.2), eased(frame.points, 1000, 100000, 0.9, 0.7));
    dot(p.survivors, eased(frame.survivors, 50, 20000, 5.5, 2.4), eased(frame.survivors, 1000, 50000, 1, 0.85));
    // Distances between vertices, and between edges, in the picture's units.
    const extent = this.flat ? perimeter(this.hull, this.shape.edges) : Math.sqrt(surfaceArea(this.hull, this.shape.triangles));
    this.apart = this.flat ? extent / Math.max(1, frame.vertices) : extent / Math.sqrt(Math.max(1, frame.vertices));
    this.lines = frame.edges.length / 2;
  }
  styleFor(pixelsPerUnit) {
    const p = this.parts;
    const room = this.apart > 0 ? this.apart * pixelsPerUnit : 60;
    // Coloured dots stay more visible than the hull.
    const tinted = p.points.material.uniforms.tinted.value > 0;
    const size = Math.max(1.6, Math.min(tinted ? 4.5 : 8, this.flat ? 0.5 * room : 0.2 * room));
    const far = Math.max(0.1, Math.min(0.35, room / 60));
    for (const part of [p.vertices, p.farVertices]) part.userData.size = size;
    p.vertices.material.uniforms.alpha.value = 1;
    p.farVertices.material.uniforms.alpha.value = this.solid ? far : 1;
    p.edges.material.uniforms.alpha.value = this.flat ? 1 : Math.max(0.14, Math.min(tinted ? 0.55 : 0.95, room / 38));
    p.farEdges.material.uniforms.alpha.value = Math.max(0.05, Math.min(tinted ? 0.18 : 0.3, room / 110));
    p.web.material.uniforms.alpha.value = eased(this.lines, 100, 100000, 0.5, 0.03);
    p.front.material.uniforms.alpha.value = this.flat ? 0.16 : this.glass;
    p.back.material.uniforms.alpha.value = 0.75 * this.glass * (1 - this.glass) + 0.1;
    p.cellEdges.material.uniforms.alpha.value = eased(this.cellCount, 300, 30000, 0.9, 0.3);
    p.facet.material.uniforms.alpha.value = this.flat ? 0.5 : 0.8;
  }

  colour(colours) {
    this.renderer.setClearColor(colours.paper, 1);
    const set = (part, name, colour) => this.parts[part].material.uniforms[name].value.set(colours[colour]);
    for (const [name, colour] of [["points", "points"], ["survivors", "survivors"], ["vertices", "vertices"], ["farVertices", "vertices"]]) {
      set(name, "colour", colour);
      set(name, "paper", "paper");
    }
    for (const name of ["front", "back"]) {
      set(name, "lit", "lit");
      set(name, "shade", "shade");
    }
    set("facet", "lit", "picked");
    set("facet", "shade", "picked");
    for (const name of ["edges", "farEdges", "web"]) set(name, "colour", "edges");
    set("box", "colour", "axes");
    set("cells", "lit", "lit");
    set("cells", "paper", "paper");
    set("cellEdges", "colour", "edges");
  }

  show(on) {
    const p = this.parts;
    p.points.visible = on.points;
    p.survivors.visible = on.survivors;
    p.vertices.visible = on.vertices;
    p.farVertices.visible = on.vertices && this.solid;
    p.edges.visible = on.edges;
    p.farEdges.visible = on.edges && this.solid;
    p.web.visible = on.web;
    p.front.visible = on.faces;
    p.back.visible = on.faces && this.solid;
    p.depth.visible = this.solid;
    p.cells.visible = on.cells;
    p.cellEdges.visible = on.cells;
    p.box.visible = on.axes && !this.flat;
  }

  resize(width, height, ratio) {
    this.ratio = ratio;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
  }

  render(rig) {
    this.styleFor(rig.pixelsPerUnit());
    for (const name of ["points", "survivors", "vertices", "farVertices"]) {
      const { uniforms } = this.parts[name].material;
      uniforms.size.value = this.parts[name].userData.size * this.ratio;
      uniforms.haze.value = this.flat ? 0 : uniforms.tinted.value ? 0.25 : 0.6;
      if (this.flat) continue;
      uniforms.near.value = rig.distance - rig.radius;
      uniforms.far.value = rig.distance + rig.radius;
    }
    this.renderer.render(this.scene, rig.camera);
  }
}

// From `large` at `few` to `small` at `many`, linear in the logarithm.
function eased(count, few, many, large, small) {
  const t = Math.min(1, Math.max(0, Math.log(Math.max(1, count) / few) / Math.log(many / few)));
  return large + (small - large) * t;
}

function surfaceArea(positions, triangles) {
  let twice = 0;
  for (let i = 0; i < triangles.length; i += 3) twice += Math.hypot(...crossOf(positions, triangles, i));
  return twice / 2;
}
// The cross product of two edges of a triangle: its normal, with twice its area as length.
function crossOf(positions, triangles, i) {
  const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[i + k]);
  const u = [0, 1, 2].map((k) => positions[b + k] - positions[a + k]);
  const v = [0, 1, 2].map((k) => positions[c + k] - positions[a + k]);
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
}
function perimeter(positions, edges) {
  let sum = 0;
  for (let i = 0; i < edges.length; i += 2) {
    const a = 3 * edges[i], b = 3 * edges[i + 1];
    sum += Math.hypot(positions[a] - positions[b], positions[a + 1] - positions[b + 1]);
  }
  return sum;
}

function boxEdges([x, y, z]) {
  const out = [];
  for (const s of [-1, 1])
    for (const t of [-1, 1]) {
      out.push(-x, s * y, t * z, x, s * y, t * z);
      out.push(s * x, -y, t * z, s * x, y, t * z);
      out.push(s * x, t * y, -z, s * x, t * y, z);
    }
  return new Float32Array(out);
}
