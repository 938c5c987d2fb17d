// The page: what the server sends goes to the views, what the user does goes to the server. All words go in as text, never HTML.
import { Answer } from "./answer.js";
import { Controls } from "./controls.js";
import { Taxels } from "./taxels.js";
import { View } from "./views.js";
import { drawRamp, evenly, forceUnit, readFrame, readable } from "./wire.js";

const get = (id) => document.getElementById(id);
const views = ["front", "left", "top"].map((kind) => new View(get(kind), kind));
const taxels = new Taxels(get("tables"), get("taxel-unit"), get("taxel-words"));
const alerts = {};
let scene = null, frame = null, waiting = null, received = 0, inclusions = [], space = null, drawnTimes = [], over = "";
let socket = null;

const send = (command) => {
  if (command.do !== "drawn") alarm("command", []);      // what was wrong with the last command has been read
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(command));
};
const answer = new Answer(send);
const controls = new Controls(send, () => ask(), (way) => space?.turn(way));
const TABLE_PERIOD = 100;                 // ms between two numbers in a cell: faster ones cannot be read
let asked = false, later = 0, numbersAt = -Infinity;

import("./space.js").then(({ Space }) => {
  space = new Space(get("space-canvas"), get("space-labels"));
  if (scene) { space.setScene(scene); space.setInclusions(inclusions); space.setEstimate(answer.inclusions); }
  if (frame) space.setFrame(frame);
  ask();
}).catch((error) => alarm("space", [`The view in space cannot be drawn: ${error.message}`]));

function alarm(who, messages) {
  alerts[who] = messages.filter(Boolean);
  const all = Object.values(alerts).flat(), words = all.join("\n"), strip = get("alerts");
  if (strip.dataset.words === words) return;
  strip.dataset.words = words;
  strip.hidden = all.length === 0;
  strip.replaceChildren(...all.map((message) => paragraph(message)));
}

function paragraph(words, kind = "") {
  const made = document.createElement("p");
  made.textContent = words;
  made.className = kind;
  return made;
}

const take = {
  offer(message) { controls.offer(message); take.state(message); },
  state(message) {
    controls.state(message);
    alarm("selection", [message.selection_fault]);
    if (message.selection_fault) clear();
  },
  scene(message) {
    scene = message; frame = null; waiting = null; inclusions = [];
    answer.clear();
    document.title = `${scene.title} – tactsim`;
    get("title").textContent = get("title").title = scene.title;
    for (const part of [...views, taxels]) part.setScene(scene);
    space?.setScene(scene);
    controls.times(scene.times, scene.live);
    controls.state(message);
    alarm("selection", [message.selection_fault]);
    alarm("scene", scene.notes);
    alarm("command", []);
    legend();
    past();
  },
  shapes(message) { inclusions = message.inclusions; space?.setInclusions(inclusions); legend(); ask(); },
  estimate(message) {
    answer.take(message);
    space?.setEstimate(answer.inclusions);
    legend();
    ask();
  },
  feed(message) {
    const bad = message.malformed ? `, ${message.malformed} malformed` : "";
    get("source-line").textContent = `${message.name}: ${message.state}, ${message.frames} frames${bad}`;
    get("source-line").title = message.malformed ? `the last malformed one: ${message.fault}` : "";
    const words = `${message.malformed} malformed in the stream, the last one: ${message.fault}`;
    alarm("feed", message.malformed && message.recent ? [words] : []);
    over = message.over && message.frames ? `${message.name}: ${message.state}. This picture is of the past.` : "";
    past();
  },
  fault(message) { alarm("command", [message.words]); },
};

// Greys the whole picture when it is no longer that of now.
function past(words = scene?.live ? over : "") {
  const place = get("past");
  if (socket?.readyState === WebSocket.CLOSED) words = "The server has ended or cannot be reached. This picture is of the past; start tactsim show again.";
  if (place.textContent !== words) place.textContent = words;
  place.hidden = !words;
  document.body.classList.toggle("past", Boolean(words));
}

function clear() {
  taxels.place.replaceChildren();
  answer.clear();
  frame = waiting = null; inclusions = [];
  space?.clear();
  get("title").textContent = get("title").title = document.title = "tactsim";
  get("space-words").textContent = "";
  legend();
  for (const view of views) view.canvas.getContext("2d").clearRect(0, 0, view.canvas.width, view.canvas.height);
}

// Frames are drawn when the browser draws; those that came in between are told as drawn, so that the server goes on.
function takeFrame(buffer) {
  received += 1;
  if (!scene) return;
  waiting = buffer;
  ask();
}

// Draws everything once when the browser draws next, however often it is asked.
function ask() {
  if (asked) return;
  asked = true;
  requestAnimationFrame((now) => { asked = false; draw(now); });
}

