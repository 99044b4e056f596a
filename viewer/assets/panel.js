"use strict";
// The text beside the picture: figures, what is drawn, the picked point.

const grouped = new Intl.NumberFormat("en-GB");

function element(tag, attributes, ...children) {
  const node = document.createElement(tag);
  for (const name in attributes) node.setAttribute(name, attributes[name]);
  node.append(...children);
  return node;
}

// Whether a filter left some of the points, so that the others are told apart.
function wasFiltered(frame) {
  return Boolean(frame.report.cull) && frame.report.cull.method !== "none";
}

// Converts {"cull": {"method": ...}} to [["cull.method", ...], ...].
function flattened(report, prefix = "") {
  return Object.entries(report).flatMap(([key, value]) =>
    value !== null && typeof value === "object" && !Array.isArray(value)
      ? flattened(value, prefix + key + ".")
      : [[prefix + key, value]]);
}

function measureNames(k) {
  if (k <= 2) return { length: "Length", perimeter: "Perimeter", area: "Area" };
  if (k === 3) return { volume: "Volume", area: "Surface area" };
  return { volume: `Volume (${k}D)`, area: `Boundary (${k - 1}D)` };
}

const figureNames = {
  "points.count": "Points", "points.dimension": "Dimension", "points.scalar": "Scalar type",
  affine_dimension: "Affine dimension", vertex_count: "Vertices", facet_count: "Facets",
  simplex_count: "Simplices", centroid: "Centroid", "cull.method": "Filter", "cull.survivors": "Survivors",
  "cull.seconds": "Filtering", "cull.reason": "Why this filter", "hull.engine": "Engine", "hull.seconds": "Hull", read_seconds: "Reading",
  compute_seconds: "Computing", compute_seconds_all: "Each run", peak_bytes: "Peak memory", certified: "Certified",
  threads: "Threads", backend: "Backend", version: "cullhull",
  "track.method": "Tracking", "track.scan_survivors": "Left by the scan", "track.scan_seconds": "Scanning",
  "track.vertices_came": "Vertices that came", "track.vertices_went": "Vertices that went",
  skipped: "Points with NaN, skipped", "placement.numbers": "Coordinates", "placement.grid": "Grid of the coordinates",
  "placement.scale": "Scale of the file", "placement.offset": "Offset of the file", "placement.unit": "Unit", "placement.extent": "Extent",
  "track.facets_came": "Facets that came", "track.facets_went": "Facets that went",
};
const resultFigures = new Set(["points.count", "skipped", "points.dimension", "points.scalar", "affine_dimension", "vertex_count", "facet_count", "simplex_count", "length", "perimeter", "area", "volume", "centroid", "cull.survivors",
  "track.vertices_came", "track.vertices_went", "track.facets_came", "track.facets_went"]);

// At most six digits, or all before the point and one behind it; groups of three before the point.
function numberText(value) {
  const size = Math.abs(value);
  const short = Number(size.toPrecision(6));
  if (short >= 1e12 || (short < 1e-4 && short > 0)) return value.toExponential(Math.min(5, digitsOf(value) - 1)).replace("e+", "e").replaceAll("-", "−");
  const [whole, rest] = String(short >= 1e5 ? Number(size.toFixed(1)) : short).split(".");
  return (value < 0 ? "−" : "") + whole.replace(/\B(?=(\d{3})+$)/g, ",") + (rest ? "." + rest : "");
}
function digitsOf(value) {
  return value.toExponential().replace(/e.*|[-.]/g, "").length;
}
// As many digits as identify the double.
function wholeText(value) {
  return Array.isArray(value) ? value.map(wholeText).join(", ") : String(value);
}
// A table cell. If its text has fewer digits than the number, hovering (or a tap) shows all.
function numberCell(value, attributes = {}, lines = [numberText(value)]) {
  const whole = wholeText(value);
  const shown = lines.join(", ").replaceAll(",", "").replaceAll("−", "-");
  const cell = element("td", { class: "number", ...attributes }, ...(lines.length > 1 ? lines.map((l) => element("div", {}, l)) : lines));
  if (shown === whole.replaceAll(",", "")) return cell;
  cell.title = whole;
  const short = [...cell.childNodes];
  cell.addEventListener("click", () => {
    if (cell.dataset.whole) cell.replaceChildren(...short);
    else cell.replaceChildren(...[value].flat().map((v) => element("div", {}, String(v))));
    cell.dataset.whole = cell.dataset.whole ? "" : "yes";
  });
  return cell;
}

