// The drawing of the set-up, as the program draws it, with the sensors to be moved along the cask.

const SVG = "http://www.w3.org/2000/svg";

function drawn(tag, attributes, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

class Drawing {
  /** `moved(i, position_m)` takes the new place of a channel; `chosen(i)` is asked to show its fields. */
  constructor(place, moved, chosen) {
    Object.assign(this, { place, moved, chosen });
    this.below = element("div", {});
    this.above = drawn("svg", { class: "handles", role: "group", "aria-label": "Places of the sensors" });
    place.append(this.below, this.above);
  }

  clear(words) {
    this.below.replaceChildren(element("p", { class: "soft" }, words));
    this.above.replaceChildren();
    this.corners = null;
  }

  /** The program's drawing, and over it each channel where it can be taken hold of. */
  show(svg, channels, cask) {
    this.below.innerHTML = svg;
    const picture = this.below.querySelector("svg");
    this.above.setAttribute("viewBox", picture.getAttribute("viewBox"));
    const corners = picture.querySelector("polygon").getAttribute("points").split(" ");
    this.corners = corners.map((corner) => corner.split(",").map(Number));
    this.length = cask.length_m;
    this.step = 10 ** Math.floor(Math.log10(this.length / 200));
    const focused = document.activeElement?.dataset?.channel;
    const waiting = channels.filter((channel) => isOfMotion(channel) && !isStated(channel.position_m));
    const isHere = (one, other) => Math.abs(one.position_m - other.position_m) < this.length / 40;
    const handles = channels.map((channel, i) => {
      // Sensors at one place stand below each other.
      const beside = channels.slice(0, i).filter((other) => isStated(channel.position_m) && isHere(channel, other));
      return isOfMotion(channel) ? this.handle(channel, i, waiting.indexOf(channel), beside.length) : "";
    });
    const words = waiting.length ? [drawn("text", { x: 60, y: 42, "font-size": 24 }, "Drag to its place:")] : [];
    this.above.replaceChildren(...words, ...handles);
    if (focused !== undefined) this.above.querySelector(`[data-channel="${focused}"]`)?.focus();
  }

  /** Where a place along the axis is drawn, in the middle of the section. */
  at(position_m) {
    const [[x0, y0], [x1, y1], , [x3, y3]] = this.corners;
    const share = position_m / this.length;
    return [(x0 + x3) / 2 + share * (x1 - x0), (y0 + y3) / 2 + share * (y1 - y0)];
  }

  /** The place along the axis below a pointer. */
  along({ clientX, clientY }) {
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(this.above.getScreenCTM().inverse());
    const [[x0, y0], [x1, y1]] = this.corners;
    const share = ((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / ((x1 - x0) ** 2 + (y1 - y0) ** 2);
    return this.rounded(share * this.length);
  }

  rounded(position_m) {
    const digits = Math.max(0, -Math.log10(this.step));
    return Number(Math.min(Math.max(position_m, 0), this.length).toFixed(digits));
  }

  handle(channel, i, turn, below) {
    const isPlaced = turn < 0;
    const name = isStated(channel.name) ? channel.name : `channel ${i + 1}`;
    const [x, y] = isPlaced ? this.at(channel.position_m)
      : [350 + 190 * (turn % 8), 34 + 76 * Math.floor(turn / 8)];
    const handle = drawn("g", { class: "handle", tabindex: 0, role: "slider", "data-channel": i,
      "aria-label": `Place of ${name} along the axis`, "aria-valuemin": 0, "aria-valuemax": this.length,
      "aria-valuenow": isPlaced ? channel.position_m : 0, transform: `translate(${x} ${y + 68 * below})`,
      "aria-valuetext": isPlaced ? `${channel.position_m} m from the first end` : "no place yet" },
    drawn("circle", { r: 34 }));
    // The program draws the name of a channel that is stated in full.
    if (!this.isDrawn(channel)) handle.append(drawn("text", { y: 10, "font-size": 26 }, name.slice(0, 14)));
    handle.onpointerdown = (event) => this.drag(handle, i, event);
    handle.onkeydown = (event) => this.key(event, i, isPlaced ? channel.position_m : 0);
    return handle;
  }

  isDrawn(channel) {
    return ["name", "end", "axis", "position_m"].every((key) => isStated(channel[key])) && isOfMotion(channel);
  }

  drag(handle, i, event) {
    event.preventDefault();
    handle.focus();
    handle.setPointerCapture(event.pointerId);
    let place = null;
    handle.onpointermove = (move) => {
      place = this.along(move);
      handle.setAttribute("transform", `translate(${this.at(place).join(" ")})`);
      byId(`field-channel.${i}.position_m`).value = shown(place);
    };
    handle.onpointerup = handle.onpointercancel = () => {
      handle.onpointermove = handle.onpointerup = handle.onpointercancel = null;
      if (place !== null) this.moved(i, place);
    };
  }

  key(event, i, position_m) {
    const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    const ends = { Home: 0, End: this.length }[event.key];
    if (event.key === "Enter") this.chosen(i);
    else if (steps !== undefined) this.moved(i, this.rounded(position_m + steps * this.step));
    else if (ends !== undefined) this.moved(i, ends);
    else return;
    event.preventDefault();
  }
}