function draw(now) {
  const fresh = waiting && scene;
  if (fresh) {
    frame = readFrame(waiting, scene);
    waiting = null;
    for (; received > 0; received--) send({ do: "drawn" });
    space?.setFrame(frame);
  }
  if (!frame) return;
  drawViews(now);
  if (space?.drawFrame(now) && !later) later = setTimeout(() => { later = 0; ask(); }, TABLE_PERIOD);
  if (!fresh) return;
  controls.frame(frame);
  answer.frame(frame);
  alarm("frame", frame.notes);
  rate(now);
}

function drawViews(now) {
  const unit = controls.unit;
  for (const view of views) {
    view.draw(frame, answer.inclusions, inclusions, unit);
    const label = `${view.kind} view: ${view.words}`;
    if (view.label !== label) { view.label = label; view.canvas.setAttribute("aria-label", label); }
  }
  if (now - numbersAt >= TABLE_PERIOD) {
    numbersAt = now;
    taxels.draw(frame, unit);
  } else if (!later) {
    later = setTimeout(() => { later = 0; ask(); }, TABLE_PERIOD);
  }
  drawSpaceScale(unit);
}

// The longest bar of now, and the scale of colours and lengths, which is that of the whole history, so that frames compare.
function drawSpaceScale(unit) {
  const { name, factor: per } = forceUnit(unit, frame);
  const factor = unit === "kPa" ? 1e-3 / scene.area : per, end = factor * frame.scales[3];
  const words = `longest bar now ${readable(factor * frame.forces.reduce((a, b) => (b > a ? b : a), 0), 3)} ${name}`;
  if (get("space-words").textContent !== words) get("space-words").textContent = words;
  const canvas = get("space-ramp"), sharp = window.devicePixelRatio || 1, text = evenly(end, 3);
  const labels = ["0", `${text(end)} ${name}`], key = `${labels} ${sharp} ${getComputedStyle(document.body).color}`;
  if (canvas.dataset.key === key) return;
  Object.assign(canvas, { width: 120 * sharp, height: 24 * sharp });
  canvas.dataset.key = key;
  canvas.setAttribute("aria-label", `Colour and length of a bar, from 0 to ${text(end)} ${name}`);
  const pen = canvas.getContext("2d");
  pen.setTransform(sharp, 0, 0, sharp, 0, 0);
  pen.font = "11px system-ui, sans-serif"; pen.strokeStyle = getComputedStyle(document.documentElement).getPropertyValue("--quiet");
  drawRamp(pen, scene.colours, { left: 1, top: 1, width: 118, height: 8 }, labels);
}

// Drawn frames over the last second; the page counts, not the server.
function rate(now) {
  drawnTimes.push(now);
  document.documentElement.dataset.drawn = String(Number(document.documentElement.dataset.drawn || 0) + 1);
  while (drawnTimes[0] < now - 1000) drawnTimes.shift();
}

setInterval(() => {
  const now = performance.now();
  while (drawnTimes[0] < now - 1000) drawnTimes.shift();
  get("rate").textContent = drawnTimes.length > 1 ? `${drawnTimes.length} frames/s` : "";
}, 500);

const hasRegion = (one) => Object.keys(one.region).length > 0;

function legend() {
  if (!scene) return;
  const estimate = answer.inclusions;
  const key = JSON.stringify([inclusions.map((one) => one.name), estimate.length, estimate.some(hasRegion)]);
  if (get("legend").dataset.key === key) return;
  get("legend").dataset.key = key;
  const kinds = [["line", "var(--quiet)", "4 3", "undeformed block; taxels outlined; hatched: no taxel there, unknown"]];
  if (inclusions.length) kinds.push(["line", scene.true_colour, "5 3", `true: ${inclusions.map((one) => one.name).join(", ")}`]);
  if (estimate.length) kinds.push(["cross", scene.estimate_colour, "", estimate.length > 1 ? `${estimate.length} estimated places` : "estimated"]);
  if (estimate.some(hasRegion)) kinds.push(["line", scene.estimate_colour, "2 2", "its centre lies in here with 90 %"]);
  get("legend").replaceChildren(...kinds.map(([what, colour, dash, words]) => {
    const item = document.createElement("li"), svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
    const drawn = { d: what === "line" ? "M1 6h24" : "M6 6h14M13 0v12", stroke: colour, "stroke-width": "2", fill: "none" };
    for (const [name, value] of Object.entries(drawn)) path.setAttribute(name, value);
    if (dash) path.setAttribute("stroke-dasharray", dash);
    svg.append(path);
    item.append(svg, document.createTextNode(words));
    return item;
  }));
}

function connect() {
  const address = new URL("ws", location.href);
  address.protocol = address.protocol.replace("http", "ws");
  socket = new WebSocket(address);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => past();
  socket.onmessage = ({ data }) => {
    get("waiting").hidden = true;
    if (typeof data !== "string") return takeFrame(data);
    const message = JSON.parse(data);
    take[message.is]?.(message);
  };
  socket.onclose = () => {
    get("waiting").hidden = true;
    answer.lost();
    controls.lost();
    past();
    received = 0;
  };
}

for (const part of [...views, taxels]) part.onresize = () => { numbersAt = -Infinity; ask(); };
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const view of views) view.restyle();
  ask();
});
connect();
