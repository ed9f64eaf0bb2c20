// The keys of a cask file to a form that edits its text, and what is refused to words under their fields.

const byId = (id) => document.getElementById(id);

/** An element with its attributes and what it holds. */
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

/** Words of a refusal: what is wrong, and how to mend it. */
function told({ problem, mend }) {
  return [element("strong", {}, problem), ...(mend ? [element("br"), mend] : [])];
}

class Form {
  /** `changed(path, value)` takes a value in TOML, or null to leave the key out. */
  constructor(place, tables, changed) {
    Object.assign(this, { place, changed, values: {}, fields: new Map(), sources: [], drawnFor: null });
    this.tables = new Map(tables.map((table) => [table.table, table]));
  }

  /** Keys that must be there and are not, and those that `init` left to be filled in, as paths. */
  missing() {
    const paths = [];
    const look = (table, at, stated) => {
      for (const key of this.tables.get(table).keys.filter((key) => key.asked || key.name in stated)) {
        const isSpared = (at === "drop" && key.name === "height_m" && isStated(stated.impact_velocity_m_s))
          || (stated.end === "none" && key.name === "axis") || (!isOfMotion(stated) && key.name === "position_m");
        if (!isStated(stated[key.name]) && !isSpared) paths.push(`${at}.${key.name}`);
      }
    };
    look("cask", "cask", this.values.cask ?? {});
    look("drop", "drop", this.values.drop ?? {});
    this.channels().forEach((channel, i) => look("channel", `channel.${i}`, channel));
    return paths;
  }

