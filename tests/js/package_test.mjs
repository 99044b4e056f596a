// package_test.mjs PACKAGE PROGRAMS: holds every function of the npm package against the native
// library (native.cpp), bit for bit; delaunator's conventions; errors; memory.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';
import { pathToFileURL } from 'node:url';

const [folder, programs] = process.argv.slice(2);
const { load, CullhullError } = await import(pathToFileURL(`${folder}/plane.js`));
const { Module } = await import(pathToFileURL(`${folder}/wasm.js`));
const plane = await load();
const space = await (await import(pathToFileURL(`${folder}/space.js`))).load();

let state = 1;
const random = () => (state = (Math.imul(state, 1103515245) + 12345) >>> 0) / 2 ** 32;
const make = (count, of) => Float64Array.from({ length: count }, (_, i) => of(i));
const rows = (count, of) => Float64Array.from(Array.from({ length: count }, (_, i) => of(i)).flat());

// In the manner of delaunator's issues: 13 has rings around one centre, 43 and 44 points on lines up
// to rounding, 61 is a tilted grid.
const ring = (n, r) => rows(n, i => [r * Math.cos(2 * Math.PI * i / n), r * Math.sin(2 * Math.PI * i / n)]);
const tilted = (x, y, a) => [x * Math.cos(a) - y * Math.sin(a), x * Math.sin(a) + y * Math.cos(a)];
const plane_sets = {
  0: [], 1: [3, 4], 2: [0, 1, 2, 3], 3: [0, 0, 0, 1, 1, 0],
  10: make(20, random), 1000: make(2000, random), 100000: make(200000, random),
  equal: make(40, () => 7), collinear: rows(50, i => [i * 3 % 50, i * 6 % 100]),
  grid: rows(1600, i => [i % 40, Math.floor(i / 40)]),
  large: make(200, i => (random() - 0.5) * 1e308), tiny: make(200, () => random() * 1e-308),
  mixed: rows(60, i => [random() * 10 ** (i % 3 * 300 - 300), random() * 10 ** (i % 7 * 40 - 120)]),
  issue13: Float64Array.from([4, 3, 2, 1].flatMap(r => [...ring(24, r)])),
  issue43: rows(40, i => [-537.7739674441619 + i * 42.24, -122.26130468750004 - i * 61.13065234375]),
  issue44: rows(300, i => i % 30 ? [8 + 3 * random(), 11828 + 40 * random()] : [17802.1 + i, 14771.8]),
  far: rows(200, i => [1e17 + i * 16, (i * 7919 % 200) * 2 ** -30]),
  issue61: rows(2500, i => tilted(i % 50, Math.floor(i / 50), 302.328 * Math.PI / 180)),
};
const space_sets = {
  0: [], 1: [1, 2, 3], 2: [0, 0, 0, 1, 1, 1], 3: make(9, random), 10: make(30, random),
  1000: make(3000, random), equal: make(30, () => 2), line: rows(20, i => [i, 2 * i, 3 * i]),
  flat: rows(100, i => [i % 10, Math.floor(i / 10), i % 10]),
  grid: rows(343, i => [i % 7, Math.floor(i / 7) % 7, Math.floor(i / 49)]),
  large: make(300, () => (random() - 0.5) * 1e308), tiny: make(300, () => random() * 1e-308),
};

function native(module, name, points, dimension, number = 0, flag = 0, ids = []) {
  const doubles = Float64Array.from(points);
  const input = Buffer.concat([Uint32Array.of(doubles.length / dimension, ids.length), doubles,
    Uint32Array.from(ids)].map(a => Buffer.from(a.buffer)));
  const { stdout, status } = spawnSync(`${programs}/js_native_${module}`,
    [name, dimension, number, +flag], { input, maxBuffer: 1 << 30 });
  if (status === 1) return String(stdout);
  assert.equal(status, 0);
  const parts = [];
  for (let at = 0; at < stdout.length;) {
    const size = stdout.readUInt32LE(at);
    parts.push(stdout.subarray(at + 4, at + 4 + size));
    at += 4 + size;
  }
  return parts;
}

