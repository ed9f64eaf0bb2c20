// The figures of a report as charts to zoom, pan, read, copy and save; print and readers without this script have the drawings.
"use strict";
const FONT = "13px Helvetica, Arial, sans-serif";
const minus = (words) => String(words).replaceAll("-", "−");
const unitOf = (label) => label.split(", ").pop();
const drawn = {};

for (const figure of document.querySelectorAll("figure[id]")) {
  const numbers = figure.querySelector("script");
  const tools = document.createElement("div");
  tools.className = "tools";
  const answer = document.createElement("span");
  answer.setAttribute("role", "status");
  if (numbers) {
    const { note, of, panels } = JSON.parse(numbers.textContent);
    drawn[figure.id] = of ? drawn[of] : panels.flatMap((panel) => panel.lines);
    const box = document.createElement("div");
    box.className = "live";
    figure.prepend(box);
    figure.classList.add("is-live");
    const charts = panels.map((panel) => chart(box, panel, of ? drawn[of] : panel.lines, figure.id));
    button(tools, "Reset zoom", () => charts.forEach(whole));
    button(tools, "Copy as CSV", () => { answer.textContent = `Copied ${copy(table(charts))} rows`; });
    answer.textContent = note;
    addEventListener("resize", () => charts.forEach((u) => u.setSize(u.fitted())));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => charts.forEach((u) => u.redraw()));
  }
  button(tools, "Save PNG", () => png(figure));
  button(tools, "Save SVG", () => save(`${figure.id}.svg`, new Blob([drawing(figure)], { type: "image/svg+xml" })));
  tools.append(answer);
  figure.querySelector("figcaption").before(tools);
}

// What scrolls sideways on a narrow screen can be reached by the keyboard.
function reach() {
  for (const part of document.querySelectorAll("table, figure")) {
    if (part.scrollWidth > part.clientWidth) part.tabIndex = 0;
    else part.removeAttribute("tabindex");
  }
}
reach();
addEventListener("resize", reach);

function button(into, words, act) {
  const b = document.createElement("button");
  b.type = "button";
  b.textContent = words;
  b.onclick = act;
  into.append(b);
}

// Times and values of a line: single precision, not a number where samples are missing.
function samples({ x0, dx, steps, y }) {
  const values = [...new Float32Array(Uint8Array.from(atob(y), (c) => c.charCodeAt(0)).buffer)];
  let at = 0;
  return [values.map((_, i) => x0 + dx * (at += steps ? steps[i] : Math.min(i, 1))), values.map((v) => (Number.isNaN(v) ? null : v))];
}

// The part of a line between two times.
function cut([x, y], from, to) {
  const is = x.map((at) => at >= from && at <= to);
  return [x.filter((_, i) => is[i]), y.filter((_, i) => is[i])];
}

// The digits that tell a value from its neighbours in single precision: those of curves.csv.
function digits(v) {
  return String(+v.toPrecision([6, 7, 8, 9].find((n) => n === 9 || Math.fround(+v.toPrecision(n)) === v)));
}