  /** Sources of channels that the recording has not, however it is written where it has them. */
  strangers() {
    const plain = (source) => source.toLowerCase().replace(/^\/|\s*[[(].*$/g, "").replaceAll("/", ".");
    const known = new Set(this.sources.map(plain));
    const sources = this.channels().filter(({ file, source }) => !isStated(file) && typeof source === "string");
    return known.size ? sources.map(({ source }) => source).filter((source) => isStated(source) && !known.has(plain(source))) : [];
  }

  channels() {
    return this.values.channel ?? [];
  }

  /** The first field that is wrong or empty though it must not be. */
  firstAtFault() {
    const wrong = [...this.fields].find(([, { input }]) => input.getAttribute("aria-invalid") === "true");
    return wrong?.[0] ?? this.missing()[0] ?? null;
  }

  focus(path) {
    const field = this.fields.get(path);
    for (let at = field?.input.parentElement; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
    field?.input.focus();
    field?.input.scrollIntoView({ block: "center" });
  }

  /** Shows what the text states; a field that is being typed in keeps its own text. */
  show(values) {
    this.values = values;
    const shape = `${this.channels().length} ${this.sources.join("\n")}`;
    if (shape !== this.drawnFor) this.draw();
    this.drawnFor = shape;
    const missing = new Set(this.missing());
    const strange = this.strangers();
    this.channels().forEach(({ source }, i) => strange.includes(source) && missing.add(`channel.${i}.source`));
    for (const [path, field] of this.fields) {
      const value = path.split(".").reduce((at, part) => at?.[part], values);
      const text = field.input.tagName === "SELECT" && isStated(value) ? String(value) : shown(value);
      if (field.input.tagName === "SELECT" && ![...field.input.options].some((option) => option.value === text)) {
        field.input.append(element("option", { value: text }, text));
      }
      if (document.activeElement !== field.input && !field.isWrong) field.input.value = text;
      field.box.classList.toggle("missing", missing.has(path));
    }
    for (const [i, channel] of this.channels().entries()) {
      const name = isStated(channel.name) ? channel.name : `Channel ${i + 1}`;
      byId(`legend-${i}`).textContent = [name, shown(channel.source)].filter(Boolean).join(": ");
      byId(`remove-${i}`).setAttribute("aria-label", `Take ${name} out`);
    }
    const left = this.sources.filter((source) => !this.channels().some((channel) => channel.source === source));
    byId("left").textContent = left.length ? `Not among them: ${left.slice(0, 9).join(", ")}` : "";
  }

  /** Puts words under a field, or takes them away; whether there is such a field. */
  blame(path, words = null) {
    const field = this.fields.get(path);
    if (!field) return false;
    field.input.setAttribute("aria-invalid", words !== null);
    field.error.replaceChildren(...(words ?? []));
    if (words) for (let at = field.box; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
    return true;
  }

  /** Takes away what the engine refused; what a field itself cannot read stays. */
  forgive() {
    for (const [path, field] of this.fields) if (!field.isWrong) this.blame(path);
  }

  draw() {
    this.fields.clear();
    const open = [...this.place.querySelectorAll("details[open]")].map((details) => details.id);
    const channels = this.channels().map((_, i) => this.channel(i));
    const others = [...this.tables.values()].filter(({ table }) =>
      !(table in FIRST) && !["source", "where", "observation", "limit"].includes(table));
    const add = element("button", { type: "button" }, "Add a channel");
    add.onclick = () => this.changed("channel", "add");
    this.place.replaceChildren(
      element("datalist", { id: "sources" }, ...this.sources.map((value) => element("option", { value }))),
      element("div", { class: "pair" }, this.group("cask", "Cask", "cask"), this.group("drop", "Drop", "drop")),
      element("h3", {}, "Sensors"), ...channels, element("p", {}, add, " ", element("span", { id: "left" })),
      element("h3", {}, "What may be stated besides"), ...others.map((table) => this.folded(table)));
    for (const id of open) byId(id)?.setAttribute("open", "");
  }

  channel(i) {
    const box = this.group("channel", "", `channel.${i}`);
    box.id = `channel-${i}`;
    box.querySelector("legend").id = `legend-${i}`;
    const remove = element("button", { type: "button", id: `remove-${i}` }, "Take out");
    remove.onclick = () => this.changed(`channel.${i}`, null);
    box.append(remove);
    return box;
  }

  /** A table whose first keys are always seen. */
  group(table, title, at) {
    const { keys } = this.tables.get(table);
    const isFirst = (key) => FIRST[table].includes(key.name);
    const first = FIRST[table].map((name) => keys.find((key) => key.name === name));
    const more = element("div", { class: "fields" }, ...keys.filter((key) => !isFirst(key))
      .map((key) => this.field(table, key, `${at}.${key.name}`)));
    return element("fieldset", {}, element("legend", {}, title),
      element("div", { class: "fields" }, ...first.map((key) => this.field(table, key, `${at}.${key.name}`))),
      element("details", { id: `more-${at}` }, element("summary", {}, "More"), more));
  }

  folded({ table, remark, keys }) {
    const title = table.charAt(0).toUpperCase() + table.slice(1);
    const fields = keys.map((key) => this.field(table, key, `${table}.${key.name}`));
    return element("details", { id: `more-${table}` },
      element("summary", {}, title, element("span", { class: "soft" }, remark ? ` (${remark})` : "")),
      element("div", { class: "fields" }, ...fields));
  }

  field(table, key, path) {
    const id = `field-${path}`;
    const { label, unit } = named(table, key.name);
    const choices = choicesOf(key);
    const attributes = { id, "aria-describedby": `${id}-hint ${id}-error`, autocomplete: "off", spellcheck: "false",
      inputmode: key.takes === "number" ? "decimal" : null, list: key.name === "source" ? "sources" : null };
    const none = key.asked ? "choose" : `default: ${choices?.[key.default.replace(/[`"]/g, "")]}`;
    const input = choices
      ? element("select", { id, "aria-describedby": attributes["aria-describedby"] },
        element("option", { value: "" }, none),
        ...Object.entries(choices).map(([value, words]) => element("option", { value }, words)))
      : element("input", { type: "text", ...attributes });
    const error = element("p", { class: "error", id: `${id}-error` });
    const said = choices && (key.asked || key.takes === "number") ? "" : hint(key);
    const box = element("div", { class: "field" },
      element("label", { for: id }, label, unit ? element("span", { class: "soft" }, ` in ${unit}`) : null),
      input, error, element("p", { class: "hint", id: `${id}-hint` }, said));
    const field = { input, error, box, isWrong: false };
    const taken = (isDone) => {
      try {
        const value = literal(key, input.value);
        field.isWrong = false;
        this.blame(path);
        this.changed(path, value);
      } catch (words) {
        field.isWrong = true;
        if (isDone) this.blame(path, [words.message]);
      }
    };
    if (!choices) input.addEventListener("input", () => taken(false));
    input.addEventListener("change", () => taken(true));
    this.fields.set(path, field);
    return box;
  }
}
