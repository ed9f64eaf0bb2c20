// The figures of a report as charts to zoom, pan and read; print and readers without this script have the drawings.
"use strict";
for (const figure of document.querySelectorAll("figure[data-live]")) {
  const panels = JSON.parse(document.getElementById(figure.dataset.live).textContent);
  const box = document.createElement("div");
  box.className = "live";
  figure.insertBefore(box, figure.firstChild);
  figure.classList.add("is-live");
  const charts = panels.map((panel) => chart(box, panel, figure.dataset.live));
  const tools = document.createElement("div");
  tools.className = "tools";
  button(tools, "Whole", () => charts.forEach(whole));
  button(tools, "Copy as CSV", () => copy(charts.map(table).join("\n")));
  box.append(tools);
  addEventListener("resize", () => charts.forEach((u) => u.setSize({ width: box.clientWidth, height: 260 })));
}

function button(into, words, act) {
  const b = document.createElement("button");
  b.type = "button";
  b.textContent = words;
  b.onclick = act;
  into.append(b);
}

function chart(box, panel, key) {
  const places = ({ x0, dx, x }) => { let at = 0; return x.map((step) => x0 + dx * (at += step)); };
  const data = uPlot.join(panel.lines.map((line) => [places(line), line.y]));
  const series = panel.lines.map((line) => ({
    label: line.label || panel.y, stroke: line.color, alpha: line.opacity, width: line.width,
    dash: line.dash || undefined, points: { show: false },
    value: (u, v) => (v == null ? "–" : v.toPrecision(5)),
  }));
  // Lines are thinned each for itself: the cursor reads the point nearest to it.
  const nearest = (u, s, i) => {
    const values = u.data[s];
    for (let d = 0; d < 200; d++) {
      if (values[i - d] != null) return i - d;
      if (values[i + d] != null) return i + d;
    }
    return i;
  };
  const marks = (u) => {
    const { ctx, bbox } = u;
    ctx.save();
    ctx.font = `${12 * devicePixelRatio}px sans-serif`;
    ctx.textAlign = "center";
    ctx.fillStyle = ctx.strokeStyle = "#6b7280";
    ctx.setLineDash([4, 4]);
    for (const [i, [at, label]] of panel.marks.entries()) {
      const x = u.valToPos(at, "x", true);
      if (x < bbox.left || x > bbox.left + bbox.width) continue;
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      // A word at the edge stays inside.
      const half = ctx.measureText(label).width / 2;
      const middle = Math.min(Math.max(x, bbox.left + half), bbox.left + bbox.width - half);
      ctx.fillText(label, middle, bbox.top + (10 + 14 * (i % 2)) * devicePixelRatio);
    }
    ctx.restore();
  };
  const ink = () => getComputedStyle(document.body).color;
  const axis = (label) => ({ label, stroke: ink, grid: { stroke: "#8883" }, ticks: { stroke: "#8886" } });
  const u = new uPlot({
    title: panel.title, width: box.clientWidth, height: 260, series: [{ label: panel.x }, ...series],
    scales: { x: { time: false } }, axes: [axis(panel.x), axis(panel.y)],
    cursor: { sync: { key, setSeries: false }, dataIdx: nearest, drag: { x: true, y: false } },
    hooks: { draw: [marks] },
  }, data, box);
  const root = u.root;
  root.chart = u;
  root.tabIndex = 0;
  root.setAttribute("role", "img");
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

// What a chart shows now, as CSV.
function table(u) {
  const cell = (s) => (/[",\n]/.test(s) ? `"${s.replaceAll('"', '""')}"` : s);
  const { min, max } = u.scales.x;
  const rows = [u.series.map((s) => cell(s.label)).join(",")];
  u.data[0].forEach((x, i) => {
    if (x >= min && x <= max) rows.push(u.data.map((column) => column[i] ?? "").join(","));
  });
  return rows.join("\n") + "\n";
}

function copy(text) {
  const area = document.createElement("textarea");
  area.value = text;
  document.body.append(area);
  area.select();
  document.execCommand("copy");
  area.remove();
}
