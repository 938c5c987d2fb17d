// The page: what the server sends goes to the views, what the user does goes to the server. All words go in as text, never HTML.
import { Controls } from "./controls.js";
import { Taxels } from "./taxels.js";
import { View } from "./views.js";
import { readFrame, readable } from "./wire.js";

const get = (id) => document.getElementById(id);
const views = ["front", "left", "top"].map((kind) => new View(get(kind), kind));
const taxels = new Taxels(get("tables"), get("taxel-unit"));
const alerts = {};
let scene = null, frame = null, waiting = null, received = 0, estimate = [], inclusions = [], space = null, drawnTimes = [];
let socket = null;

const send = (command) => {
  if (command.do !== "drawn") alarm("command", []);      // what was wrong with the last command has been read
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(command));
};
const controls = new Controls(send, () => ask(), (way) => space?.turn(way));
const TABLE_PERIOD = 100;                 // ms between two numbers in a cell: faster ones cannot be read
let asked = false, later = 0, numbersAt = -Infinity;

import("./space.js").then(({ Space }) => {
  space = new Space(get("space-canvas"));
  if (scene) { space.setScene(scene); space.setInclusions(inclusions); space.setEstimate(estimate); }
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
    scene = message; frame = null; waiting = null; estimate = []; inclusions = [];
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
  },
  shapes(message) { inclusions = message.inclusions; space?.setInclusions(inclusions); legend(); ask(); },
  estimate(message) {
    const marked = estimate.some(hasRegion), place = get("estimate");
    if (message.busy) return place.replaceChildren(paragraph("computing …", "quiet"));
    estimate = message.inclusions;
    const lines = [...message.words.map((words) => paragraph(words)), ...message.errors.map((words) => paragraph(words, "errors"))];
    if (message.fault) lines.push(paragraph(message.fault, "fault"));
    const words = lines.map((line) => line.textContent).join("\n");
    if (place.dataset.words !== words || place.textContent === "computing …") place.replaceChildren(...lines);
    place.dataset.words = words;
    alarm("estimate", [message.fault]);
    space?.setEstimate(estimate);
    if (marked !== estimate.some(hasRegion)) legend();
    ask();
  },
  feed(message) {
    get("source-line").textContent = `${message.name}: ${message.state}, ${message.frames} frames, ${message.malformed} malformed`;
    alarm("feed", message.malformed ? [`${message.malformed} malformed in the stream, the last one: ${message.fault}`] : []);
  },
  fault(message) { alarm("command", [message.words]); },
};

function clear() {
  taxels.place.replaceChildren();
  get("estimate").replaceChildren();
  frame = waiting = null; estimate = []; inclusions = [];
  space?.setInclusions([]);
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
  alarm("frame", frame.notes);
  rate(now);
}

function drawViews(now) {
  const unit = controls.unit;
  for (const view of views) {
    view.draw(frame, estimate, inclusions, unit);
    const label = `${view.kind} view: ${view.words}`;
    if (view.label !== label) { view.label = label; view.canvas.setAttribute("aria-label", label); }
  }
  if (now - numbersAt >= TABLE_PERIOD) {
    numbersAt = now;
    taxels.draw(frame, unit);
  } else if (!later) {
    later = setTimeout(() => { later = 0; ask(); }, TABLE_PERIOD);
  }
  const most = frame.scales[3] * (unit === "kPa" ? 1e-3 / scene.area : 1);
  const words = `longest bar: ${readable(most, 3)} ${unit}`;
  if (get("space-words").textContent !== words) get("space-words").textContent = words;
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
  const kinds = [["line", "var(--quiet)", "4 3", "undeformed block; taxels outlined"]];
  if (inclusions.length) kinds.push(["line", scene.true_colour, "5 3", `true: ${inclusions.map((one) => one.name).join(", ")}`]);
  kinds.push(["cross", scene.estimate_colour, "", "estimated"]);
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
  socket.onopen = () => alarm("connection", []);
  socket.onmessage = ({ data }) => {
    if (typeof data !== "string") return takeFrame(data);
    const message = JSON.parse(data);
    take[message.is]?.(message);
  };
  socket.onclose = () => {
    alarm("connection", ["The server has ended or cannot be reached; what is shown stays. Start tactsim show again."]);
    received = 0;
  };
}

for (const view of views) view.onresize = ask;
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const view of views) view.restyle();
  ask();
});
connect();
