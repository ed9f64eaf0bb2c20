// The table of a campaign, to be sorted by any column, filtered by words, and two of its rows compared.
"use strict";
const number = (text) => {
  const found = /[−-]?\d+(\.\d+)?(e[−-]?\d+)?/.exec(text);
  return found ? Number(found[0].replaceAll("−", "-")) : null;
};
for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0], rows = [...body.rows];
  const quantities = JSON.parse(document.getElementById("data").textContent);
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const b = document.createElement("button");
    b.type = "button";
    b.append(...head.childNodes);
    head.append(b);
    head.setAttribute("aria-sort", "none");
    const isNumber = head.classList.contains("n");
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
  const bar = document.createElement("div");
  bar.className = "filter";
  const label = document.createElement("label");
  const input = document.createElement("input");
  input.type = "search";
  label.append("Only rows with ", input);
  const count = document.createElement("span");
  const tell = () => { count.textContent = `${rows.filter((row) => !row.hidden).length} of ${rows.length}`; };
  input.oninput = () => {
    const words = input.value.toLowerCase().split(/\s+/);
    for (const row of rows) row.hidden = !words.every((word) => row.textContent.toLowerCase().includes(word));
    tell();
  };
  const hint = document.createElement("span");
  hint.className = "soft";
  hint.textContent = "Mark two rows to compare them.";
  bar.append(label, count, hint);
  table.before(bar);
  tell();

  const place = document.createElement("div");
  table.before(place);
  let picked = [];
  const head = document.createElement("th");
  head.className = "pick";
  head.textContent = "compare";
  table.tHead.rows[0].append(head);
  rows.forEach((row, i) => {
    const cell = row.insertCell();
    cell.className = "pick";
    if (!quantities[i]?.length) return;
    const box = document.createElement("input");
    box.type = "checkbox";
    box.setAttribute("aria-label", `compare ${row.cells[0].textContent}`);
    box.onchange = () => {
      picked = picked.filter((other) => other.box !== box);
      if (box.checked) picked.push({ box, i, name: row.cells[0].textContent });
      while (picked.length > 2) picked.shift().box.checked = false;
      place.replaceChildren(...(picked.length === 2 ? [compared(...picked)] : []));
    };
    cell.append(box);
  });
  const compared = (a, b) => {
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
    };
    line(["quantity", a.name, b.name, "difference", "E_n"], "th", found.createTHead());
    const into = found.createTBody();
    const digits = (v, u) => v.toFixed(Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(u || 1)))));
    for (const [name, v, u, unit] of quantities[a.i]) {
      const other = quantities[b.i].find((q) => q[0] === name);
      if (!other || !(u || other[2])) continue;
      const both = Math.hypot(u, other[2]), shown = (x, w) => `${digits(x, w)} ± ${digits(w, w)}`;
      line([`${name.replaceAll("_", " ")}${unit === "1" ? "" : `, ${unit}`}`, shown(v, u), shown(other[1], other[2]),
        shown(other[1] - v, both), ((other[1] - v) / both).toFixed(2)], "td", into);
    }
    return found;
  };
}