const placedNumbers = { grid: "exact on the grid", rounded: "rounded to doubles", file: "stored numbers, without scale and offset" };

function figureText(key, value) {
  if (key === "placement.numbers") return placedNumbers[value] || value;
  if (key === "placement.extent") return value.map(([low, high]) => `${numberText(low)} to ${numberText(high)}`).join("; ");
  if (value === null) return key === "certified" ? "not certified (use --certify)" : "not computed";
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (Array.isArray(value)) return value.map((v) => figureText(key, v)).join(", ");
  if (typeof value === "string") return value.replace("inf", "beyond the doubles");
  if (key.endsWith("seconds") || key.endsWith("seconds_all"))
    return value < 1 ? `${Number((value * 1e3).toPrecision(3))} ms` : `${Number(value.toPrecision(3))} s`;
  if (key.endsWith("_bytes")) return `${(value / 1e6).toFixed(1)} MB`;
  return numberText(value);
}

// Shows the names and texts of a result that is no hull.
function showRows(rows) {
  document.getElementById("result-name").textContent = "Result";
  document.querySelector("#result tbody").replaceChildren(...rows.map(([name, text]) =>
    element("tr", {}, element("th", { scope: "row" }, name), element("td", { class: "number" }, text))));
  document.getElementById("run-part").hidden = true;
}

// Shows every figure of the report; data-value holds the exact value.
function showFigures(report) {
  if (report.rows) return showRows(report.rows);
  const names = { ...figureNames, ...measureNames(report.affine_dimension) };
  const rows = { result: [], run: [] };
  for (const [key, value] of flattened(report)) {
    if (Array.isArray(value) && value.length === 0) continue;
    if (value === null && key.startsWith("placement.")) continue;  // the file does not say
    if (key === "cull.survivors" && report.cull.method === "none") continue;  // nothing was filtered
    if (key === "schema" || key === "kind") continue;  // about the report, not the hull
    const number = typeof value === "number" || key === "centroid";
    const lines = key === "centroid" ? value.map((v) => figureText(key, v)) : [figureText(key, value)];
    const about = { "data-key": key, "data-value": JSON.stringify(value) };
    const cell = number ? numberCell(value, about, lines) : element("td", about, ...lines);
    rows[resultFigures.has(key) ? "result" : "run"].push(element("tr", {}, element("th", { scope: "row" }, names[key] || key), cell));
  }
  for (const id in rows) document.querySelector(`#${id} tbody`).replaceChildren(...rows[id]);
  document.getElementById("run-part").hidden = rows.run.length < 2;  // only the version
}

function plural(count, one, many) {
  return `${grouped.format(count)} ${count === 1 ? one : many || one + "s"}`;
}

function summaryOf(scene, frame) {
  const r = frame.report;
  if (r.rows) return "";
  const count = plural(r.points.count, "point");
  if (r.points.count === 0) return "No points.";
  let text = `${count} in ${r.points.dimension}D. Hull: ${plural(r.vertex_count, "vertex", "vertices")}, ${plural(r.facet_count, "facet")}.`;
  if (frame.affine_dimension < scene.dimension)
    text += ["They are all equal.", "They lie on a line.", "They lie in a plane."].map((s) => " " + s)[frame.affine_dimension]
      || ` They span dimension ${frame.affine_dimension} only.`;
  return text;
}