let calls = 0;
function same(label, result, expected) {
  ++calls;
  Object.entries(result).forEach(([name, value], i) => {
    const part = ArrayBuffer.isView(value) ? value : null;
    if (part) assert.ok(Buffer.from(part.buffer).equals(expected[i]), `${label}: ${name}`);
  });
}

const numbers = (...values) => Float64Array.from(values);
for (const [label, points] of Object.entries(plane_sets)) {
  const n = points.length / 2;
  const { vertices, area, perimeter } = plane.hull(points);
  same(`hull ${label}`, [vertices, numbers(area, perimeter)], native('plane', 'hull', points, 2));
  const mesh = plane.delaunay(points);
  same(`delaunay ${label}`, mesh, native('plane', 'delaunay', points, 2));
  conventions(label, points, mesh);
  same(`voronoi ${label}`, plane.voronoi(points), native('plane', 'voronoi', points, 2));
  for (const options of [{ ratio: 0.3 }, { length: 0.5 }, {}]) {
    const c = plane.concaveHull(points, options);
    same(`concave ${label}`, [c.ring, numbers(c.area, c.perimeter)], native('plane', 'concave',
      points, 2, options.length ?? options.ratio ?? 0.1, options.length === undefined));
  }
  const outline = [...vertices].flatMap((v, i) => [v, vertices[(i + 1) % vertices.length]]);
  const chord = n > 6 ? [outline[0], outline[outline.length / 2 & ~1]] : [];
  for (const insideOnly of [false, true])
    same(`constrained ${label}`, plane.constrained(points, [...outline, ...chord], { insideOnly }),
      native('plane', 'constrained', points, 2, 0, insideOnly, [...outline, ...chord]));
}
for (const [label, points] of Object.entries(space_sets)) {
  const { vertices, simplices, volume, area, corners } = space.hull(points);
  same(`3D hull ${label}`, [vertices, simplices, numbers(volume, area), Uint32Array.of(corners)],
    native('space', 'hull', points, 3));
  const d = space.delaunay(points);
  same(`3D delaunay ${label}`, [d.cells, d.neighbours, Uint32Array.of(d.corners)],
    native('space', 'delaunay', points, 3));
}
for (const d of [1, 2, 4, 5, 7]) {
  const points = make(40 * d, random), h = space.hull(points, d);
  same(`${d}D`, [h.vertices, h.simplices], native('space', 'hull', points, d));
}

/** What delaunator promises of its arrays. */
function conventions(label, points, { triangles, halfedges, hull }) {
  const next = e => e % 3 === 2 ? e - 2 : e + 1;
  let border = 0;
  halfedges.forEach((o, e) => {
    if (o < 0) return ++border;
    assert.equal(halfedges[o], e, label);
    assert.equal(triangles[o], triangles[next(e)], label);
    assert.equal(triangles[e], triangles[next(o)], label);
  });
  if (triangles.length === 0) return;
  assert.equal(border, hull.length, label);
  assert.equal(triangles.length / 3, 2 * new Set(triangles).size - 2 - hull.length, label);
  const edges = new Set();
  halfedges.forEach((o, e) => { if (o < 0) edges.add(`${triangles[e]} ${triangles[next(e)]}`); });
  hull.forEach((v, i) => assert.ok(edges.has(`${v} ${hull[(i + 1) % hull.length]}`), label));
}
assert.deepEqual(Array.from(plane.delaunay([[5, 5], [7, 5], [7, 6]]).triangles), [0, 2, 1]);
assert.deepEqual(Array.from(plane.delaunay([[0, 0], [1, 0], [3, 0], [2, 0]]).hull), [0, 1, 3, 2]);
assert.deepEqual(plane.hull([[0, 0], [2, 0], [0, 1]]), plane.hull([0, 0, 2, 0, 0, 1]));
assert.deepEqual(plane.constrained([[0, 0], [1, 1], [0, 1], [1, 0]], [[1, 0]]).edges,
  Uint32Array.of(0, 1));

