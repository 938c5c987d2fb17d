// Everything that the user can set: estimator, unit, forces, sample, time; by mouse and by keyboard.
import { readable } from "./wire.js";

const get = (id) => document.getElementById(id);
const NEEDED = "no grasp without a lump to compare with; start again with --reference FOLDER";

function option(value, words) {
  const made = document.createElement("option");
  made.value = value;
  made.textContent = words;
  return made;
}

export class Controls {
  constructor(send, redraw, turn) {
    Object.assign(this, { send, unit: "N", sample: 0, steps: [], step: 0, playing: false });
    get("controls").addEventListener("submit", (event) => event.preventDefault());
    get("units").addEventListener("change", (event) => { this.unit = event.target.value; redraw(); });
    get("estimators").addEventListener("change", (event) => send({ do: "estimator", name: event.target.value }));
    get("source").addEventListener("change", (event) => send({ do: "source", name: event.target.value }));
    get("play").addEventListener("click", () => this.toggle());
    get("slider").addEventListener("input", (event) => send({ do: "show", step: Number(event.target.value) }));
    get("previous").addEventListener("click", () => send({ do: "sample", move: -1 }));
    get("next").addEventListener("click", () => send({ do: "sample", move: 1 }));
    get("number").addEventListener("change", ({ target }) => this.#pick(target));
    get("number").addEventListener("blur", ({ target }) => { if (!target.validity.valid) target.value = this.sample; });
    for (const id of ["split", "status"]) get(id).addEventListener("change", () => this.#filter());
    for (const button of document.querySelectorAll("[data-turn]")) {
      button.addEventListener("click", () => turn(button.dataset.turn));
    }
    document.addEventListener("keydown", (event) => this.#key(event));
  }

  offer(message) {
    const place = get("estimators");
    for (const old of place.querySelectorAll("label")) old.remove();
    message.estimators.forEach((one, k) => {
      const label = document.createElement("label"), input = document.createElement("input");
      Object.assign(input, { type: "radio", name: "estimator", value: one.name, disabled: !one.enabled });
      label.className = one.enabled ? "" : "off";
      label.title = one.enabled ? `key ${k + 1}` : NEEDED;
      label.append(input, document.createTextNode(`${k + 1} ${one.label}`));
      place.append(label);
    });
    const greyed = message.estimators.flatMap((one, k) => (one.enabled ? [] : [k + 1]));
    get("missing").hidden = !greyed.length;
    get("missing").textContent = greyed.length ? `${greyed.join(", ")} greyed: ${NEEDED}` : "";
    place.append(get("missing"));
    get("samples").hidden = !message.samples;
    if (!message.samples) return;
    get("number").max = message.samples.count - 1;
    get("split").replaceChildren(option("", "any"), ...message.samples.splits.map((name) => option(name, name)));
    get("status").replaceChildren(option("", "any"), ...message.samples.status.map((name) => option(name, name)));
  }

  state(message) {
    for (const input of get("estimators").querySelectorAll("input")) input.checked = input.value === message.estimator;
    get("source-choice").hidden = message.sources.length < 2;
    get("source").replaceChildren(...message.sources.map((one) => option(one.name, one.label)));
    get("source").value = message.source;
    if (!message.sample) return;
    const { number, split, status, chosen, state } = message.sample;
    if (number !== null) this.sample = get("number").value = number;
    get("split").value = split;
    get("status").value = status;
    get("sample-words").textContent = `${number === null ? "none" : `${state.split}, ${state.status}`}; ${chosen} to choose from`;
  }

  times(times, live) {
    this.steps = times;
    get("time").hidden = times.length < 2 && !live;
    for (const id of ["play", "slider"]) get(id).hidden = times.length < 2;
    get("keys").textContent = (live ? "" : "space plays, ← → step, ") + "digits choose the estimator";
    get("now").textContent = "";
    get("slider").max = Math.max(0, times.length - 1);
  }

  frame(frame) {
    this.step = frame.step;
    this.playing = frame.playing;
    const play = get("play"), slider = get("slider"), words = frame.playing ? "Pause" : "Play";
    if (play.textContent !== words) { play.textContent = words; play.setAttribute("aria-pressed", String(frame.playing)); }
    if (Number(slider.value) !== frame.step) slider.value = frame.step;
    const time = frame.time === null ? "" : `${frame.time.toFixed(3)} s`;
    const closing = frame.closing === null ? "" : `, closed by ${readable(frame.closing, 3)} mm`;
    get("now").textContent = time + closing;
    if (!frame.playing) slider.setAttribute("aria-valuetext", `step ${frame.step + 1} of ${this.steps.length}, ${time}`);
  }

  lost() { // units change what is drawn here; all else asks the server
    for (const id of ["estimators", "source-choice", "samples", "play", "slider", "again"]) get(id).disabled = true;
  }

  toggle() { this.send({ do: this.playing ? "pause" : "play" }); }

  #pick(field) {
    if (field.reportValidity()) return this.send({ do: "sample", number: Number(field.value) });
    get("sample-words").textContent = `${field.value || "this"} is no sample; shown is ${this.sample}, the last is ${field.max}`;
  }

  #filter() { this.send({ do: "filter", split: get("split").value, status: get("status").value }); }

  #key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const at = event.target, typing = at.matches("select, input[type=number]"), inGroup = at.matches("input[type=radio], input[type=range]");
    const steps = { ArrowRight: 1, ArrowLeft: -1, Home: -Infinity, End: Infinity };
    if (event.key === " " && !typing && !at.matches("button, input[type=radio]")) {
      this.toggle();
    } else if (event.key in steps && !typing && !inGroup && this.steps.length > 1) {
      const wanted = Math.min(this.steps.length - 1, Math.max(0, this.step + steps[event.key]));
      this.send({ do: "show", step: wanted });
      this.step = wanted;
    } else if (/^[1-9]$/.test(event.key) && !typing) {
      const input = get("estimators").querySelectorAll("input")[Number(event.key) - 1];
      if (!input || input.matches(":disabled") || input.checked) return;
      input.checked = true;
      this.send({ do: "estimator", name: input.value });
    } else {
      return;
    }
    event.preventDefault();
  }
}
