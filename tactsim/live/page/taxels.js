// Every taxel: few of them as numbers in two tables, many as two heat maps with the number under the pointer.
import { drawRamp, evenly, forceUnit } from "./wire.js";

const FEW = 6, HEAD = 16, FOOT = 26;           // px above a heat map for the numbers of columns, and below it for the colour scale
const HELP = "Seen from above: front row 1 at the bottom, column 1 at the left.";

function cell(tag, words, scope) {
  const made = document.createElement(tag);
  made.textContent = words;
  if (scope) made.scope = scope;
  return made;
}

function tableOf(scene, jaw, cells) {
  const table = document.createElement("table");
  table.append(cell("caption", jaw === 0 ? "Upper jaw (U)" : "Lower jaw (L)"));
  const head = document.createElement("tr");
  head.append(cell("td", ""));
  head.firstChild.style.border = "none";
  for (let column = 0; column < scene.columns; column++) head.append(cell("th", String(column + 1), "col"));
  table.append(head);
  for (let row = scene.rows - 1; row >= 0; row--) {
    const line = document.createElement("tr");
    line.append(cell("th", String(row + 1), "row"));
    for (let column = 0; column < scene.columns; column++) {
      const made = cell("td", "–");
      made.dataset.taxel = `${"UL"[jaw]}${row + 1},${column + 1}`;
      cells[(jaw * scene.rows + row) * scene.columns + column] = made;
      line.append(made);
    }
    table.append(line);
  }
  return table;
}

export class Taxels {
  constructor(place, unitPlace, wordsPlace) {
    Object.assign(this, { place, unitPlace, wordsPlace, cells: [], maps: [], at: null });
    new ResizeObserver(() => this.onresize?.()).observe(place);
  }

  setScene(scene) {
    this.scene = scene;
    Object.assign(this, { cells: [], maps: [], at: null });
    const large = Math.max(scene.rows, scene.columns) > FEW;
    this.place.className = large ? "heat" : "";
    this.wordsPlace.textContent = HELP;
    if (large) {
      this.maps = [0, 1].map((jaw) => this.#map(jaw));
      this.place.replaceChildren(...this.maps.map(({ figure }) => figure));
    } else {
      this.place.replaceChildren(tableOf(scene, 0, this.cells), tableOf(scene, 1, this.cells));
    }
  }

  #map(jaw) {
    const figure = document.createElement("figure"), canvas = document.createElement("canvas");
    figure.append(cell("figcaption", jaw === 0 ? "Upper jaw (U)" : "Lower jaw (L)"), canvas);
    Object.assign(canvas, { tabIndex: 0, role: "img" });
    canvas.dataset.jaw = jaw;
    canvas.setAttribute("aria-label", `${jaw === 0 ? "Upper" : "Lower"} jaw: heat map; the arrow keys read single taxels`);
    const map = { figure, canvas, jaw };
    canvas.addEventListener("pointermove", (event) => this.#point(map, event));
    canvas.addEventListener("pointerleave", () => this.#read(null));
    canvas.addEventListener("keydown", (event) => this.#step(map, event));
    return map;
  }

  #point(map, event) {
    const box = map.canvas.getBoundingClientRect(), { rows, columns } = this.scene, { left, top, side } = map.grid || {};
    const column = Math.floor((event.clientX - box.left - left) / side);
    const row = rows - 1 - Math.floor((event.clientY - box.top - top) / side);
    const inside = row >= 0 && row < rows && column >= 0 && column < columns;
    this.#read(inside ? { jaw: map.jaw, row, column } : null);
  }

  #step(map, event) {
    const move = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [1, 0], ArrowDown: [-1, 0] }[event.key];
    if (!move) return;
    const { rows, columns } = this.scene, at = this.at?.jaw === map.jaw ? this.at : { row: 0, column: -move[1] };
    const within = (value, count) => Math.min(count - 1, Math.max(0, value));
    this.#read({ jaw: map.jaw, row: within(at.row + move[0], rows), column: within(at.column + move[1], columns) });
    event.preventDefault(); event.stopPropagation();
  }

