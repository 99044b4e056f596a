"use strict";
// The picture itself, drawn by three.js in a fixed order: dots inside, the hull's far side, then its
// near side over them. The near side is first laid into the depth buffer alone, which tells far
// edges and vertices (drawn faintly) from near ones whether or not the surface is shown.

const dotShader = {
  vertex: `uniform float size, near, far;
varying float fade;
void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * seen;
  gl_PointSize = size;
  fade = clamp((-seen.z - near) / (far - near), 0.0, 1.0);
}`,
  fragment: `uniform vec3 colour, paper;
uniform float alpha, haze;
varying float fade;
void main() {
  vec2 from = 2.0 * gl_PointCoord - 1.0;
  if (dot(from, from) > 1.0) discard;
  gl_FragColor = vec4(mix(colour, paper, haze * fade), alpha);
}`,
};

// Smoothing doubles the time of a picture where the processor draws it, and is not seen where
// pixels are small.
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
  constructor(canvas, flat) {
    this.flat = flat;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: smoothingPays() });
    this.scene = new THREE.Scene();
    this.light = new THREE.DirectionalLight(0xffffff, 0.55);
    this.scene.add(this.light, new THREE.AmbientLight(0xffffff, 0.55));
    this.parts = {};
    this.make();
  }

  make() {
    const dots = (order, settings) => {
      const uniforms = { size: 1, near: 0, far: 1, alpha: 1, haze: this.flat ? 0 : 0.6 };
      for (const name in uniforms) uniforms[name] = { value: uniforms[name] };
      uniforms.colour = { value: new THREE.Color() };
      uniforms.paper = { value: new THREE.Color() };
      const material = new THREE.ShaderMaterial({
        uniforms, vertexShader: dotShader.vertex, fragmentShader: dotShader.fragment, transparent: true, ...settings,
      });
      return this.part(new THREE.Points(new THREE.BufferGeometry(), material), order);
    };
    const surface = (order, settings, plain = this.flat) => {
      const kind = plain ? THREE.MeshBasicMaterial : THREE.MeshPhongMaterial;
      const lit = plain ? {} : { flatShading: true, shininess: 12, specular: 0x222222 };
      return this.part(new THREE.Mesh(new THREE.BufferGeometry(), new kind({ transparent: true, depthWrite: false, ...lit, ...settings })), order);
    };
    const lines = (order, settings) =>
      this.part(new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ transparent: true, depthWrite: false, ...settings })), order);
    this.parts = {
      box: lines(0, { opacity: 0.55 }),
      points: dots(1, {}),
      survivors: dots(2, {}),
      back: surface(3, { side: THREE.BackSide }),
      farEdges: lines(5, { depthFunc: THREE.GreaterDepth }),
      farVertices: dots(5, { depthFunc: THREE.GreaterDepth, depthWrite: false }),
      front: surface(6, { side: this.flat ? THREE.DoubleSide : THREE.FrontSide }),
      edges: lines(7, {}),
      vertices: dots(8, { depthWrite: false }),
    };
    this.parts.depth = surface(4, { side: THREE.DoubleSide, depthWrite: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2 }, true);
    this.parts.depth.material.colorWrite = false;
  }
  part(object, order) {
    object.renderOrder = order;
    object.frustumCulled = false;
    this.scene.add(object);
    return object;
  }

  // Shows a frame. All parts of the hull share one list of positions.
  load(frame, space) {
    const fill = (names, positions, index) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
      if (index) geometry.setIndex(new THREE.BufferAttribute(index, 1));
      const old = new Set(names.map((name) => this.parts[name].geometry));
      for (const name of names) this.parts[name].geometry = geometry;
      for (const geometry of old) geometry.dispose();
    };
    const { vertices, survivors, points } = frame;
    const hull = space.positions(frame, 0, vertices);
    fill(["vertices", "farVertices"], hull);
    fill(["edges", "farEdges"], hull, frame.edges);
    fill(["front", "back", "depth"], hull, frame.triangles);
    fill(["survivors"], space.positions(frame, vertices, survivors));
    fill(["points"], space.positions(frame, vertices + survivors, points));
    fill(["box"], boxEdges(space.extent));
    // Directions the hull has no thickness in have no near and no far side.
    this.solid = frame.affine_dimension === 3 && space.extent.every((e) => e > 0);
    this.style(frame);
  }

  // Few things are drawn large, many small and thin.
  style({ vertices, survivors, points, edges, affine_dimension }) {
    const ease = (count, few, many, large, small) => {
      const t = Math.min(1, Math.max(0, Math.log(Math.max(1, count) / few) / Math.log(many / few)));
      return large + (small - large) * t;
    };
    const p = this.parts;
    const dot = (part, size, alpha) => {
      part.userData.size = size;
      part.material.uniforms.alpha.value = alpha;
    };
    dot(p.points, ease(points, 100, 30000, 4, 1.6), ease(points, 1000, 100000, 0.9, 0.55));
    dot(p.survivors, ease(survivors, 50, 20000, 5.5, 2.2), ease(survivors, 1000, 50000, 1, 0.8));
    dot(p.vertices, ease(vertices, 30, 10000, 8, 2.4), 1);
    dot(p.farVertices, p.vertices.userData.size, this.solid ? ease(vertices, 300, 10000, 0.35, 0.1) : 1);
    const lines = edges.length / 2;
    p.edges.material.opacity = affine_dimension > 3 ? ease(lines, 100, 100000, 0.6, 0.03) : ease(lines, 1000, 40000, 0.9, 0.16);
    p.farEdges.material.opacity = this.solid ? ease(lines, 300, 30000, 0.3, 0.05) : p.edges.material.opacity;
    p.front.material.opacity = this.flat ? 0.18 : 0.28;
    p.back.material.opacity = 0.2;
  }

  colour(colours) {
    this.renderer.setClearColor(colours.paper, 1);
    const p = this.parts;
    for (const [name, colour] of [["points", "points"], ["survivors", "survivors"], ["vertices", "vertices"], ["farVertices", "vertices"]]) {
      p[name].material.uniforms.colour.value.set(colours[colour]);
      p[name].material.uniforms.paper.value.set(colours.paper);
    }
    for (const name of ["front", "back"]) p[name].material.color.set(colours.hull);
    for (const name of ["edges", "farEdges"]) p[name].material.color.set(colours.edges);
    p.box.material.color.set(colours.axes);
  }

  show(on) {
    const p = this.parts;
    p.points.visible = on.points;
    p.survivors.visible = on.survivors;
    p.vertices.visible = on.vertices;
    p.farVertices.visible = on.vertices && this.solid;
    p.edges.visible = on.edges;
    p.farEdges.visible = on.edges && this.solid;
    p.front.visible = on.faces;
    p.back.visible = on.faces && !this.flat;
    p.depth.visible = this.solid;
    p.box.visible = on.axes && !this.flat;
  }

  resize(width, height, ratio) {
    this.ratio = ratio;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
  }

  render(rig) {
    const camera = rig.camera;
    if (!this.flat) {
      // From above the eye's left shoulder.
      const e = camera.matrixWorld.elements;
      this.light.position.set(e[8] - 0.5 * e[0] + 0.7 * e[4], e[9] - 0.5 * e[1] + 0.7 * e[5], e[10] - 0.5 * e[2] + 0.7 * e[6]);
    }
    for (const name of ["points", "survivors", "vertices", "farVertices"]) {
      const { uniforms } = this.parts[name].material;
      uniforms.size.value = this.parts[name].userData.size * this.ratio;
      if (this.flat) continue;
      uniforms.near.value = rig.distance - rig.radius;
      uniforms.far.value = rig.distance + rig.radius;
    }
    this.renderer.render(this.scene, camera);
  }
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
