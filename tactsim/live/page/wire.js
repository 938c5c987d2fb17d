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