function notesOf(scene, frame) {
  if (frame.notes) return frame.notes;
  const part = (drawn, all, one, many) =>
    drawn === all ? `all ${plural(all, one, many)}` : `${grouped.format(drawn)} of ${plural(all, one, many)}, a fair sample`;
  const notes = [], r = frame.report;
  const list = [];
  if (!frame.simplified) list.push(part(frame.vertices, frame.all_vertices, "vertex", "vertices"));
  if (frame.all_survivors > 0) list.push(part(frame.survivors, frame.all_survivors, wasFiltered(frame) ? "other survivor" : "other point"));
  if (frame.all_points > 0) list.push(part(frame.points, frame.all_points, "dropped point"));
  if (frame.simplified)
    notes.push(`The hull is too large for this page. Drawn is the hull of ${grouped.format(frame.vertices)} of its ${grouped.format(frame.all_vertices)} vertices, a fair sample.`);
  if (list.length > 0) notes.push(list.join("; ") + ".");
  if (frame.edges_sampled || (frame.affine_dimension > 3 && frame.vertices < frame.all_vertices))
    notes.push(`Of the edges ${grouped.format(frame.edges.length / 2)} are drawn, a fair sample.`);
  if (!frame.has_points && scene.dimension > 0 && frame.all_vertices > 0)
    notes.push("This page was made from a hull alone, without its points.");
  if (scene.axes < scene.dimension)
    notes.push(`Only the first ${scene.axes} of ${grouped.format(scene.dimension)} coordinates are in this page.`);
  if (scene.frame_count > scene.frames.length)
    notes.push(`${scene.frames.length} of ${grouped.format(scene.frame_count)} frames are in this page.`);
  if (frame.cells) {
    const cells = plural(frame.cell_corners ? frame.cells.length / frame.cell_corners : 0, frame.outline ? "cell" : "Delaunay cell") + (frame.outline ? " in the outline (alpha shape)" : "");
    const points = frame.cell_points === r.points.count ? "all points" : `${plural(frame.cell_points, "point")}, a fair sample`;
    notes.push(`${cells} of ${points}${frame.cell_corners === 4 ? ", seen where the clip plane cuts them" : ""}.`);
  }
  if (frame.affine_dimension > 3)
    notes.push("Seen is the shadow of the hull on the axes chosen: the outline of all its vertices, projected.");
  return notes;
}

function showNotes(scene, frame) {
  const notes = notesOf(scene, frame).map((s) => s[0].toUpperCase() + s.slice(1));
  document.getElementById("notes").replaceChildren(...notes.map((s) => element("p", {}, s)));
  document.getElementById("summary").textContent = summaryOf(scene, frame);
}

function rowKind(frame, row) {
  if (frame.point_name) return row < frame.vertices ? frame.vertex_name : frame.point_name;
  return row < frame.vertices ? "Vertex" : row < frame.vertices + frame.survivors ? (wasFiltered(frame) ? "Survivor" : "Point") : "Dropped point";
}

function tableOf(rows) {
  const lines = rows.map(([name, cell]) => element("tr", {}, element("th", { scope: "row" }, name), cell));
  return element("div", { class: rows.length > 8 ? "many" : "" }, element("table", {}, element("tbody", {}, ...lines)));
}

function showNothingPicked(facets, diagram) {
  if (diagram) return document.getElementById("picked").replaceChildren(element("span", { class: "soft" }, "Click a cell to read its site."));
  document.getElementById("picked").replaceChildren(element("span", { class: "soft" },
    `Click a vertex${facets ? " or a facet" : ""} to read it; with faces off, any point.`));
}
function showPickedRow(scene, frame, row) {
  const rows = [];
  for (let axis = 0; axis < scene.axes; ++axis)
    rows.push([axisName(axis, scene.dimension), element("td", { class: "number" }, String(frame.coordinates[row * scene.axes + axis]))]);
  if (frame.measures && row >= frame.vertices)  // of a diagram: the cell of the site
    rows.push([scene.dimension === 2 ? "Area of the cell" : "Volume of the cell", numberCell(frame.measures[frame.ids[row]])]);
  document.getElementById("picked").replaceChildren(element("strong", {}, `${rowKind(frame, row)} ${frame.ids[row]}`), tableOf(rows));
}
// `facet`: a result of facetFigures (tools.js).
function showPickedFacet(scene, facet) {
  const rows = [
    ["Corners", element("td", {}, facet.corners.slice(0, 24).join(", ") + (facet.corners.length > 24 ? ", …" : ""))],
    ["Area", numberCell(facet.area)],
    ...facet.normal.map((v, i) => ["Normal " + axisName(i, scene.dimension), numberCell(v)]),
    ["Offset", numberCell(facet.offset)],
  ];
  document.getElementById("picked").replaceChildren(element("strong", {}, `Facet ${facet.id}`), tableOf(rows));
}
