// Draws the results of `cullhull-bench`: bars for figures, lines for series, a table below each.
"use strict";
(() => {
  const report = JSON.parse(document.getElementById("report").textContent);
  const colours = ["var(--points)", "var(--survivors)", "var(--hull)", "var(--vertices)", "var(--axes)"];
  const svgNames = "http://www.w3.org/2000/svg";

  function add(parent, name, attributes = {}, text = "") {
    const node = parent instanceof SVGElement || name === "svg"
      ? document.createElementNS(svgNames, name) : document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    if (text !== "") node.textContent = text;
    parent.append(node);
    return node;
  }

  function amount(v, unit) {
    if (v === null || v === undefined) return "–";
    if (unit === "s") {
      if (v < 1e-3) return (v * 1e6).toPrecision(3) + " µs";
      if (v < 1) return (v * 1e3).toPrecision(3) + " ms";
      return v.toPrecision(3) + " s";
    }
    return (v !== 0 && v < 0.1 ? v.toPrecision(2) : v.toFixed(v < 10 ? 2 : 1)) + " " + unit;
  }

  function capital(text) {
    return text === "" || text.startsWith("cullhull") ? text : text[0].toUpperCase() + text.slice(1);
  }

  // Text of a tick; no more digits than needed.
  function tickText(v, unit) {
    if (v === 0) return "0";
    const [factor, name] = unit !== "s" ? [1, unit] : v < 1e-3 ? [1e6, "µs"] : v < 1 ? [1e3, "ms"] : [1, "s"];
    return `${Number((v * factor).toPrecision(3))} ${name}`;
  }

  // Breaks text into lines of at most `width` pixels, assuming letters half as wide as high.
  function inLines(parts, width) {
    const out = [];
    for (const part of parts) {
      const longer = out.length > 0 ? out[out.length - 1] + " · " + part : "";
      if (longer !== "" && longer.length * 6.7 <= width) out[out.length - 1] = longer;
      else out.push(part);
    }
    return out;
  }

  // Of sorted ticks, those at least `least` pixels apart.
  function apart(ticks, at, least) {
    let last = -Infinity;
    return ticks.filter((tick) => {
      if (Math.abs(at(tick) - last) < least) return false;
      last = at(tick);
      return true;
    });
  }

  function ratioOf(row) {
    return row.ratio ? (row.ratio_is_bound ? "> " : "") + row.ratio.toPrecision(3) + "×" : "";
  }

  function percent(share) {
    return share ? (100 * share).toFixed(0) + " %" : "";
  }

  function namesOf(figure) {
    const names = [];
    for (const row of figure.rows)
      for (const [name, value] of Object.entries(row.values))
        if (value !== null && !names.includes(name)) names.push(name);
    return names;
  }

  function legend(parent, names) {
    const box = add(parent, "div", {class: "legend"});
    names.forEach((name, i) => {
      const item = add(box, "span");
      add(item, "i", {style: "background:" + colours[i % colours.length]});
      item.append(capital(name));
    });
  }

  // Ticks of an axis: linear, or logarithmic if values span more than a factor of 30.
  function scaleOf(values, from, to) {
    const positive = values.filter((v) => v > 0);
    const high = Math.max(...positive, 1e-12), low = Math.min(...positive, high);
    if (high / low > 30) {
      const a = Math.floor(Math.log10(low) - 0.15), b = Math.ceil(Math.log10(high) + 1e-9), ticks = [];
      for (let e = a; e <= b; ++e) ticks.push(10 ** e);
      return {ticks, log: true,
              at: (v) => from + (to - from) * Math.max(0, Math.log10(Math.max(v, 10 ** a)) - a) / (b - a)};
    }
    const step = 10 ** Math.floor(Math.log10(high / 3));
    const nice = [1, 2, 5, 10].map((f) => f * step).find((s) => high / s <= 6);
    const top = Math.ceil(high / nice - 1e-9) * nice, ticks = [];
    for (let v = 0; v <= top * (1 + 1e-9); v += nice) ticks.push(v);
    return {ticks, log: false, at: (v) => from + (to - from) * v / top};
  }

  function bars(parent, figure, width) {
    const names = namesOf(figure), thick = 15, gap = 16, label = 16;
    const heads = figure.rows.map((row) => inLines([row.name, ratioOf(row), row.paper ? "paper: " + row.paper : "",
      row.bandwidth_share ? `culls at ${percent(row.bandwidth_share)} of read bandwidth` : "",
      row.slower ? "slower " + row.slower : ""].filter(Boolean), width - 24));
    // Rivals that did not run get no bar; a rival that was stopped gets one, with a label.
    const ran = figure.rows.map((row) => names.filter((name) => typeof row.values[name] === "number"));
    const height = heads.reduce((sum, lines, r) => sum + lines.length * label + 2 + ran[r].length * (thick + 2) + gap, 34);
    const svg = add(parent, "svg", {viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": figure.title});
    const all = figure.rows.flatMap((r) => Object.values(r.values)).filter((v) => v !== null);
    const left = 12, right = width - 92, scale = scaleOf(all, left, right);
    for (const tick of apart(scale.ticks, scale.at, 58)) {
      const x = scale.at(tick);
      add(svg, "line", {class: "grid", x1: x, x2: x, y1: 8, y2: height - 24});
      add(svg, "text", {class: "soft", x, y: height - 8, "text-anchor": x < left + 20 ? "start" : "middle"}, tickText(tick, figure.unit));
    }
    let y = 12;
    figure.rows.forEach((row, r) => {
      for (const line of heads[r]) {
        add(svg, "text", {x: left, y: y + 12, class: row.slower || !row.agrees ? "differs" : "name"}, line);
        y += label;
      }
      y += 2;
      for (const name of ran[r]) {
        const v = row.values[name];
        const end = Math.max(scale.at(v), left + 1);
        add(svg, "rect", {x: left, y, width: end - left, height: thick, fill: colours[names.indexOf(name) % colours.length], rx: 2});
        add(svg, "text", {x: end + 5, y: y + 12}, (row.unfinished.includes(name) ? "> " : "") + amount(v, figure.unit));
        y += thick + 2;
      }
      y += gap;
    });
    legend(parent, names);
  }

  // Rows named "set, frame N" are steps of the lines of that set; all others are steps of one set.
  function lines(parent, figure, width) {
    const height = 300, left = 62, right = width - 14, top = 14, bottom = height - 34;
    const sets = [], series = [];
    for (const row of figure.rows) {
      const split = row.name.match(/^(.*), frame \d+$/);
      const set = split ? split[1] : "";
      if (!sets.includes(set)) sets.push(set);
      for (const [name, value] of Object.entries(row.values)) {
        const title = set ? set + ": " + name : name;
        let one = series.find((s) => s.title === title);
        if (!one) series.push(one = {title, points: []});
        one.points.push({value, row});
      }
    }
    const svg = add(parent, "svg", {viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": figure.title});
    const scale = scaleOf(series.flatMap((s) => s.points.map((p) => p.value)).filter((v) => v !== null), bottom, top);
    for (const tick of scale.ticks) {
      const y = scale.at(tick);
      add(svg, "line", {class: "grid", x1: left, x2: right, y1: y, y2: y});
      add(svg, "text", {class: "soft", x: left - 6, y: y + 4, "text-anchor": "end"}, tickText(tick, figure.unit));
    }
    const most = Math.max(...series.map((s) => s.points.length), 2);
    const at = (i) => left + (right - left) * (i + 0.5) / most;
    const framed = sets.some((s) => s !== ""), every = framed ? 5 : 1;
    for (let i = 0; i < most; i += every) {
      const name = framed ? String(i) : (figure.rows[i] || {name: ""}).name.replace(/^.*?, |^.* (?=\d)/, "");
      add(svg, "text", {class: "soft", x: at(i), y: height - 12, "text-anchor": "middle"}, name);
    }
    if (framed) add(svg, "text", {class: "soft", x: left - 6, y: height - 12, "text-anchor": "end"}, "frame");
    series.forEach((s, k) => {
      const known = s.points.map((p, i) => [at(i), p.value]).filter((p) => p[1] !== null);
      const path = known.map((p) => p[0].toFixed(1) + "," + scale.at(p[1]).toFixed(1)).join(" ");
      add(svg, "polyline", {points: path, fill: "none", stroke: colours[k % colours.length], "stroke-width": 2});
      for (const p of known) add(svg, "circle", {cx: p[0], cy: scale.at(p[1]), r: 2.5, fill: colours[k % colours.length]});
    });
    legend(parent, series.map((s) => s.title));
  }

  function table(parent, figure) {
    const box = add(add(parent, "details"), "div", {class: "wide"});
    box.parentNode.prepend(Object.assign(document.createElement("summary"), {textContent: "Numbers"}));
    const names = namesOf(figure), grid = add(box, "table"), head = add(grid, "tr");
    for (const name of ["", ...names, "ratio", "the paper", "of read bandwidth ¹", "reads", "check"]) add(head, "th", {}, capital(name));
    for (const row of figure.rows) {
      const line = add(grid, "tr");
      add(line, "th", {}, row.name);
      for (const name of names) {
        const value = name in row.values ? row.values[name] : null;
        add(line, "td", {"data-value": JSON.stringify(value)},
            name in row.values ? (row.unfinished.includes(name) ? "> " : "") + amount(value, figure.unit) : "");
      }
      add(line, "td", {}, ratioOf(row));
      add(line, "td", {}, row.paper || "");
      add(line, "td", {}, percent(row.bandwidth_share));
      add(line, "td", {}, row.reads ? row.reads.toPrecision(3) + "×" : "");
      const told = (row.agrees ? "" : "differs: ") + row.check + (row.slower ? "; slower " + row.slower : "");
      add(line, "td", row.agrees && !row.slower ? {} : {class: "differs"}, told);
    }
  }

  function draw() {
    const root = document.getElementById("figures");
    const open = [...root.querySelectorAll("details")].map((d) => d.open);
    root.replaceChildren();
    const width = Math.max(320, Math.round(root.clientWidth));
    report.figures.forEach((figure, i) => {
      const section = add(root, "section", {id: figure.id});
      add(section, "h2", {}, figure.title);
      if (figure.note) add(section, "p", {class: "soft"}, figure.note);
      (figure.series ? lines : bars)(section, figure, width);
      table(section, figure);
      section.querySelector("details").open = Boolean(open[i]);
    });
    const page = document.documentElement.dataset;
    page.drawn = String(Number(page.drawn || 0) + 1);
  }

  document.getElementById("title").textContent = document.title;
  document.getElementById("about").textContent =
    `cullhull ${report.version}, ${report.date.replace("T", " ").replace("Z", " UTC")}, ` +
    `${report.threads || "all"} threads, sizes × ${report.scale}`;
  add(document.getElementById("command"), "code", {}, report.command);
  const machine = Object.entries(report.machine);
  for (const [threads, rate] of Object.entries(report.read_bytes_per_second))
    machine.push([`read bandwidth, ${threads} thread${threads === "1" ? "" : "s"}`, (rate / 1e9).toFixed(1) + " GB/s"]);
  for (const [key, value] of machine) {
    const line = add(document.getElementById("machine"), "tr");
    add(line, "th", {}, capital(key));
    add(line, "td", {}, value);
  }
  draw();
  // Unfolds all details for printing.
  const folded = () => [...document.querySelectorAll("details")];
  let before = [];
  addEventListener("beforeprint", () => {
    before = folded().map((d) => d.open);
    for (const d of folded()) d.open = true;
  });
  addEventListener("afterprint", () => folded().forEach((d, i) => (d.open = before[i])));
  let last = document.getElementById("figures").clientWidth;
  addEventListener("resize", () => {
    const now = document.getElementById("figures").clientWidth;
    if (now !== last) draw();
    last = now;
  });
})();
