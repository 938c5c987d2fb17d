// The view in space: block, two jaws with a bar for every taxel, true inclusions translucent, estimated ones as wire frames.
import * as THREE from "./vendor/three/three.module.min.js";
import { OrbitControls } from "./vendor/three/OrbitControls.js";

const PLATE = 0.06, BAR = 0.55, LEAST_BAR = 0.01;        // over the height of the block, as in the stored pictures
const FROM = [0.55, -1.0, 0.5];                          // from the block to the eye
const TURN = Math.PI / 12;
const AWAY = { front: 1, left: 0, top: 2 };            // axis along which each view looks
const SLOW = 24;                                         // ms after drawing until the browser draws again, from which it is slow

export class Space {
  constructor(canvas, labels) {
    Object.assign(this, { canvas, labels, marks: [] });
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.world = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(30, 1, 1, 5000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.ask());
    this.light = new THREE.DirectionalLight(0xffffff, 1.6);
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 2.2), this.light);
    this.fixed = new THREE.Group(); this.bodies = new THREE.Group(); this.estimated = new THREE.Group();
    this.world.add(this.fixed, this.bodies, this.estimated);
    new ResizeObserver(() => this.ask()).observe(canvas);
  }

  setScene(scene) {
    const same = this.scene && String(this.scene.size) === String(scene.size);
    this.scene = scene;
    for (const group of [this.fixed, this.bodies, this.estimated]) empty(group);
    const [x, y, z] = scene.size, box = new THREE.BoxGeometry(x, y, z);
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(box), new THREE.LineBasicMaterial({ color: 0x8b949e }));
    const tissue = new THREE.Mesh(box, glass("#f0b8a0", 0.16));
    for (const part of [edges, tissue]) { part.position.set(x / 2, y / 2, z / 2); this.fixed.add(part); }
    this.jaws = scene.jaws.map((jaw) => this.#jaw(jaw));
    this.#drawAxes();
    if (!same) this.reset();
    this.ask();
  }

  // Arrows along x and z from the front left and along y from the front right, beside the jaws, and where the front is.
  #drawAxes() {
    const { size, jaws } = this.scene, reach = 0.1 * Math.max(...size), colour = 0x6e7681;
    const [wide, deep] = ["width", "depth"].map((side, k) => Math.max(size[k], ...jaws.map((jaw) => jaw[side])));
    const [left, right] = [-1, 1].map((side) => size[0] / 2 + side * (wide / 2 + reach / 2)), front = size[1] / 2 - deep / 2 - reach / 2;
    this.marks = [];
    [[0, [left, front, 0]], [1, [right, front, 0]], [2, [left, front, 0]]].forEach(([axis, corner]) => {
      const from = new THREE.Vector3(...corner), along = new THREE.Vector3();
      along.setComponent(axis, 1);
      if (axis < 2) from.setComponent(axis, 0);
      this.fixed.add(new THREE.ArrowHelper(along, from, size[axis] + reach / 2, colour, 0.5 * reach, 0.25 * reach));
      const at = from.clone().addScaledVector(along, size[axis] + (axis < 2 ? 0.6 : 1.2) * reach);
      if (axis < 2) at.addScaledVector(new THREE.Vector3(axis, axis - 1, 0), 1.3 * reach);       // off the jaws, to the right or the front
      this.marks.push({ at, words: `${"xyz"[axis]}, ${size[axis]} mm` });
    });
    const tip = front - 1.6 * reach, middle = size[0] / 2;
    const shape = new THREE.BufferGeometry();
    const points = [middle - reach, front - 0.5 * reach, 0, middle + reach, front - 0.5 * reach, 0, middle, tip, 0];
    shape.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
    this.fixed.add(new THREE.Mesh(shape, new THREE.MeshBasicMaterial({ color: colour, side: THREE.DoubleSide })));
    this.marks.push({ at: new THREE.Vector3(middle, tip - reach, 0), words: "front", kind: "front" });
    this.labels.replaceChildren(...this.marks.map((mark) => {
      mark.place = document.createElement("span");
      mark.place.textContent = mark.words;
      mark.place.className = mark.kind || "";
      return mark.place;
    }));
  }

  // The labels stay whole: on a narrow screen those at the sides, and those below jaws that are narrower than the block. One that
  // would stand on an earlier one goes to the nearest place above or below one where there is room.
  #placeLabels() {
    const { clientWidth: wide, clientHeight: high } = this.labels;
    const within = (at, half, room) => Math.max(half, Math.min(room - half, (room / 2) * (at + 1))), placed = [];
    for (const { at, place } of this.marks) {
      const seen = at.clone().project(this.camera), [across, tall] = [place.offsetWidth, place.offsetHeight];
      const x = within(seen.x, across / 2, wide);
      const wanted = within(-seen.y, tall / 2, high), beside = placed.filter((one) => Math.abs(one.x - x) < (one.across + across) / 2);
      const isFree = (y) => y >= tall / 2 && y <= high - tall / 2 && beside.every((one) => Math.abs(one.y - y) >= tall);
      const free = beside.flatMap((one) => [one.y + tall + 1, one.y - tall - 1]).filter(isFree);
      const y = isFree(wanted) ? wanted : free.sort((a, b) => Math.abs(a - wanted) - Math.abs(b - wanted))[0] ?? wanted;
      placed.push({ x, y, across });
      place.style.left = `${x.toFixed(1)}px`;
      place.style.top = `${y.toFixed(1)}px`;
    }
  }

  #jaw(jaw) {
    const height = this.scene.size[2], group = new THREE.Group(), plate = PLATE * height;
    const body = new THREE.BoxGeometry(jaw.width, jaw.depth, plate);
    const made = new THREE.Mesh(body, glass("#aab1ba", 0.32));
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(body), new THREE.LineBasicMaterial({ color: 0x8b949e }));
    for (const part of [made, edges]) { part.position.z = plate / 2; group.add(part); }
    const bar = new THREE.BoxGeometry(1, 1, 1);
    bar.translate(0, 0, 0.5);
    const bars = new THREE.InstancedMesh(shaded(bar), new THREE.MeshBasicMaterial({ vertexColors: true }), this.scene.rows * this.scene.columns);
    bars.frustumCulled = false;
    group.add(bars);
    group.matrixAutoUpdate = false;
    this.fixed.add(group);
    return { group, bars, rotation: jaw.rotation, base: plate };
  }

  // No forces are known: the block and its jaws stay, and what was measured and estimated goes.
  clear() {
    if (!this.scene) return;
    for (const jaw of this.jaws) jaw.bars.visible = false;
    this.setInclusions([]);
    this.setEstimate([]);
  }

  setInclusions(inclusions) {
    if (!this.scene) return;
    empty(this.bodies);
    for (const one of inclusions) {
      if (!one.points.length) continue;
      const shape = new THREE.BufferGeometry();
      shape.setAttribute("position", new THREE.Float32BufferAttribute(one.points, 3));
      shape.setIndex(one.triangles);
      shape.computeVertexNormals();
      const look = { color: this.scene.true_colour, opacity: 0.55, transparent: true, depthWrite: false };
      const body = new THREE.Mesh(shape, new THREE.MeshLambertMaterial(look));
      body.renderOrder = 1;
      this.bodies.add(body);
    }
    this.ask();
  }

  // The outlines of the region of 90 % in the three views, each in the plane through the estimated centre.
  #region(one) {
    const dashes = new THREE.LineDashedMaterial({ color: this.scene.estimate_colour, depthTest: false, dashSize: 0.8, gapSize: 0.5 });
    return Object.entries(AWAY).flatMap(([view, away]) => (one.region[view] || []).map((flat) => {
      const points = [];
      for (let k = 0; k < flat.length; k += 2) {
        const point = [flat[k], flat[k + 1]];
        point.splice(away, 0, one.center[away]);
        points.push(new THREE.Vector3(...point));
      }
      const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), dashes);
      line.computeLineDistances();
      line.renderOrder = 3;
      return line;
    }));
  }

  setEstimate(inclusions) {
    if (!this.scene) return;
    empty(this.estimated);
    const lines = new THREE.LineBasicMaterial({ color: this.scene.estimate_colour, depthTest: false });
    for (const one of inclusions) {
      const group = new THREE.Group(), arm = one.radius || this.scene.pitch / 3;
      const ends = [[arm, 0, 0], [0, arm, 0], [0, 0, arm]].flatMap((end) => [...end.map((v) => -v), ...end]);
      const cross = new THREE.BufferGeometry();
      cross.setAttribute("position", new THREE.Float32BufferAttribute(ends, 3));
      group.add(new THREE.LineSegments(cross, lines));
      if (one.line) group.add(tube(one, lines));
      else if (one.radius) {
        const ball = new THREE.WireframeGeometry(new THREE.SphereGeometry(one.radius, 14, 9));
        group.add(new THREE.LineSegments(ball, lines));
      }
      group.position.set(...one.center);
      group.renderOrder = 3;
      this.estimated.add(group, ...this.#region(one));
    }
    this.ask();
  }

  setFrame(frame) {
    if (!this.scene) return;
    const { rows, columns, taxel, pitch, size, colours } = this.scene, end = frame.scales[3] || 1;
    const place = new THREE.Matrix4(), colour = new THREE.Color();
    this.jaws.forEach((jaw, side) => {
      jaw.bars.visible = true;
      const basis = jaw.rotation, at = frame.places[side];
      jaw.group.matrix.fromArray([...basis.slice(0, 3), 0, ...basis.slice(3, 6), 0, ...basis.slice(6, 9), 0, ...at, 1]);
      jaw.group.matrixWorldNeedsUpdate = true;
      for (let k = 0; k < rows * columns; k++) {
        const share = Math.min(1, Math.max(0, frame.forces[side * rows * columns + k] || 0) / end);
        const row = Math.floor(k / columns), column = k % columns, level = 3 * Math.round(255 * share);
        place.makeScale(taxel, taxel, size[2] * Math.max(LEAST_BAR, BAR * share));
        place.setPosition(pitch * (column - (columns - 1) / 2), pitch * (row - (rows - 1) / 2), jaw.base);
        jaw.bars.setMatrixAt(k, place);
        colour.setRGB(colours[level] / 255, colours[level + 1] / 255, colours[level + 2] / 255, THREE.SRGBColorSpace);
        jaw.bars.setColorAt(k, colour);
      }
      jaw.bars.instanceMatrix.needsUpdate = true;
      jaw.bars.instanceColor.needsUpdate = true;
    });
    this.asked = true;
  }

  turn(way) {
    if (!this.scene) return;
    if (way === "reset") return this.reset();
    const from = this.camera.position.clone().sub(this.controls.target);
    if (way === "left" || way === "right") from.applyAxisAngle(new THREE.Vector3(0, 0, 1), way === "left" ? -TURN : TURN);
    const side = new THREE.Vector3().crossVectors(this.camera.up, from).normalize();
    const lean = Math.asin(from.z / from.length()) + (way === "up" ? TURN : way === "down" ? -TURN : 0);
    if ((way === "up" || way === "down") && Math.abs(lean) < 1.5) from.applyAxisAngle(side, way === "up" ? -TURN : TURN);
    this.camera.position.copy(this.controls.target).add(from);
    this.controls.update();
    this.ask();
  }

  reset() {
    const [x, y, z] = this.scene.size, middle = new THREE.Vector3(x / 2, y / 2, z / 2);
    const wide = Math.max(...this.scene.jaws.map((jaw) => Math.hypot(jaw.width, jaw.depth)), Math.hypot(x, y));
    const bars = z * (0.5 + PLATE + BAR), reach = Math.hypot(wide / 2, bars), width = this.canvas.clientWidth || 4;
    const narrow = Math.min(1, width / Math.max(1, this.canvas.clientHeight));
    const eye = new THREE.Vector3(...FROM).normalize();
    const high = Math.hypot(eye.x, eye.y) * bars + eye.z * wide / 2;      // half the height of what is seen, larger than its reach if tall
    const away = Math.max(0.8 * reach, 0.97 * high) / Math.sin(THREE.MathUtils.degToRad(15)) / narrow;
    this.camera.position.copy(middle).addScaledVector(eye, away);
    this.camera.near = away / 50; this.camera.far = 10 * away;
    this.controls.target.copy(middle);
    this.controls.update();
    this.ask();
  }

  // Draws once at the next chance, however often it is asked.
  ask() {
    this.asked = true;
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.draw(); });
  }

  // Draws what was asked for; where drawing is slow (no graphics processor), new frames wait so that the rest of the page does
  // not: whether it still has to draw.
  drawFrame(now) {
    if (this.drawnAt !== undefined && !this.timed) {
      this.timed = true;
      this.cost = 0.7 * (this.cost ?? 16) + 0.3 * Math.min(200, now - this.drawnAt);
    }
    if (!this.asked) return false;
    if (this.cost > SLOW && now - this.drawnAt < 3 * this.cost) return true;
    this.draw();
    Object.assign(this, { drawnAt: now, timed: false });
    return false;
  }

  draw() {
    if (!this.asked) return;
    this.asked = false;
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (!width || !height || !this.scene) return;
    const sharp = Math.min(2, window.devicePixelRatio || 1);
    if (this.width !== width || this.height !== height || this.sharp !== sharp) {
      Object.assign(this, { width, height, sharp });
      this.renderer.setPixelRatio(sharp);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
    }
    this.light.position.copy(this.camera.position);
    this.renderer.render(this.world, this.camera);
    this.#placeLabels();
    this.canvas.dataset.regions = String(this.estimated.children.filter((part) => part.isLine && !part.isLineSegments).length);
    this.canvas.dataset.drawn = String(Number(this.canvas.dataset.drawn || 0) + 1);
    this.canvas.dataset.camera = this.camera.position.toArray().map((v) => v.toFixed(2)).join(" ");
  }
}

