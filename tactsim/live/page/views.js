// Front, left and top view: the picture in colour, block, jaws with the sums of their taxels, true and estimated inclusions.
import { evenly, forceUnit, readable, ticks } from "./wire.js";

const JAW = 1.2, ROOM = 1.0, USUAL = 40;      // thickness of a drawn jaw and room around, in mm for a block whose longest side is USUAL
const MARGIN = { left: 40, right: 10, top: 4, bottom: 64 };      // in px, for ticks and the colour scale
const AXES = { front: [0, 2], left: [1, 2], top: [0, 1] };
const NAMES = ["x", "y", "z"];
const MOST_OUTLINED = 8;
const TICK = { across: 42, up: 22 };           // least distance of ticks in px
const LABEL = 28;                              // half the length of the name of an axis in px

export class View {
  constructor(section, kind) {
    this.canvas = section.querySelector("canvas");
    this.kind = kind;
    [this.across, this.up] = AXES[kind];
    this.picture = document.createElement("canvas");
    this.ramp = document.createElement("canvas");
    this.box = { width: 0, height: 0 };
    new ResizeObserver(() => { this.box = this.canvas.getBoundingClientRect(); this.onresize?.(); }).observe(this.canvas);
    this.restyle();
  }

  // Colours of the page, read again when it turns light or dark.
  restyle() {
    const style = getComputedStyle(document.documentElement);
    this.ink = style.getPropertyValue("--ink");
    this.quiet = style.getPropertyValue("--quiet");
  }

  setScene(scene) {
    this.scene = scene;
    [this.picture.height, this.picture.width] = scene.shape;
    this.pixels = this.picture.getContext("2d").createImageData(scene.shape[1], scene.shape[0]);
    this.#setRamp(scene.colours);
    this.key = "";
    const across = this.#reach(this.across, scene.shape[1]), up = this.#reach(this.up, scene.shape[0]);
    this.extent = [across[0], across[3], up[0], up[3]];
    const unit = Math.max(...scene.size) / USUAL, room = ROOM * unit;
    this.jaw = JAW * unit;
    const thick = this.up === 2 ? this.jaw : 0;
    this.low = [Math.min(0, this.extent[0]) - room, Math.min(0, this.extent[2]) - thick - room];
    this.high = [Math.max(scene.size[this.across], this.extent[1]) + room,
      Math.max(scene.size[this.up], this.extent[3]) + thick + room];
  }

