"use strict";
// What the page brings along: libraries and data, compressed. Everything else hangs on this object.
const fissura = {};

fissura.inflated = async function (id) {
  const text = atob(document.getElementById(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
};

// The layout is that of `packed` in packed.py.
fissura.data = async function () {
  const types = { Float32Array, Float64Array, Uint8Array, Uint16Array, Int16Array, Int32Array, Uint32Array };
  const buffer = await fissura.inflated("data");
  const size = new DataView(buffer).getUint32(0, true);
  const text = new TextDecoder().decode(new Uint8Array(buffer, 8, size));
  const start = 8 + 8 * Math.ceil(size / 8);
  return JSON.parse(text, (_, value) => {
    if (!value || !value.$array) return value;
    const [type, at, length] = value.$array;
    return new types[type](buffer, start + at, length);
  });
};

// Values of `quantised`.
fissura.values = function (stored) {
  const factor = (stored.high - stored.low) / 65535;
  return Float32Array.from(stored.codes, (code) => stored.low + factor * code);
};

// Runs a library of the page. K3D asks for a `define` as AMD has it, which must not be there for others.
fissura.library = async function (name) {
  const script = [...document.querySelectorAll("script[data-name]")].find((one) => one.dataset.name === name);
  const source = document.createElement("script");
  source.textContent = new TextDecoder().decode(await fissura.inflated(script.id));
  let made;
  if (name !== "Plotly") window.define = (_name, _needs, make) => { made = make(); };
  document.head.append(source);
  delete window.define;
  return made || window.Plotly;
};

fissura.colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

// Three significant digits, as elsewhere in Fissura.
fissura.told = function (value, unit) {
  if (!Number.isFinite(value)) return "-";
  const digits = value === 0 ? 0 : Math.max(2 - Math.floor(Math.log10(Math.abs(value))), 0);
  return value.toFixed(Math.min(digits, 6)) + (unit ? ` ${unit}` : "");
};

fissura.onScheme = function (redraw) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
};