function glass(color, opacity, side = THREE.FrontSide) {
  return new THREE.MeshBasicMaterial({ color, opacity, side, transparent: true, depthWrite: false });
}

// A box whose sides are darker than its top, once and for all: cheaper than light where a processor draws.
function shaded(box) {
  const normals = box.attributes.normal, shades = [];
  for (let k = 0; k < normals.count; k++) {
    const shade = normals.getZ(k) > 0.5 ? 1 : Math.abs(normals.getX(k)) > 0.5 ? 0.62 : 0.78;
    shades.push(shade, shade, shade);
  }
  return box.setAttribute("color", new THREE.Float32BufferAttribute(shades, 3));
}

// A straight tube around its centre line, about the centre of the inclusion.
function tube(one, lines) {
  const [begin, end] = one.line.map((point) => new THREE.Vector3(...point)), along = end.clone().sub(begin);
  const shape = new THREE.CylinderGeometry(one.radius, one.radius, along.length(), 14, 6, true);
  const drawn = new THREE.LineSegments(new THREE.WireframeGeometry(shape), lines);
  drawn.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.normalize());
  drawn.position.copy(begin).add(end).multiplyScalar(0.5).sub(new THREE.Vector3(...one.center));
  return drawn;
}

function empty(group) {
  group.traverse((part) => { part.geometry?.dispose(); part.material?.dispose(); });
  group.clear();
}