  #setRamp(colours) {
    [this.ramp.width, this.ramp.height] = [256, 1];
    const pen = this.ramp.getContext("2d"), data = pen.createImageData(256, 1);
    for (let k = 0; k < 256; k++) data.data.set([...colours.slice(3 * k, 3 * k + 3), 255], 4 * k);
    pen.putImageData(data, 0, 0);
  }

  // Begin, first and last pixel's middle and end in mm along an axis of the picture: the outer taxels reach beyond their centres.
  #reach(axis, count) {
    const [first, last] = this.#sides(axis, count);
    if (axis === 2) return [first, first, last, last];
    const borders = this.#borders(axis);
    return [Math.min(borders[0][0], first), first, last, Math.max(borders.at(-1)[1], last)];
  }

  // The outermost pixels stand at the centres of the outermost taxels; between the jaws the picture fills the height.
  #sides(axis, count) {
    if (axis === 2) return [0, this.scene.size[2]];
    const borders = this.#borders(axis), middles = borders.map(([a, b]) => (a + b) / 2);
    if (middles.length === 1) return borders[0];
    const half = (middles.at(-1) - middles[0]) / (count - 1) / 2;
    return [middles[0] - half, middles.at(-1) + half];
  }

  #borders(axis) {
    const flat = axis === 0 ? this.scene.x : this.scene.y;
    return Array.from({ length: flat.length / 2 }, (_, k) => [flat[2 * k], flat[2 * k + 1]]);
  }

  draw(frame, estimate, inclusions, unit) {
    const box = this.box, sharp = window.devicePixelRatio || 1;
    if (!this.scene || box.width < 20 || box.height < 80) return;
    const wide = Math.round(box.width * sharp), high = Math.round(box.height * sharp);
    if (this.canvas.width !== wide || this.canvas.height !== high) { this.canvas.width = wide; this.canvas.height = high; }
    const pen = this.canvas.getContext("2d");
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.clearRect(0, 0, box.width, box.height);
    this.#place(box);
    this.#drawPicture(pen, frame);
    this.#drawBlock(pen);
    this.up === 2 ? this.#drawJaws(pen, frame) : this.#drawTaxels(pen, frame);
    this.#drawOutlines(pen, inclusions);
    for (const one of estimate) this.#drawEstimate(pen, one);
    this.#drawTicks(pen, box);
    this.#drawScale(pen, box, frame, unit);
  }

  #place(box) {
    const room = [box.width - MARGIN.left - MARGIN.right, box.height - MARGIN.top - MARGIN.bottom];
    const span = [this.high[0] - this.low[0], this.high[1] - this.low[1]];
    this.scale = Math.min(room[0] / span[0], room[1] / span[1]);
    const [beside, above] = [0, 1].map((k) => (room[k] - this.scale * span[k]) / 2);
    this.origin = [MARGIN.left + beside, MARGIN.top + above + this.scale * span[1]];
    const key = [this.scale, ...this.origin].join(" ");
    this.canvas.dataset.scale = this.scale;
    if (key !== this.key) { this.key = key; this.taxelPath = this.outlinePath = null; }
  }

  // From mm to px; the left view is seen from the left, so its y runs to the left.
  #at(a, b) {
    const along = this.kind === "left" ? this.high[0] - a : a - this.low[0];
    return [this.origin[0] + this.scale * along, this.origin[1] - this.scale * (b - this.low[1])];
  }

  #rect(pen, a0, a1, b0, b1, how) {
    const [x0, y0] = this.#at(a0, b0), [x1, y1] = this.#at(a1, b1);
    pen[how](Math.min(x0, x1), Math.min(y0, y1), Math.abs(x1 - x0), Math.abs(y1 - y0));
  }

  colour(level) {
    const k = 3 * Math.max(0, Math.min(255, Math.round(255 * level))), table = this.scene.colours;
    return `rgb(${table[k]},${table[k + 1]},${table[k + 2]})`;
  }

  #drawPicture(pen, frame) {
    const levels = frame.pictures[this.kind], data = this.pixels.data, table = this.scene.colours;
    for (let k = 0; k < levels.length; k++) {
      data[4 * k] = table[3 * levels[k]]; data[4 * k + 1] = table[3 * levels[k] + 1];
      data[4 * k + 2] = table[3 * levels[k] + 2]; data[4 * k + 3] = 255;
    }
    this.picture.getContext("2d").putImageData(this.pixels, 0, 0);
    this.#hatchUnknown(pen);
    if (!frame.meaning) return;
    pen.imageSmoothingEnabled = false;
    const [height, width] = this.scene.shape, across = this.#reach(this.across, width), up = this.#reach(this.up, height);
    // Over the outer halves of the outer taxels the picture goes on as at their centres: source and length in it, from and to in mm.
    const parts = (reach, count) => [[0, 1, reach[0], reach[1]], [0, count, reach[1], reach[2]], [count - 1, 1, reach[2], reach[3]]];
    for (const [u, du, a0, a1] of parts(across, width)) for (const [v, dv, b0, b1] of parts(up, height)) {
      if (a1 - a0 < 1e-9 || b1 - b0 < 1e-9) continue;
      const [x0, y0] = this.#at(a0, b1), [x1, y1] = this.#at(a1, b0);
      const from = this.kind === "left" ? width - u - du : u;
      pen.drawImage(this.picture, from, height - v - dv, du, dv, Math.min(x0, x1), y0, Math.abs(x1 - x0) + 0.4, y1 - y0 + 0.4);
    }
  }

  // Where no taxel reads, the block is hatched; without usable readings all of it is, for no colour would be true.
  #hatchUnknown(pen) {
    const [x0, y0] = this.#at(0, this.scene.size[this.up]), [x1, y1] = this.#at(this.scene.size[this.across], 0);
    const left = Math.min(x0, x1), right = Math.max(x0, x1);
    pen.save();
    pen.beginPath(); pen.rect(left, y0, right - left, y1 - y0); pen.clip();
    pen.fillStyle = this.quiet; pen.globalAlpha = 0.16; pen.fillRect(left, y0, right - left, y1 - y0);
    pen.globalAlpha = 0.55; pen.strokeStyle = this.quiet; pen.lineWidth = 0.8; pen.beginPath();
    for (let x = left - (y1 - y0); x < right; x += 6) { pen.moveTo(x, y1); pen.lineTo(x + y1 - y0, y0); }
    pen.stroke();
    pen.restore();
  }

  #drawBlock(pen) {
    pen.strokeStyle = this.quiet; pen.lineWidth = 1; pen.setLineDash([4, 3]);
    this.#rect(pen, 0, this.scene.size[this.across], 0, this.scene.size[this.up], "strokeRect");
    pen.setLineDash([]);
  }

  #drawTaxels(pen, frame) {
    const { rows, columns } = this.scene, x = this.#borders(0), y = this.#borders(1);
    if (!this.taxelPath) {
      this.taxelPath = new Path2D();
      for (const across of x) for (const along of y) this.#rect(this.taxelPath, ...across, ...along, "rect");
    }
    const many = Math.max(rows, columns) > MOST_OUTLINED;      // the outlines of many would hide the map
    for (const [colour, width] of many ? [["#30363d50", 0.5]] : [["#ffffffb0", 1.6], ["#30363d", 0.6]]) {
      pen.strokeStyle = colour; pen.lineWidth = width;
      pen.stroke(this.taxelPath);
    }
    for (const taxel of frame.invalid) {
      const place = taxel % (rows * columns);
      this.#cross(pen, ...x[place % columns], ...y[Math.floor(place / columns)]);
    }
  }

  #drawJaws(pen, frame) {
    const { rows, columns, size } = this.scene, invalid = new Set(frame.invalid);
    const end = frame.scales[this.kind === "front" ? 0 : 1] || 1;
    for (let jaw = 0; jaw < 2; jaw++) this.#borders(this.across).forEach(([a0, a1], k) => {
      let sum = 0, bad = false;
      for (let other = 0; other < (this.across === 0 ? rows : columns); other++) {
        const taxel = this.across === 0 ? (jaw * rows + other) * columns + k : (jaw * rows + k) * columns + other;
        sum += frame.forces[taxel] || 0;
        bad ||= invalid.has(taxel);
      }
      const [b0, b1] = jaw === 0 ? [size[2], size[2] + this.jaw] : [-this.jaw, 0];
      pen.fillStyle = frame.meaning === "force" ? this.colour(sum / end) : "#8b949e";
      this.#rect(pen, a0, a1, b0, b1, "fillRect");
      pen.strokeStyle = this.quiet; pen.lineWidth = 0.7;
      this.#rect(pen, a0, a1, b0, b1, "strokeRect");
      if (bad) this.#cross(pen, a0, a1, b0, b1);
    });
  }

  #cross(pen, a0, a1, b0, b1) {
    for (const [colour, width] of [["#ffffff", 3], ["#b3261e", 1.4]]) {
      pen.strokeStyle = colour; pen.lineWidth = width; pen.beginPath();
      pen.moveTo(...this.#at(a0, b0)); pen.lineTo(...this.#at(a1, b1)); pen.moveTo(...this.#at(a0, b1)); pen.lineTo(...this.#at(a1, b0));
      pen.stroke();
    }
  }

  #drawOutlines(pen, inclusions) {
    if (!this.outlinePath || this.outlined !== inclusions) {
      this.outlined = inclusions;
      this.outlinePath = new Path2D();
      for (const line of inclusions.flatMap((one) => one.outlines[this.kind] || [])) this.#trace(this.outlinePath, line);
    }
    for (const [colour, width, dash] of [["#ffffff", 3, []], [this.scene.true_colour, 1.8, [5, 3]]]) {
      pen.strokeStyle = colour; pen.lineWidth = width; pen.setLineDash(dash);
      pen.stroke(this.outlinePath);
    }
    pen.setLineDash([]);
  }

  #drawEstimate(pen, one) {
    const [x, y] = this.#at(one.center[this.across], one.center[this.up]), arm = 8;
    for (const [colour, width] of [["#ffffff", 4], [this.scene.estimate_colour, 2]]) {
      pen.strokeStyle = colour; pen.lineWidth = width; pen.beginPath();
      pen.moveTo(x - arm, y); pen.lineTo(x + arm, y); pen.moveTo(x, y - arm); pen.lineTo(x, y + arm);
      if (one.line) this.#traceTube(pen, one);
      else if (one.radius) this.#traceCircle(pen, x, y, this.scale * one.radius);
      pen.stroke();
    }
    for (const [colour, width, dash] of [["#ffffff", 2.6, []], [this.scene.estimate_colour, 1.3, [2, 2]]]) {
      pen.strokeStyle = colour; pen.lineWidth = width; pen.setLineDash(dash); pen.beginPath();
      for (const line of one.region[this.kind] || []) this.#trace(pen, line);
      pen.stroke();
    }
    pen.setLineDash([]);
  }

  #traceCircle(pen, x, y, radius) { pen.moveTo(x + radius, y); pen.arc(x, y, radius, 0, 2 * Math.PI); }

  // Both sides of a straight tube, or its circle where the view looks along it.
  #traceTube(pen, one) {
    const ends = one.line.map((end) => this.#at(end[this.across], end[this.up])), radius = this.scale * one.radius;
    const [[x0, y0], [x1, y1]] = ends, long = Math.hypot(x1 - x0, y1 - y0);
    if (long < radius / 10) return this.#traceCircle(pen, x0, y0, radius);
    const aside = [(-(y1 - y0) * radius) / long, ((x1 - x0) * radius) / long];
    for (const side of [-1, 1]) {
      pen.moveTo(x0 + side * aside[0], y0 + side * aside[1]);
      pen.lineTo(x1 + side * aside[0], y1 + side * aside[1]);
    }
  }

  #trace(path, line) {
    path.moveTo(...this.#at(line[0], line[1]));
    for (let k = 2; k < line.length; k += 2) path.lineTo(...this.#at(line[k], line[k + 1]));
  }

  #drawTicks(pen, box) {
    pen.fillStyle = this.quiet; pen.font = "11px system-ui, sans-serif"; pen.textBaseline = "top"; pen.textAlign = "center";
    const bottom = this.origin[1], size = this.scene.size;
    for (const [a, words] of ticks(size[this.across], this.scale, TICK.across)) pen.fillText(words, this.#at(a, 0)[0], bottom + 2);
    pen.textAlign = "right"; pen.textBaseline = "middle";
    const edge = Math.min(this.#at(this.low[0], 0)[0], this.#at(this.high[0], 0)[0]);
    let beside = 0;
    for (const [b, words] of ticks(size[this.up], this.scale, TICK.up)) {
      pen.fillText(words, edge - 2, this.#at(0, b)[1]);
      beside = Math.max(beside, pen.measureText(words).width);
    }
    pen.textAlign = "center"; pen.textBaseline = "top";
    pen.fillText(`${NAMES[this.across]} in mm`, this.origin[0] + this.scale * (this.high[0] - this.low[0]) / 2, bottom + 15);
    pen.save();
    pen.translate(edge - Math.max(30, beside + 13), Math.max(LABEL, this.#at(0, size[this.up] / 2)[1])); pen.rotate(-Math.PI / 2);
    pen.fillText(`${NAMES[this.up]} in mm`, 0, -4);
    pen.restore();
  }

  #drawScale(pen, box, frame, unit) {
    if (!frame.meaning) { this.words = "unknown, see the estimate"; return; }
    const k = { front: 0, left: 1, top: 2 }[this.kind], summed = [this.scene.rows, this.scene.columns, 2][k];
    const end = frame.scales[k] * (unit === "kPa" ? 1e-3 / (this.scene.area * summed) : 1);
    const { name, factor } = forceUnit(unit, frame);
    const meaning = unit === "kPa" ? frame.meaning.replace("force", "mean pressure") : frame.meaning;
    const width = Math.min(180, Math.max(60, 0.42 * box.width)), left = MARGIN.left, y = box.height - 26;
    pen.imageSmoothingEnabled = true;
    pen.drawImage(this.ramp, left, y, width, 9);
    pen.strokeStyle = this.quiet; pen.lineWidth = 0.6; pen.strokeRect(left, y, width, 9);
    pen.fillStyle = this.quiet; pen.textBaseline = "top"; pen.font = "11px system-ui, sans-serif";
    const words = evenly(factor * end, 3);
    [0, 0.5, 1].forEach((share) => {
      pen.textAlign = share === 0 ? "left" : share === 1 ? "right" : "center";
      pen.fillText(words(factor * share * end), left + share * width, y + 11);
    });
    pen.textAlign = "left"; pen.textBaseline = "middle"; pen.fillStyle = this.ink;
    const [caption, room] = [`${meaning} in ${name}`, Math.max(40, box.width - left - width - 20)];
    const half = caption.lastIndexOf(" ", caption.length * 0.6), fits = pen.measureText(caption).width <= room;
    const lines = fits ? [caption] : [caption.slice(0, half), caption.slice(half + 1)];
    lines.forEach((line, n) => pen.fillText(line, left + width + 14, y + 5 + (lines.length - 1) * (14 * n - 4), room));
    this.words = `${meaning}, scale to ${readable(factor * end, 3)} ${name}`;
  }
}
