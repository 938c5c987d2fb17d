// The answer: what an estimator states, of which step and how old; while one is computed, how far it is; never one that is past.
const get = (id) => document.getElementById(id);

function paragraph(words, kind = "") {
  const made = document.createElement("p");
  made.textContent = words;
  made.className = kind;
  return made;
}

const isPlace = (words) => / at \(|^At \(/.test(words);

// The places with what is said of them, then why; where nothing is, the reason alone comes first.
const placesFirst = ([reason, ...rest]) => (rest.some(isPlace) ? [...rest, reason] : [reason, ...rest]);

export class Answer {
  constructor(send) {
    Object.assign(this, { send, inclusions: [], message: null, since: 0, now: null });
    get("cancel").addEventListener("click", () => send({ do: "cancel" }));
    get("again").addEventListener("click", () => send({ do: "estimate" }));
    setInterval(() => this.#age(), 500);
  }

  // Takes a message of the server; what it says replaces what was said before.
  take(message) {
    Object.assign(this, { message, since: performance.now(), inclusions: message.busy ? [] : message.inclusions });
    get("estimate-of").textContent = message.label;
    get("busy").hidden = !message.busy;
    get("again").hidden = !message.cancelled;
    if (message.busy) {
      const done = message.systems ? `, ${message.systems} part${message.systems === 1 ? "" : "s"} done` : "";
      const stage = message.stage ? `; ${message.stage}` : "", of = this.#moment(message).replace(/, $/, "");
      get("busy-words").textContent = `Computing the estimate${of && ` of ${of}`}: ${Math.round(message.seconds)} s so far${done}${stage}`;
    }
    const lines = message.busy ? [] : [
      ...placesFirst(message.words).map((words) => paragraph(words, isPlace(words) ? "place" : "")),
      ...message.errors.map((words) => paragraph(words)),
      ...(message.noise ? [paragraph(message.noise, "quiet")] : []),
      ...(message.fault ? [paragraph(message.cancelled ? `No estimate: ${message.fault}` : message.fault, "fault")] : []),
    ];
    const words = lines.map((line) => line.textContent).join("\n"), place = get("estimate");
    if (place.dataset.words !== words) place.replaceChildren(...lines);
    place.dataset.words = words;
    this.#age();
  }

  // Nothing is stated any more: another scene, or nothing to show.
  clear() {
    Object.assign(this, { message: null, inclusions: [] });
    get("busy").hidden = get("again").hidden = true;
    get("estimate").replaceChildren();
    get("estimate").dataset.words = get("estimate-of").textContent = get("age").textContent = "";
  }

  // The server has gone: nothing is being computed any more.
  lost() {
    if (this.message?.busy) this.take({ ...this.message, busy: false, words: [], errors: [], noise: "", inclusions: [], fault: "the server has ended", cancelled: true });
    get("again").hidden = true;
  }

  frame(frame) { this.now = frame; }

  #moment({ moment }) {
    if (!moment || moment.time === undefined) return "";
    const step = moment.steps > 1 ? `step ${moment.step} of ${moment.steps}, ` : "";
    const time = moment.time === null || (moment.steps === 1 && moment.time === 0) ? "" : `${moment.time.toFixed(3)} s, `;
    return `${step}${time}`;
  }

  #age() {
    if (!this.message || this.message.busy || this.message.cancelled) { get("age").textContent = ""; return; }
    if (this.message.estimator === "stored") { get("age").textContent = "Computed with the result, not now"; return; }
    const seconds = Math.floor((performance.now() - this.since) / 1000), { moment } = this.message;
    const of = this.#moment(this.message), behind = this.now && moment.time != null && this.now.time !== null
      && Math.abs(this.now.time - moment.time) > 5e-4 ? `; the picture is of ${this.now.time.toFixed(3)} s` : "";
    get("age").textContent = `Of ${of || "these readings, "}computed ${seconds < 1 ? "just now" : `${seconds} s ago`}${behind}`;
  }
}