function chart(box, panel, lines, key) {
  const data = uPlot.join(lines.map((line) => cut(samples(line), panel.from - line.dx / 2, panel.to + line.dx / 2)));
  const x = unitOf(panel.x), unit = unitOf(panel.y);
  const colour = (line, least) => line.color + Math.round(255 * Math.max(line.opacity, least)).toString(16).padStart(2, "0");
  const series = lines.map((line) => ({
    label: line.label || panel.y.split(", ")[0], points: { show: false }, pxAlign: 0, width: 0.55 * line.stroke,
    stroke: colour(line, 0),
    dash: line.dash?.map((piece) => 0.55 * piece * devicePixelRatio),
    head: `${line.label || panel.y.split(", ")[0]}, ${unit}`,
    value: (u, v) => (v == null ? "" : minus(v.toPrecision(5))),
  }));
  // Lines may have times of their own: the cursor reads the point nearest to it.
  const nearest = (u, s, i) => {
    const values = u.data[s];
    for (let d = 0; d < 200; d++) {
      if (values[i - d] != null) return i - d;
      if (values[i + d] != null) return i + d;
    }
    return i;
  };
  const ink = () => getComputedStyle(document.body).color;
  const marks = (u) => {
    const { ctx, bbox } = u, ends = [];
    ctx.save();
    ctx.font = FONT.replace("13", 13 * devicePixelRatio);
    ctx.textAlign = "center";
    ctx.fillStyle = ctx.strokeStyle = ink();
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([5 * devicePixelRatio, 4 * devicePixelRatio]);
    for (const [at, label] of panel.marks) {
      const x = u.valToPos(at, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      // A word stands above the axes, clear of their numbers, in a row above a neighbour that it would touch.
      const half = ctx.measureText(label).width / 2 + 4;
      const middle = Math.max(Math.min(x, ctx.canvas.width - half), bbox.left + half);
      let row = ends.findIndex((end) => middle - half > end);
      if (row < 0) row = ends.length;
      ends[row] = middle + half;
      const foot = bbox.top - (6 + 16 * row) * devicePixelRatio;
      ctx.fillText(label, middle, foot);
      ctx.globalAlpha = 0.55;
      ctx.beginPath();
      ctx.moveTo(x, foot + 5 * devicePixelRatio);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      ctx.globalAlpha = 1;
    }
    ctx.restore();
  };
  const axis = (label, size) => ({
    label, size, stroke: ink, font: FONT, labelFont: FONT, labelSize: 22, grid: { stroke: "#6e747c47", width: 1 },
    ticks: { stroke: "#6e747c", size: 5, width: 1 }, border: { show: true, stroke: "#6e747c", width: 1 },
    values: (u, ticks) => ticks.map((v) => minus(+v.toPrecision(9))),
  });
  const above = 12 + 16 * Math.min(panel.marks.length, 2);
  // As high as the drawing that it stands for, and high enough for a phone.
  const fitted = () => ({ width: box.clientWidth, height: above + 54 + Math.max(180, box.clientWidth * panel.height / 1800) });
  const u = new uPlot({
    title: panel.title, ...fitted(), padding: [above, 26, 0, 0],
    series: [{ value: (u, v) => (v == null ? "" : `at ${minus(v.toFixed(3))} ${x}`), label: "\u200b" }, ...series],
    scales: { x: { time: false } }, axes: [axis(panel.x, 32), axis(panel.y, 56)],
    legend: { markers: { width: 2, stroke: (u, i) => colour(lines[i - 1], 0.6), dash: (u, i) => (series[i - 1].dash ? "dashed" : "solid") } },
    // Panels of the same times have one cursor and one zoom.
    cursor: { sync: { key: key + data[0][0], setSeries: false }, dataIdx: nearest, drag: { x: true, y: false } },
    hooks: { draw: [marks] },
  }, data, box);
  u.fitted = fitted;
  const root = u.root;
  root.chart = u;
  root.tabIndex = 0;
  root.setAttribute("role", "group");
  root.setAttribute("aria-label", `${panel.title}: plus and minus zoom, arrows pan, with Shift they move the cursor, 0 shows the whole`);
  // The wheel is the page's until the chart was clicked or Ctrl is held.
  u.over.addEventListener("wheel", (e) => {
    if (!e.ctrlKey && document.activeElement !== root) return;
    e.preventDefault();
    zoom(u, e.deltaY < 0 ? 0.8 : 1.25, u.posToVal(e.offsetX, "x"));
  }, { passive: false });
  u.over.addEventListener("mousedown", (e) => {
    root.focus({ preventScroll: true });
    if (!e.shiftKey && e.button !== 1) return;
    e.preventDefault();
    e.stopImmediatePropagation();
    const { min, max } = u.scales.x, from = e.clientX, each = (max - min) / u.over.clientWidth;
    const move = (m) => u.setScale("x", { min: min - (m.clientX - from) * each, max: max - (m.clientX - from) * each });
    const up = () => { removeEventListener("mousemove", move); removeEventListener("mouseup", up); };
    addEventListener("mousemove", move);
    addEventListener("mouseup", up);
  }, true);
  root.addEventListener("keydown", (e) => {
    const { min, max } = u.scales.x, step = (max - min) / 5;
    const beside = (by) => u.setCursor({ left: Math.max(0, u.cursor.left + by * u.over.clientWidth / 100), top: 5 });
    const to = e.shiftKey && e.key.startsWith("Arrow") ? () => beside(e.key === "ArrowLeft" ? -1 : 1)
      : { "+": () => zoom(u, 0.6), "-": () => zoom(u, 1 / 0.6), "0": () => whole(u),
      ArrowLeft: () => u.setScale("x", { min: min - step, max: max - step }),
      ArrowRight: () => u.setScale("x", { min: min + step, max: max + step }) }[e.key];
    if (to) { e.preventDefault(); to(); }
  });
  return u;
}

function zoom(u, by, at) {
  const { min, max } = u.scales.x;
  const centre = at ?? (min + max) / 2;
  u.setScale("x", { min: centre - (centre - min) * by, max: centre + (max - centre) * by });
}

function whole(u) {
  const x = u.data[0];
  u.setScale("x", { min: x[0], max: x[x.length - 1] });
}

// What the charts of a figure show now: a row for each time, a column for each name.
function table(charts) {
  const cell = (s) => (/[",\n]/.test(s) ? `"${s.replaceAll('"', '""')}"` : s);
  const heads = [...new Set(charts.flatMap((u) => u.series.slice(1).map((s) => s.head)))];
  const rows = new Map();
  for (const u of charts) {
    const { min, max } = u.scales.x;
    u.data[0].forEach((x, i) => {
      if (x < min || x > max) return;
      const row = rows.get(x) || rows.set(x, {}).get(x);
      u.series.slice(1).forEach((s, j) => { if (s.show && u.data[j + 1][i] != null) row[s.head] = digits(u.data[j + 1][i]); });
    });
  }
  const lines = [...rows].sort((a, b) => a[0] - b[0]).map(([x, row]) => [+x.toFixed(6), ...heads.map((head) => row[head] ?? "")].join(","));
  return [[charts[0].axes[0].label, ...heads].map(cell).join(","), ...lines];
}

// Puts the lines on the clipboard, and says how many stand below the head.
function copy(lines) {
  const area = document.createElement("textarea");
  area.value = lines.join("\n") + "\n";
  document.body.append(area);
  area.select();
  document.execCommand("copy");
  area.remove();
  return lines.length - 1;
}

function drawing(figure) {
  return new XMLSerializer().serializeToString(figure.querySelector("svg"));
}

function save(name, blob) {
  const a = document.createElement("a");
  a.href = URL.createObjectURL(blob);
  a.download = name;
  a.click();
  setTimeout(() => URL.revokeObjectURL(a.href), 1000);
}

// The drawing as wide as a page at 300 dots an inch.
function png(figure) {
  const image = new Image();
  image.onload = () => {
    const canvas = document.createElement("canvas");
    canvas.width = 2400;
    canvas.height = 2400 * image.height / image.width;
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => save(`${figure.id}.png`, blob));
  };
  image.src = `data:image/svg+xml,${encodeURIComponent(drawing(figure))}`;
}
