// A recording and a form to the report: what the person does, in its order.

const EMPTY = "[cask]\n\n[drop]\n";

/** What the page holds: the recording, its listing, and the text of the cask file, which is the truth. */
const state = { recording: null, listing: null, text: EMPTY, caskName: "cask.toml", isOwn: false, asked: 0, files: [], analysed: null };
let form;
let drawing;
let waiting;

/** One change of the text after the other. */
let queue = Promise.resolve();
const inTurn = (work) => (queue = queue.then(work).catch((refusal) => refuse("form-refusal", refusal)));

function refuse(place, refusal = null) {
  byId(place).replaceChildren(...(refusal ? told(refusal.problem ? refusal : { problem: String(refusal) }) : []));
}

const say = (place, words) => byId(place).replaceChildren(words);

function save(name, bytes) {
  const link = element("a", { download: name, href: URL.createObjectURL(new Blob([bytes])) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

const stillOpen = (count) => `${count} ${count === 1 ? "field is" : "fields are"} still to be filled in`;

/** A page of the program in a frame as high as the page, with the files that lie beside it. */
function frame(id, html, files) {
  const place = byId(id);
  place.onload = () => {
    const { document: inside, ResizeObserver } = place.contentWindow;
    const fit = () => { place.style.height = `${inside.documentElement.offsetHeight + 4}px`; };
    new ResizeObserver(fit).observe(inside.documentElement);
    // Without an address of its own a frame would follow a link to its own places, or to files beside it, away.
    inside.addEventListener("click", (event) => {
      const to = event.target.closest?.("a")?.getAttribute("href");
      if (!to) return;
      event.preventDefault();
      if (to.startsWith("#")) inside.getElementById(to.slice(1))?.scrollIntoView();
      else files.filter(([name]) => name === to).forEach((file) => save(...file));
    });
    place.contentWindow.scrollTo(0, inside.getElementById("curves-and-spectra")?.offsetTop ?? 0);
  };
  place.srcdoc = html;
}

/** Words with the seconds that a work takes, until it ends. */
async function during(place, words, work) {
  const begin = Date.now();
  say(place, words);
  const ticking = setInterval(() => say(place, `${words} ${Math.round((Date.now() - begin) / 1000)} s`), 1000);
  try {
    return await work;
  } finally {
    clearInterval(ticking);
    say(place, "");
  }
}

// The recording.

async function taken(files) {
  const isCask = (file) => /\.toml$/i.test(file.name);
  const cask = files.find(isCask);
  const recordings = files.filter((file) => !isCask(file));
  if (cask) await opened(cask);
  if (recordings.length > 1) {
    refuse("recording-refusal", { problem: `${recordings.length} files: one recording is analysed at a time`,
      mend: "choose one of them; a folder of ISO-MME as one zip" });
  } else if (recordings.length) await recorded(recordings[0]);
}

async function recorded(recording) {
  const { name } = recording;
  for (const place of ["recording-refusal", "analysis-refusal"]) refuse(place);
  byId("listing").replaceChildren();
  byId("look").hidden = byId("result").hidden = true;
  Object.assign(state, { recording: null, listing: null });
  const turn = ++state.asked;
  try {
    const listing = await during("recording-word", `Reading ${name} …`,
      forRecording.json({ op: "inspect", name }, recording));
    if (turn !== state.asked) return;
    Object.assign(state, { recording, listing });
    byId("listing").replaceChildren(...listed(listing));
    form.sources = listing.channels.map((channel) => channel.source);
    byId("anew").hidden = !state.isOwn;
    if (state.isOwn && form.channels().length) await inTurn(shownAnew);
    else await inTurn(() => begun({ keep: true }));
    const look = await forLook.text({ op: "look", name }, recording);
    if (turn !== state.asked) return;
    frame("look-frame", look, [["recording.json", JSON.stringify(listing, null, 2)]]);
    byId("look").hidden = false;
    byId("look").open = listing.channels.length <= 4;
  } catch (refusal) {
    if (turn === state.asked) refuse("recording-refusal", refusal);
  }
}

function listed(listing) {
  const number = (value, digits = 4) => (value === null ? "–"
    : Number(value.toPrecision(digits)).toLocaleString("en").replace("-", "−"));
  const heads = ["Channel", "Samples", "Rate in Hz", "Length in s", "Unit", "From", "To", "Gaps"];
  const rows = listing.channels.map((channel) => [channel.source, number(channel.samples, 12),
    number(channel.sample_rate_hz, 6), number(channel.duration_s), channel.unit ?? "not stated",
    number(channel.range?.[0] ?? null), number(channel.range?.[1] ?? null),
    channel.unreadable ?? channel.gaps ?? "–"]);
  const head = heads.map((word, i) => element("th", { scope: "col", class: i && i !== 4 ? "n" : null }, word));
  const body = rows.map((row) => element("tr", {}, ...row.map((cell, i) =>
    (i ? element("td", { class: i !== 4 ? "n" : null }, String(cell)) : element("th", { scope: "row" }, cell)))));
  const issues = listing.issues.map((issue) => element("p", {}, element("strong", {}, "Note: "), issue.message));
  return [element("p", {}, `${listing.recording}: ${listing.format}, ${number(listing.bytes / 1e6, 3)} MB, `
    + `${rows.length} ${rows.length === 1 ? "channel" : "channels"}.`),
  element("table", { tabindex: 0, "aria-label": "Channels of the recording" },
    element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...body)), ...issues];
}

/** The form that the recording calls for, with what is stated already of the cask and the drop. */
async function begun({ keep }) {
  const { recording } = state;
  let text = await forRecording.text({ op: "init", name: recording.name }, recording);
  for (const [table, keys] of Object.entries(keep ? form.values : {}).filter(([table]) => table !== "channel")) {
    for (const [key, value] of Object.entries(keys).filter(([, value]) => isStated(value))) {
      text = await forForm.text({ op: "edit", cask: text, path: `${table}.${key}`, value: toml(value) });
    }
  }
  Object.assign(state, { text, isOwn: keep && state.isOwn });
  form.drawnFor = null;
  await shownAnew();
}

// The cask file.

async function opened(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  const coding = { "255,254": "utf-16le", "254,255": "utf-16be" }[bytes.slice(0, 2)] ?? "utf-8";
  try {
    state.text = new TextDecoder(coding, { fatal: true }).decode(bytes);
  } catch {
    refuse("form-refusal", { problem: `${file.name}: not text in UTF-8`, mend: "save it as UTF-8 in an editor" });
    return;
  }
  Object.assign(state, { isOwn: true, caskName: file.name });
  byId("save-cask").textContent = `Save ${file.name}`;
  form.drawnFor = null;
  byId("anew").hidden = !state.recording;
  await inTurn(shownAnew);
}

/** Keys that a channel has no more with such a word, be it for its end or its axis. */
const WITHOUT = { '"none"': ["axis", "position_m", "offset_m", "polarity"], '"rate"': ["position_m", "offset_m"] };
let pending = 0;

/** A change that a field, a handle or a button asks for; of some that follow each other the last is shown. */
const changed = (path, value) => (pending += 1) && inTurn(async () => {
  pending -= 1;
  state.isOwn = true;
  const edit = async (path, value) => {
    state.text = await forForm.text({ op: "edit", cask: state.text, path, value });
  };
  if (value === "add") {
    const keys = form.tables.get("channel").keys.filter((key) => key.asked);
    const lines = keys.map((key) => `${key.name} = ${key.takes === "number" ? "nan" : '"FILL IN"'}\n`);
    state.text = `${state.text.trimEnd()}\n\n[[channel]]\n${lines.join("")}`;
  } else await edit(path, value);
  const place = /^channel\.\d+\.(?=(end|axis)$)/.exec(path)?.[0];
  for (const key of (place && WITHOUT[value]) ?? []) await edit(place + key, null);
  if (!pending) await shownAnew();
});

const moved = (i, position_m) => {
  const { end } = form.channels()[i];
  changed(`channel.${i}.position_m`, String(position_m));
  // What is laid on an end belongs to it; in the middle third it is asked for.
  const share = position_m / drawing.length;
  if (isStated(end) || Math.abs(share - 0.5) < 1 / 6) return;
  changed(`channel.${i}.end`, toml(share < 0.5 ? "first" : "second"));
};

/** Shows the text in form, drawing and prediction, and what is wrong in it. */
async function shownAnew() {
  if (document.activeElement !== byId("text")) byId("text").value = state.text;
  clearTimeout(waiting);
  refuse("form-refusal");
  toldStale();
  form.forgive();
  let values;
  try {
    values = await forForm.json({ op: "values", cask: state.text });
  } catch {
    await forForm.ask({ op: "check", cask: state.text });
    return;
  }
  form.show(values);
  const missing = form.missing();
  const strange = form.strangers();
  const are = strange.length === 1 ? "source is" : "sources are";
  const inRecording = strange.length ? ` ${strange.length} ${are} not in ${state.recording.name}: ${strange.join(", ")}.` : "";
  say("form-word", (missing.length ? `${stillOpen(missing.length)}.` : inRecording ? "" : "Nothing is missing.") + inRecording);
  try {
    await forForm.ask({ op: "check", cask: withExamples(state.text), cask_name: state.caskName });
  } catch (refusal) {
    const isOpen = refusal.key ? missing.includes(refusal.key) : missing.length > 0;
    if (!isOpen && !form.blame(refusal.key, told(inField(refusal)))) refuse("form-refusal", refusal);
  }
  await drawnAnew();
  foretold();
}

/** What the recording asks for by this cask file, such as a rate or a column of times, as the analysis would say it. */
async function demanded() {
  const { recording, text } = state;
  if (!recording || form.firstAtFault()) return;
  await forDemands.stop();
  try {
    await forDemands.ask({ op: "read", name: recording.name, cask: text, cask_name: state.caskName }, recording);
  } catch (refusal) {
    if (refusal.message === STOPPED || text !== state.text || recording !== state.recording) return;
    form.blame(refusal.key ?? fieldNamed(refusal), told(inField(refusal)));
    say("form-word", `The recording asks for more: ${refusal.problem}.`);
  }
}

/** A refusal under its field, which needs no line of the text. */
const inField = ({ problem, mend }) => ({ problem: problem.replace(/^.{0,200}?, line \d+: /, ""), mend });

/** The text with an example in each place that is still open: what is wrong beside these is told at once. */
function withExamples(text) {
  const keys = ["cask", "drop", "channel"].flatMap((table) => form.tables.get(table).keys);
  const example = (name) => keys.find((key) => key.example && key.name === name)?.example;
  return text.replace(/^(\w+)(\s*=\s*)(nan|"FILL IN")/gm, (line, name, equals) =>
    (example(name) ? `${name}${equals}${example(name)}` : line));
}

/** A cask file of some of what is stated. */
function draft(tables, channels = []) {
  const lines = (values) => Object.entries(values).filter(([, value]) => isStated(value))
    .map(([key, value]) => `${key} = ${toml(value)}\n`).join("");
  return [...Object.entries(tables).map(([table, values]) => `[${table}]\n${lines(values ?? {})}`),
    ...channels.map((channel) => `[[channel]]\n${lines(channel)}`)].join("");
}

async function drawnAnew() {
  const { cask = {}, drop = {} } = form.values;
  if (!isStated(cask.length_m) || !isStated(drop.angle_deg)) {
    drawing.clear("The drawing of the set-up appears here with the length of the cask and the drop angle.");
    return;
  }
  // The drawing does not show the mass, which may still be open: any that a cask of this size may have.
  const mass_kg = cask.mass_kg ?? 300 * cask.length_m * (cask.height_m || cask.length_m / 7) ** 2;
  const tables = { cask: { ...cask, mass_kg, inertia_kg_m2: null }, drop: { height_m: 1, angle_deg: drop.angle_deg } };
  const channels = form.channels().map((channel, i) => ({ ...channel, source: `s${i}` }))
    .filter((channel) => drawing.isDrawn(channel))
    .map(({ name, end, axis, source, position_m, offset_m, polarity }) =>
      ({ name, end, axis, source, position_m, offset_m, polarity }));
  try {
    const svg = await forForm.text({ op: "setup", cask: draft(tables, channels) });
    drawing.show(svg, form.channels(), cask);
  } catch {
    drawing.clear("There is no drawing of what the fields state: see what is marked there.");
  }
}

/** The prediction, once nothing more is typed for a while. */
function foretold() {
  waiting = setTimeout(async () => {
    demanded();
    const { cask, drop, contact, tolerance } = form.values;
    const isOpen = form.missing().some((path) => !path.startsWith("channel."));
    try {
      const tables = { cask, drop, contact, tolerance };
      await forPrediction.stop();
      say("prediction", isOpen ? "" : predicted(await forPrediction.json({ op: "predict", cask: draft(tables) })));
    } catch {
      say("prediction", "");
    }
  }, 400);
}

function predicted({ advice: { own_deg, own_range_m_s, own_share, drawn } }) {
  const at = `at ${shown(own_deg)}°`;
  if (own_range_m_s[0] === null) return `In most of the draws the model predicts no slap-down ${at}.`;
  const [least, most] = own_range_m_s.map((speed) => speed.toFixed(2));
  const range = (ends) => [...new Set(ends)].join(" to ");
  const friction = drawn.friction ? ` and a friction of ${range(drawn.friction)}` : "";
  const lasting = range(drawn.contact_s.map((seconds) => 1e3 * seconds));
  return `Predicted slap-down speed ${at}: ${least} to ${most} m/s in 95 % of the draws, `
    + `for a restitution k of ${range(drawn.k)}${friction}, with a first contact of ${lasting} ms`
    + `${own_share < 1 ? "; in a part of this range the cask does not slap down." : "."}`;
}

// The result.

async function analysed() {
  refuse("analysis-refusal");
  await queue;
  if (!state.recording) {
    refuse("analysis-refusal", { problem: "there is no recording yet", mend: "choose one above, under 1" });
    byId("file").focus();
    return;
  }
  const fault = form.firstAtFault();
  if (fault) {
    const many = form.missing().length;
    refuse("analysis-refusal", { problem: many ? stillOpen(many) : "a field is wrong",
      mend: "the first of them has the cursor now" });
    form.focus(fault);
    return;
  }
  byId("result").hidden = true;
  byId("stop").hidden = false;
  try {
    const question = { op: "report", name: state.recording.name, cask: state.text, cask_name: state.caskName,
      analysed: new Date().toISOString().replace(/\.\d+/, "") };
    const work = forRecording.ask(question, state.recording);
    const answer = await during("progress", `Analysing ${question.name} …`, work);
    Object.assign(state, { analysed: question.cask, reportName: `${question.name.replace(/\.\w{1,5}$/, "")}-report.html` });
    byId("save-report").textContent = `Save ${state.reportName}`;
    toldStale();
    state.files = answer.header.names.map((name, i) => [name, answer.bodies[i]]);
    const [[, report], ...others] = state.files;
    byId("files").replaceChildren(...others.map(([name, bytes]) => {
      const button = element("button", { type: "button" }, `Save ${name}`);
      button.onclick = () => save(name, bytes);
      return button;
    }));
    byId("result").hidden = false;
    frame("report-frame", new TextDecoder().decode(report), others);
    say("progress", withoutPictures());
    byId("result").scrollIntoView();
  } catch (refusal) {
    const path = refusal.key ?? fieldNamed(refusal);
    if (refusal.message === STOPPED) say("progress", "Stopped.");
    else if (form.blame(path, told(refusal))) form.focus(path);
    else refuse("analysis-refusal", refusal);
  } finally {
    byId("stop").hidden = true;
  }
}

/** The field of a channel that a refusal of the recording speaks of: the key that its remedy names, or the source. */
function fieldNamed({ problem = "", mend }) {
  const i = form.channels().findIndex(({ name }) => problem.includes(`channel "${name}"`));
  const keys = form.tables.get("channel").keys.map((key) => key.name);
  const named = [...(mend ?? "").matchAll(/`(\w+)/g)].map(([, word]) => word).find((word) => keys.includes(word));
  return i < 0 ? null : `channel.${i}.${named ?? "source"}`;
}

const toldStale = () => say("stale",
  state.analysed === state.text ? "" : "The form was changed after this report: press Analyse again.");

/** What the report has not, since it stands in other files. */
function withoutPictures() {
  const { test, report } = form.values;
  if (!isStated(test?.photos) && !isStated(report?.logo)) return "";
  return "The report here is without photographs and logo: a page cannot open the files beside the cask file.";
}

async function started() {
  const tables = await forForm.json({ op: "keys" });
  form = new Form(byId("form"), tables, changed);
  drawing = new Drawing(byId("drawing"), moved, (i) => form.focus(`channel.${i}.position_m`));
  await inTurn(shownAnew);
}

/** What is done before the form is there waits for it. */
const ready = during("recording-word", "Starting …", started());
const whenReady = (work) => ready.then(work, () => null);

function listen() {
  const [drop, file, cask] = ["drop", "file", "cask"].map(byId);
  const take = (files) => whenReady(() => taken(files));
  file.onchange = () => take([...file.files]);
  cask.onchange = () => whenReady(() => opened(cask.files[0]));
  // So that the same file can be chosen again, once it was changed.
  for (const input of [file, cask]) input.onclick = () => { input.value = ""; };
  for (const kind of ["dragover", "drop"]) document.addEventListener(kind, (event) => event.preventDefault());
  document.addEventListener("dragover", () => drop.classList.add("over"));
  document.addEventListener("dragleave", () => drop.classList.remove("over"));
  document.addEventListener("drop", (event) => {
    drop.classList.remove("over");
    const isFolder = [...event.dataTransfer.items].some((item) => item.webkitGetAsEntry?.()?.isDirectory);
    if (!isFolder) take([...event.dataTransfer.files]);
    else refuse("recording-refusal", { problem: "this is a folder", mend: "pack it as a zip, and drop that" });
  });
  byId("anew").onclick = () => inTurn(() => begun({ keep: false }));
  byId("form").onsubmit = (event) => event.preventDefault();
  byId("text").oninput = () => whenReady(() => inTurn(() => {
    Object.assign(state, { text: byId("text").value, isOwn: true });
    return shownAnew();
  }));
  byId("save-cask").onclick = () => queue.then(() => save(state.caskName, state.text));
  byId("analyse").onclick = () => whenReady(analysed);
  byId("stop").onclick = () => forRecording.stop();
  byId("save-report").onclick = () => save(state.reportName, state.files[0][1]);
  byId("print").onclick = () => byId("report-frame").contentWindow.print();
}

listen();
ready.catch((fault) => refuse("broken", { problem: `This browser cannot run the page: ${fault.message}.`,
  mend: "It needs a browser of 2023 or newer that may run WebAssembly." }));