  #read(at) {
    this.at = at;
    if (this.frame) this.draw(this.frame, this.unit);
  }

  draw(frame, unit) {
    Object.assign(this, { frame, unit });
    const { name, factor: per } = forceUnit(unit, frame), invalid = new Set(frame.invalid);
    const factor = unit === "kPa" ? 1e-3 / this.scene.area : per;
    const words = evenly(factor * frame.scales[3], 4);
    this.unitPlace.textContent = unit === "kPa" ? "pressure in kPa" : `force in ${name}`;
    this.cells.forEach((made, k) => {
      const text = words(factor * frame.forces[k]);
      if (made.textContent !== text) made.textContent = text;
      made.classList.toggle("bad", invalid.has(k));
    });
    for (const map of this.maps) this.#drawMap(map, frame, invalid, factor);
    if (this.maps.length) this.wordsPlace.textContent = this.#words(frame, invalid, words, factor, name);
  }

  #words(frame, invalid, words, factor, unit) {
    if (!this.at) return `Point at a taxel for its number. ${HELP}`;
    const { jaw, row, column } = this.at, { rows, columns } = this.scene, k = (jaw * rows + row) * columns + column;
    const bad = invalid.has(k) ? " (dead or saturated)" : "";
    return `${"UL"[jaw]}${row + 1},${column + 1} (row ${row + 1}, column ${column + 1}): ${words(factor * frame.forces[k])} ${unit}${bad}`;
  }

  #drawMap(map, frame, invalid, factor) {
    const { canvas, jaw } = map, { rows, columns, colours } = this.scene, sharp = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (width < 20 || height < HEAD + FOOT + 20) return;
    if (canvas.width !== Math.round(width * sharp) || canvas.height !== Math.round(height * sharp)) {
      canvas.width = Math.round(width * sharp); canvas.height = Math.round(height * sharp);
    }
    const pen = canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.clearRect(0, 0, width, height);
    const side = Math.min((width - 20) / columns, (height - HEAD - FOOT) / rows), left = 20, top = HEAD;
    map.grid = { left, top, side };
    const end = frame.scales[3] || 1;
    pen.fillStyle = pen.strokeStyle = style.getPropertyValue("--quiet"); pen.font = "10px system-ui, sans-serif";
    const numbered = (count) => [0, Math.floor(count / 2), count - 1];
    pen.textAlign = "center"; pen.textBaseline = "alphabetic";
    for (const column of numbered(columns)) {
      pen.textAlign = column === columns - 1 ? "right" : "center";
      pen.fillText(String(column + 1), left + side * (column + (column === columns - 1 ? 1 : 0.5)), top - 4);
    }
    pen.textAlign = "right"; pen.textBaseline = "middle";
    for (const row of numbered(rows)) pen.fillText(String(row + 1), left - 4, top + side * (rows - row - 0.5));
    for (let row = 0; row < rows; row++) for (let column = 0; column < columns; column++) {
      const k = (jaw * rows + row) * columns + column, share = Math.min(1, Math.max(0, frame.forces[k] / end));
      const at = 3 * Math.round(255 * (share || 0)), x = left + side * column, y = top + side * (rows - 1 - row);
      pen.fillStyle = `rgb(${colours[at]},${colours[at + 1]},${colours[at + 2]})`;
      pen.fillRect(x, y, side + 0.5, side + 0.5);
      if (invalid.has(k)) this.#cross(pen, x, y, side);
    }
    if (this.at?.jaw === jaw) {
      const x = left + side * this.at.column, y = top + side * (rows - 1 - this.at.row);
      for (const [colour, line] of [["#ffffff", 3], ["#000000", 1.2]]) {
        pen.strokeStyle = colour; pen.lineWidth = line; pen.strokeRect(x, y, side, side);
      }
    }
    pen.strokeStyle = style.getPropertyValue("--quiet");
    const words = evenly(factor * end, 2), bar = { left, top: top + side * rows + 5, width: Math.round(side * columns), height: 7 };
    drawRamp(pen, colours, bar, [0, 0.5, 1].map((share) => words(share * factor * end)));
  }

  #cross(pen, x, y, side) {
    for (const [colour, line] of [["#ffffff", 3], ["#b3261e", 1.4]]) {
      pen.strokeStyle = colour; pen.lineWidth = line; pen.beginPath();
      pen.moveTo(x, y); pen.lineTo(x + side, y + side); pen.moveTo(x + side, y); pen.lineTo(x, y + side);
      pen.stroke();
    }
  }
}
