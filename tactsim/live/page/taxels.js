// The numbers of every taxel in two tables.
import { readable } from "./wire.js";

const FEW = 6;

function cell(tag, words, scope) {
  const made = document.createElement(tag);
  made.textContent = words;
  if (scope) made.scope = scope;
  return made;
}

function tableOf(scene, jaw, cells) {
  const table = document.createElement("table");
  table.className = Math.max(scene.rows, scene.columns) > FEW ? "many" : "";
  if (table.className) table.style.width = `${46 + 29 * scene.columns}px`;
  table.append(cell("caption", jaw === 0 ? "Upper jaw (U)" : "Lower jaw (L)"));
  const head = document.createElement("tr");
  head.append(cell("td", ""));
  head.firstChild.style.border = "none";
  for (let column = 0; column < scene.columns; column++) head.append(cell("th", String(column + 1), "col"));
  table.append(head);
  for (let row = scene.rows - 1; row >= 0; row--) {
    const line = document.createElement("tr");
    line.append(cell("th", (scene.rows > FEW ? "" : "row ") + (row + 1), "row"));
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
  constructor(place, unitPlace) { this.place = place; this.unitPlace = unitPlace; this.cells = []; }

  setScene(scene) {
    this.scene = scene;
    this.cells = [];
    this.place.replaceChildren(tableOf(scene, 0, this.cells), tableOf(scene, 1, this.cells));
  }

  draw(frame, unit) {
    const factor = unit === "kPa" ? 1e-3 / this.scene.area : 1;
    const digits = Math.max(this.scene.rows, this.scene.columns) > FEW ? 2 : 4;
    const invalid = new Set(frame.invalid);
    this.unitPlace.textContent = unit === "kPa" ? "pressure in kPa" : "force in N";
    this.cells.forEach((made, k) => {
      const words = readable(factor * frame.forces[k], digits);
      if (made.textContent !== words) made.textContent = words;
      made.classList.toggle("bad", invalid.has(k));
    });
  }
}
