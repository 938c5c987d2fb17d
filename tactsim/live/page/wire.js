// What comes from the server: JSON texts, and frames as JSON with numbers and three pictures behind it.

export function readFrame(buffer, scene) {
  const length = new DataView(buffer).getUint32(0, true);
  const frame = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const taxels = 2 * scene.rows * scene.columns, pixels = scene.shape[0] * scene.shape[1];
  const start = 4 + length;
  frame.forces = new Float32Array(buffer, start, taxels);
  frame.pictures = {};
  ["front", "left", "top"].forEach((name, k) => {
    frame.pictures[name] = new Uint8Array(buffer, start + 4 * taxels + k * pixels, pixels);
  });
  return frame;
}

export function readable(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size < 1e-5 || size >= 1e6 ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
}

// Numbers of one table: all with the decimals that its largest needs for some digits, so that they compare.
export function evenly(largest, digits = 3) {
  const size = Math.abs(largest);
  if (!(size >= 1e-5 && size < 1e6)) return (value) => readable(value, digits);
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return (value) => (Number.isFinite(value) ? value.toFixed(decimals) : "–");
}

// The unit of all numbers of the page and how many of it are one newton: mN where no taxel has read a tenth of a newton.
export function forceUnit(unit, frame) {
  const small = unit === "N" && frame.scales[3] > 0 && frame.scales[3] < 0.1;
  return small ? { name: "mN", factor: 1e3 } : { name: unit, factor: 1 };
}

// Draws the colour map as a bar with numbers under its begin, middle and end.
export function drawRamp(pen, colours, { left, top, width, height }, words) {
  for (let k = 0; k < width; k++) {
    const at = 3 * Math.round((255 * k) / Math.max(1, width - 1));
    pen.fillStyle = `rgb(${colours[at]},${colours[at + 1]},${colours[at + 2]})`;
    pen.fillRect(left + k, top, 1.5, height);
  }
  pen.fillStyle = pen.strokeStyle; pen.textBaseline = "top";
  pen.lineWidth = 0.6; pen.strokeRect(left, top, width, height);
  words.forEach((word, k) => {
    const share = k / (words.length - 1);
    pen.textAlign = share === 0 ? "left" : share === 1 ? "right" : "center";
    pen.fillText(word, left + share * width, top + height + 2);
  });
}

const STEPS = [1, 2, 5];                       // between ticks, times a power of ten

// The ticks of an axis of a length in mm: where they are and what they read, at least some px apart; both ends of a short one.
export function ticks(length, scale, apart) {
  const least = apart / scale, power = Math.floor(Math.log10(least)), ten = 10 ** power;
  const step = ten * (STEPS.find((one) => one * ten >= least * (1 - 1e-9)) ?? 10);
  if (step > length) return length * scale < apart / 2 ? [[0, "0"]] : [[0, "0"], [length, String(Number(length.toPrecision(3)))]];
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return Array.from({ length: Math.floor(length / step + 1e-9) + 1 }, (_, k) => [k * step, (k * step).toFixed(decimals)]);
}
