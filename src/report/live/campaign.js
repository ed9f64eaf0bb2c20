// The table of a campaign, to be sorted by any column, filtered by words, and two of its drops compared.
"use strict";
const number = (text) => {
  const found = /[−-]?\d+(\.\d+)?(e[−-]?\d+)?/.exec(text);
  return found ? Number(found[0].replaceAll("−", "-")) : null;
};
for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0], rows = [...body.rows];
  const drops = JSON.parse(document.getElementById("data").textContent);
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const b = document.createElement("button");
    b.type = "button";
    b.append(...head.childNodes);
    head.append(b);
    head.setAttribute("aria-sort", "none");
    const isOfNumbers = rows.every((row) => /^[−-]?\d*\.?\d*$/.test(row.cells[column].textContent));
    const isNumber = isOfNumbers || head.classList.contains("n");
    b.onclick = () => {
      const down = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      for (const other of table.tHead.rows[0].cells) if (other.hasAttribute("aria-sort")) other.setAttribute("aria-sort", "none");
      head.setAttribute("aria-sort", down > 0 ? "ascending" : "descending");
      const key = (row) => { const text = row.cells[column].textContent; return isNumber ? number(text) : text.toLowerCase(); };
      const order = (a, b) => {
        const [x, y] = [key(a), key(b)];
        // Rows without a number come last either way.
        if (x === null || y === null) return (x === null) - (y === null);
        return down * (isNumber ? x - y : x.localeCompare(y, undefined, { numeric: true }));
      };
      body.append(...[...rows].sort(order));
    };
  });
  body.onclick = (event) => {
    const link = event.target.closest("tr").querySelector("a");
    if (link && !event.target.closest("a, input") && getSelection().isCollapsed) link.click();
  };
  const bar = document.createElement("div");
  bar.className = "filter";
  const label = document.createElement("label");
  const input = document.createElement("input");
  input.type = "search";
  label.append("Only rows with ", input);
  const count = document.createElement("span");
  const tell = () => { count.textContent = `${rows.filter((row) => !row.hidden).length} of ${rows.length}`; };
  const choices = [];
  input.oninput = () => {
    const words = input.value.toLowerCase().split(/\s+/);
    const isShown = (row) => words.every((word) => row.textContent.toLowerCase().includes(word))
      && choices.every(([column, chosen]) => !chosen.selectedIndex || row.cells[column].textContent === chosen.value);
    for (const row of rows) row.hidden = !isShown(row);
    tell();
  };
  const hint = document.createElement("span");
  hint.className = "soft";
  const HINT = "Tick two drops to compare their numbers and curves.";
  hint.textContent = HINT;
  bar.append(label);
  // A choice for each column of words or of the manifest whose few values recur.
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const cells = rows.map((row) => row.cells[column]), values = [...new Set(cells.map((cell) => cell.textContent))];
    if (!cells[0].matches(".u, .tag") || values.length < 2 || values.length > 20 || head.textContent === "recording") return;
    const name = document.createElement("label"), chosen = document.createElement("select");
    values.sort((a, b) => a.localeCompare(b, undefined, { numeric: true }));
    chosen.append(new Option("all", ""), ...values.map((value) => new Option(value || "(empty)", value)));
    chosen.oninput = input.oninput;
    choices.push([column, chosen]);
    name.append(`${head.textContent} `, chosen);
    bar.append(name);
  });
  bar.append(count, hint);
  table.before(bar);
  tell();

  const place = document.createElement("section");
  place.className = "compared";
  table.before(place);
  let picked = [];
  rows.forEach((row, i) => {
    if (!drops[i]?.numbers.length) return;
    const box = document.createElement("input"), cell = row.cells[0], mark = document.createElement("span");
    const name = (cell.querySelector("a") || cell).textContent;
    box.type = "checkbox";
    box.setAttribute("aria-label", `compare ${name}`);
    box.onchange = () => {
      picked = picked.filter((other) => other.box !== box);
      if (box.checked) picked.push({ box, name, ...drops[i] });
      while (picked.length > 2) picked.shift().box.checked = false;
      hint.textContent = picked.length === 1 ? `Tick a second drop to compare it with ${picked[0].name}.` : HINT;
      place.replaceChildren(...(picked.length === 2 ? compared(...picked) : []));
      if (picked.length === 2) place.scrollIntoView({ block: "start" });
    };
    mark.className = "pick";
    mark.append(box);
    cell.prepend(mark);
  });
  const compared = (a, b) => {
    const title = document.createElement("h3"), back = document.createElement("button");
    title.textContent = `${a.name} and ${b.name}`;
    back.type = "button";
    back.className = "pick";
    back.textContent = "Back to the list";
    back.onclick = () => { b.box.scrollIntoView({ block: "center" }); b.box.focus({ preventScroll: true }); };
    return [title, back, pictures(a, b), numbers(a, b)];
  };
  const numbers = (a, b) => {
    const found = document.createElement("table");
    found.createCaption().textContent = "E_n: the difference over the root of the squares of both half-widths; within ±1 they agree.";
    const line = (cells, tag, into) => {
      const row = into.insertRow();
      cells.forEach((text, i) => {
        const cell = document.createElement(tag);
        cell.textContent = text;
        if (i) cell.className = "n";
        row.append(cell);
      });
      return row;
    };
    line(["quantity", a.name, b.name, "difference", "E_n"], "th", found.createTHead());
    const into = found.createTBody();
    const minus = (text) => (/^-[0.]+$/.test(text) ? text.slice(1) : text.replace("-", "−"));
    const digits = (v, u) => minus(v.toFixed(Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(u || 1))))));
    for (const [name, v, u, si] of a.numbers) {
      const [, w, uw] = b.numbers.find((q) => q[0] === name) || [];
      if (w === undefined || !(u || uw)) continue;
      const both = Math.hypot(u, uw), e = (w - v) / both, [factor, unit] = UNITS[si] || [1, si];
      const shown = (x, ux) => `${digits(x * factor, ux * factor)} ± ${digits(ux * factor, ux * factor)}`;
      line([unit ? `${name}, ${unit}` : name, shown(v, u), shown(w, uw), shown(w - v, both), minus(e.toFixed(2))], "td", into)
        .classList.toggle("chosen", Math.abs(e) > 1);
    }
    return found;
  };
  // Velocities of both drops over one another, an axis for each end.
  const pictures = (a, b) => {
    const box = document.createElement("div");
    box.className = "curves";
    const width = Math.max(300, table.parentNode.clientWidth > 900 ? 560 : Math.min(560, innerWidth - 34));
    for (const [title, key] of [["First end", "first_end_m_s"], ["Second end", "second_end_m_s"]]) {
      const lines = [a, b].map(({ curves }) => (curves?.[key] || []).map((v, i) => [curves.from_ms + i * curves.step_ms, v]));
      const all = lines.flat().filter((p) => p[1] !== null);
      if (all.length) box.append(plot(`${title}: velocity in m/s over ms from first contact`, lines, all, [a.name, b.name], width));
    }
    const note = document.createElement("p");
    note.className = "note";
    note.textContent = "The first transverse sensor on each end, unfiltered.";
    if (box.childElementCount) box.append(note);
    return box;
  };
}
const COLOURS = ["#0072b2", "#d55e00"];
// What a person reads for a unit of the result, and how much of it that is.
const UNITS = { 1: [1, ""], deg: [1, "°"], s: [1e3, "ms"], m: [1e3, "mm"], J: [1e-3, "kJ"], N: [1e-6, "MN"], "N s": [1e-3, "kN s"],
  "m/s^2": [1 / 9.80665, "g"] };