const fails = (code, line, call) => assert.throws(call,
  error => error instanceof CullhullError && error.code === code && line.test(error.message));
fails('not_finite', /^point 1, coordinate 0 is NaN/, () => plane.hull([0, 0, NaN, 1]));
fails('not_finite', /infinit/, () => space.delaunay([0, 0, Infinity]));
fails('invalid_argument', /^3 numbers/, () => plane.delaunay([1, 2, 3]));
fails('invalid_argument', /2 coordinates/, () => plane.delaunay([[1, 2], [1]]));
fails('invalid_argument', /array/, () => plane.delaunay(undefined));
fails('invalid_argument', /cross/, () => plane.constrained([0, 0, 1, 1, 0, 1, 1, 0], [0, 1, 2, 3]));
fails('invalid_argument', /./, () => plane.constrained([0, 0, 1, 1], [[0, 9]]));
fails('invalid_argument', /negative/, () => plane.concaveHull([0, 0, 1, 0, 0, 1], { length: -1 }));

fails('invalid_argument', /array/, () => plane.hull(new DataView(new ArrayBuffer(32))));
for (const dimension of [0, -1, 2.5, NaN, '3'])
  fails('invalid_argument', /coordinates/, () => space.hull([1, 2, 3, 4, 5], dimension));
for (const ids of [[0, -1], [0, 1.5], [0, NaN], [[0, 2 ** 32]], ['0', '1'], undefined, 7, new DataView(new ArrayBuffer(8))])
  fails('invalid_argument', /ids/, () => plane.constrained([0, 0, 1, 1, 0, 1], ids));
const sent = new Float64Array(6);
structuredClone(sent, { transfer: [sent.buffer] });
fails('invalid_argument', /detached/, () => plane.hull(sent));

fails('out_of_budget', /memory budget/, () => space.delaunay(make(20 * 3000, random), 20));

// Memory is used again, and a call that finds none is an error after which others run.
const some = plane_sets[100000], types = [Uint32Array, Int32Array, Uint32Array];
const full = await Module.load('plane.wasm'), left = full.wasm.malloc(4 << 20);
for (const size of [64 << 20, 1 << 20, 1 << 12]) while (full.wasm.malloc(size) !== 0);
fails('out_of_memory', /input/, () => full.call('cullhull_delaunay', [some, 100000], types));
full.wasm.free(left);
fails('out_of_memory', /call/, () => full.call('cullhull_delaunay', [some, 100000], types));
assert.equal(full.call('cullhull_delaunay', [some.slice(0, 6), 3], types)[0].length, 3);
// What the budget of 2 GiB does not hold, in the same instance as what it does.
const many = make(2e7, random), corners = plane.hull(many).vertices;
fails('out_of_budget', /memory budget/, () => plane.voronoi(many));
assert.deepEqual(plane.hull(many).vertices, corners);
assert.ok(plane.delaunay(many.subarray(0, 2e6)).triangles.length > 5.9e6);
assert.ok(space.hull(many.subarray(0, 3e6)).vertices.length > 100);
plane.voronoi(some);
const memory = process.memoryUsage().arrayBuffers;
for (let i = 0; i < 30; ++i) plane.voronoi(some);
global.gc?.();
assert.ok(process.memoryUsage().arrayBuffers - memory < 200e6);

for (const [module, called] of [[plane, 'hull delaunay constrained concaveHull voronoi'], [space, 'hull delaunay']])
  assert.equal(Object.keys(module).join(' '), called, 'a function has no row above');

const sizes = ['plane', 'space'].map(name => [`${name}.wasm`, `${name}.js`, 'wasm.js']
  .reduce((sum, file) => sum + gzipSync(readFileSync(`${folder}/${file}`), { level: 9 }).length, 0));
assert.ok(sizes[0] <= 400e3 && sizes[1] <= 1e6, `gzipped: ${sizes}`);
console.log(`${calls} results like the native library's; gzipped: plane ${sizes[0]}, space ${sizes[1]} bytes`);
