// Questions to the module `page/src`, asked in a worker, to its answers: the page never waits for one.

const LARGEST_BYTES = 1e9;
const STOPPED = "stopped";

/** What was wrong, with the place in the cask file if it lies there; its message is the command's. */
class Refusal extends Error {
  constructor({ text, problem = text, mend = null, key = null }) {
    super(text);
    Object.assign(this, { name: "Refusal", problem, mend, key });
  }
}

/** Runs in the worker, of which it is the whole text. Each question has an instance, and so a memory, of its own. */
function atWork() {
  let engine;

  function asked(header, recording) {
    const { memory, alloc, call } = new WebAssembly.Instance(engine).exports;
    const question = new TextEncoder().encode(JSON.stringify(header));
    const length = 4 + question.length + recording.length;
    const at = alloc(length) >>> 0;
    new DataView(memory.buffer).setUint32(at, question.length, true);
    const block = new Uint8Array(memory.buffer, at, length);
    block.set(question, 4);
    block.set(recording, 4 + question.length);
    const place = call(at, length) >>> 0;
    const word = (from) => new DataView(memory.buffer).getUint32(from, true);
    const part = (_, i) => new Uint8Array(memory.buffer, word(place + 4 + 8 * i), word(place + 8 + 8 * i)).slice();
    const [head, ...bodies] = Array.from({ length: word(place) }, part);
    return { header: JSON.parse(new TextDecoder().decode(head)), bodies };
  }

  function answered({ header, bytes }) {
    try {
      return asked(header, new Uint8Array(bytes));
    } catch (fault) {
      const problem = `${header.name || "the cask file"}: the program ended without an answer (${fault.message})`;
      const mend = "a large recording may need more memory than a page gets (4 GB): cut it to some seconds around the "
        + "drop, or analyse it by the dropcheck command; a small one that does this is a fault of dropcheck to report";
      return { header: { error: { text: `${problem}\n  help: ${mend}`, problem, mend } } };
    }
  }

  self.onmessage = ({ data }) => {
    if (data.engine) { engine = data.engine; return; }
    const { header, bodies = [] } = answered(data);
    self.postMessage({ id: data.id, header, bodies }, bodies.map((body) => body.buffer));
  };
}

/** The module out of the page's own text. */
async function compiled() {
  const packed = Uint8Array.from(atob(document.getElementById("engine").textContent.trim()), (c) => c.charCodeAt(0));
  const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(plain).arrayBuffer());
}

const engine = compiled();

/** A worker that is asked one question after the other. */
class Asker {
  constructor() {
    Object.assign(this, { waiting: new Map(), number: 0 });
    this.start();
  }

  start() {
    const text = URL.createObjectURL(new Blob([`(${atWork})()`], { type: "text/javascript" }));
    const worker = new Worker(text);
    worker.onmessage = ({ data }) => {
      const { resolve, reject } = this.waiting.get(data.id);
      this.waiting.delete(data.id);
      if (data.header.error) reject(new Refusal(data.header.error));
      else resolve(data);
    };
    this.worker = engine.then((engine) => { worker.postMessage({ engine }); return worker; });
  }

  /** Ends what it works on. */
  async stop() {
    (await this.worker).terminate();
    for (const { reject } of this.waiting.values()) reject(new Refusal({ text: STOPPED }));
    this.waiting.clear();
    this.start();
  }

  /** The answer's header and bodies; `recording` is a Blob or nothing. */
  async ask(header, recording = null) {
    const refuse = (problem, mend) => { throw new Refusal({ text: `${problem}\n  help: ${mend}`, problem, mend }); };
    if (recording?.size > LARGEST_BYTES) {
      refuse(`${header.name}: ${(recording.size / 1e9).toFixed(1)} GB are more than a page can hold (1 GB)`,
        "cut it to some seconds around the drop, or analyse it by the dropcheck command");
    }
    // Read here: WebKit lets no worker of a page on a disk do it.
    const bytes = await (recording ?? new Blob()).arrayBuffer().catch(() =>
      refuse(`${header.name}: the browser can no longer read the file`,
        "it was moved, changed or is too large for the memory that is free; choose it again"));
    const worker = await this.worker;
    const id = this.number++;
    const answer = new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
    worker.postMessage({ id, header, bytes }, [bytes]);
    return answer;
  }

  async text(header, recording) {
    return new TextDecoder().decode((await this.ask(header, recording)).bodies[0]);
  }

  async json(header, recording) {
    return JSON.parse(await this.text(header, recording));
  }
}

// Each answers while the others work: the form is typed in while a recording is read, and its curves are drawn.
const forForm = new Asker();
const forPrediction = new Asker();
const forLook = new Asker();
const forDemands = new Asker();
const forRecording = new Asker();

/** Bytes as another program may hand them over. */
const blob = (bytes) => new Blob([Array.isArray(bytes) ? Uint8Array.from(bytes) : bytes]);

window.dropcheck = {
  inspect: (bytes, name) => forRecording.json({ op: "inspect", name }, blob(bytes)),
  analyze: (bytes, name, cask) => forRecording.json({ op: "analyze", name, cask }, blob(bytes)),
};