function plot(title, lines, all, names, width) {
  const height = 300, left = 44, right = 12, top = 46, bottom = 28;
  const svg = element("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${title}: ${names.join(" and ")}` });
  const scale = (values, from, to) => {
    const low = Math.min(...values), high = Math.max(...values), span = high - low || 1;
    const least = span / 7, power = 10 ** Math.floor(Math.log10(least)), step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= least);
    const ticks = [];
    for (let i = Math.ceil(low / step); i * step <= high; i++) ticks.push(i * step);
    return { ticks, at: (v) => from + (v - low) / span * (to - from) };
  };
  const x = scale(all.map((p) => p[0]), left, width - right), y = scale(all.map((p) => p[1]), height - bottom, top);
  const word = (text, at, more) => svg.append(element("text", { x: at[0], y: at[1], ...more }, text));
  word(title, [0, 14], { class: "title" });
  names.forEach((name, i) => word(name, [left + i * (width - left) / 2, 34], { fill: COLOURS[i] }));
  const grid = (from, to) => svg.append(element("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1] }));
  const shown = (v) => String(+v.toFixed(6)).replace("-", "−");
  for (const t of x.ticks) {
    grid([x.at(t), top], [x.at(t), height - bottom]);
    word(shown(t), [x.at(t), height - 10], { "text-anchor": "middle" });
  }
  for (const t of y.ticks) {
    grid([left, y.at(t)], [width - right, y.at(t)]);
    word(shown(t), [left - 6, y.at(t) + 4], { "text-anchor": "end" });
  }
  lines.forEach((line, i) => {
    let d = "", pen = "M";
    for (const [t, v] of line) {
      if (v === null) pen = "M";
      else [d, pen] = [`${d}${pen}${x.at(t).toFixed(1)} ${y.at(v).toFixed(1)}`, "L"];
    }
    svg.append(element("path", { d, stroke: COLOURS[i] }));
  });
  return svg;
}

function element(name, attributes, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  return made;
}
