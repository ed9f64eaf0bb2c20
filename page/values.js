// What a cask file states to words and fields of the form, and what is typed there to TOML.

/** Units by the end of a key, the longest first. */
const UNITS = [["kg_m2", "kg m²"], ["m_s2", "m/s²"], ["deg_s", "°/s"], ["rad_s", "rad/s"], ["m_s", "m/s"],
  ["percent", "%"], ["deg", "°"], ["kg", "kg"], ["hz", "Hz"], ["mm", "mm"], ["mn", "MN"], ["kj", "kJ"],
  ["m", "m"], ["s", "s"], ["c", "°C"], ["g", "g"]];

/** Names that the key alone would tell badly. */
const LABELS = { cog_m: "Centre of gravity", inertia_kg_m2: "Moment of inertia", cfc: "Class (CFC)",
  "cask.height_m": "Height of the section", "cask.width_m": "Width of the section",
  "drop.height_m": "Drop height", "drop.angle_deg": "Drop angle", position_m: "Position", k: "k" };

/** The words that a key takes and what they mean, as its row has them; null where it takes others. */
function choicesOf({ name, takes, remark, default: otherwise }) {
  if (takes === "flag") return { true: "made", false: "left out" };
  if (name === "polarity") return { 1: "+ as the arrow shows", "-1": "− the other way round" };
  const words = [...`${otherwise}, ${remark}`.matchAll(/"(\w+)"(?: \((.*?)\)|: (.*))?/g)];
  if (takes !== "text" || words.length < 2) return null;
  return Object.fromEntries(words.map(([, word, ...meant]) => [word, [word, ...meant.filter(Boolean)].join(": ")]));
}

/** Whether a channel is an accelerometer, which has a place on the cask. */
const isOfMotion = ({ end, axis }) => end !== "none" && axis !== "rate";

/** Keys that are shown first; the others wait behind "More". */
const FIRST = {
  cask: ["name", "mass_kg", "length_m", "height_m", "cog_m"],
  drop: ["height_m", "angle_deg"],
  channel: ["name", "end", "axis", "position_m", "polarity", "source", "unit"],
};

const DECIMAL_SIGN = (() => {
  try { return new Intl.NumberFormat(navigator.language).format(1.5).charAt(1); } catch { return "."; }
})();

/** `mass_kg` to "Mass" and "kg". */
function named(table, key) {
  const [ending, unit] = UNITS.find(([ending]) => key.endsWith(`_${ending}`)) ?? ["", ""];
  const bare = (ending ? key.slice(0, -ending.length - 1) : key).replaceAll("_", " ");
  const label = LABELS[`${table}.${key}`] ?? LABELS[key] ?? bare.charAt(0).toUpperCase() + bare.slice(1);
  return { label, unit };
}

/** What a key means, which numbers it takes, and what holds where it is left out. */
function hint({ name, remark, allowed, default: otherwise, example, takes }) {
  const plain = (text) => text.replaceAll("`", "");
  const words = [name === "source" ? "a channel of the recording" : plain(remark)];
  if (/\d/.test(allowed)) words.push(allowed);
  const isTold = /left out|default|^$|^–|^required/.test(remark.match(/left out|default/) ?? otherwise);
  if (!isTold) words.push(`left out: ${plain(otherwise)}`);
  if (["other", "date", "texts"].includes(takes) && example && name !== "source") words.push(`such as ${example}`);
  return words.filter(Boolean).join("; ");
}

/** A value to TOML. */
function toml(value) {
  if (typeof value === "string") return JSON.stringify(value);
  if (value === null) return "nan";
  if (Array.isArray(value)) return `[${value.map(toml).join(", ")}]`;
  if (typeof value !== "object") return String(value);
  if ("$__toml_private_datetime" in value) return value.$__toml_private_datetime;
  const name = (key) => (/^[\w-]+$/.test(key) ? key : toml(key));
  const pairs = Object.entries(value).map(([key, value]) => `${name(key)} = ${toml(value)}`);
  return `{ ${pairs.join(", ")} }`;
}

const isStated = (value) => value !== undefined && value !== null && value !== "FILL IN";

/** A value as its field shows it. */
function shown(value) {
  if (!isStated(value)) return "";
  if (typeof value === "number") return String(value).replace(".", DECIMAL_SIGN);
  return typeof value === "string" ? value : toml(value);
}

/** A number as people write it, with a point or a comma before the decimals, to one of TOML; throws words. */
function numberOf(text) {
  const bare = text.replace(/\s/g, "").replace("−", "-").replace(",", ".");
  if (/^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(bare)) return String(Number(bare));
  if (/^[-+]?[\d.,]+$/.test(bare)) {
    throw new Error(`${text} has more than one decimal sign: write thousands without signs, as 1234${DECIMAL_SIGN}5`);
  }
  throw new Error(`${text} is no number: write digits alone, without a unit, as 1${DECIMAL_SIGN}5`);
}

/** What is typed for a key to TOML, null where the key is to be left out; throws words. */
function literal({ name, takes }, text) {
  const typed = text.trim();
  if (typed === "") return null;
  if (takes === "number") return numberOf(typed);
  if (["flag", "date", "texts"].includes(takes) || (takes === "other" && typed.startsWith("{"))) return typed;
  if (name === "friction") {
    try { return numberOf(typed); } catch { /* A word. */ }
  }
  return toml(typed);
}
