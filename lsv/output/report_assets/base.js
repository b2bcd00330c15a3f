// SPDX-License-Identifier: BSD-3-Clause
// The data of the run, number formats and small DOM helpers. How the drawing went stands in
// data-lsv-ready of the root element: "1" drawn, "0" failed with the reason in #error;
// data-lsv-height-px is the height of the page for tools/check_report.
const root = document.documentElement;

function byId(id) { return document.getElementById(id); }

function fail(message) {
  root.dataset.lsvReady = "0";
  byId("error").hidden = false;
  byId("error").textContent += "The report could not be drawn: " + message + "\n";
}

window.addEventListener("error", event => fail(event.message));

const data = JSON.parse(document.getElementById("run-data").textContent);
const summary = data.summary;
const settings = summary.settings;
const series = data.series;
const unknown = "unknown";

function add(parent, tag, text, className) {
  const node = document.createElement(tag);
  if (text !== undefined) node.textContent = text;
  if (className) node.className = className;
  parent.appendChild(node);
  return node;
}

function isKnown(value) { return value !== null && value !== undefined; }

const prefixes = [["k", 1e3], ["", 1], ["m", 1e-3], ["\u00b5", 1e-6], ["n", 1e-9]];

// The SI prefix under which `size` reads as 1..999; factor turns base units into the scaled unit.
function scaleFor(size, unit) {
  const fitting = prefixes.find(([prefix, one]) =>
    size >= one * 0.9995 && !(prefix === "k" && unit === "s"));  // nobody reads kiloseconds
  const [prefix, one] = size > 0 ? fitting || prefixes[prefixes.length - 1] : ["", 1];
  return {unit: prefix + unit, factor: 1 / one};
}

// Four significant digits, no exponent, trailing zeros kept: 12.30, 0.01234.
function digits(value, count) {
  if (!isKnown(value)) return unknown;
  if (value === 0) return "0";
  const decimals = (count || 4) - 1 - Math.floor(Math.log10(Math.abs(value)));
  return value.toFixed(Math.min(Math.max(decimals, 0), 12)).replace("-", "\u2212");
}

function withUnit(value, unit, count) {
  if (!isKnown(value)) return unknown;
  const scale = scaleFor(Math.abs(value), unit);
  return digits(value * scale.factor, count) + "\u00a0" + scale.unit;
}

// A value and its sigma under one prefix, the value cut where sigma makes it meaningless.
function withSigma(value, sigma, unit) {
  if (!isKnown(value)) return unknown;
  const scale = scaleFor(Math.max(Math.abs(value), sigma || 0), unit);
  if (!sigma) return withUnit(value, unit);
  const decimals =
    Math.min(Math.max(1 - Math.floor(Math.log10(sigma * scale.factor)), 0), 9);
  const text = number => (number * scale.factor).toFixed(decimals).replace("-", "\u2212");
  return text(value) + " \u00b1 " + text(sigma) + "\u00a0" + scale.unit;
}

function percent(share) {
  return isKnown(share) ? digits(100 * share, 3) + "\u00a0%" : unknown;
}

function count(number) { return String(number).replace(/\B(?=(\d{3})+$)/g, "\u202f"); }

function plural(number, word) { return count(number) + " " + word + (number === 1 ? "" : "s"); }

// Lowest and highest of the known numbers in any number of arrays.
function extent(...arrays) {
  let low = Infinity, high = -Infinity;
  for (const array of arrays) {
    for (const value of array) {
      if (!isKnown(value)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : null;
}

function padded([low, high], share) {
  const room = (high - low) * share || Math.abs(high) * 0.1 || 1;
  return [low - room, high + room];
}

function widthOf(id) { return Math.max(Math.floor(byId(id).clientWidth), 240); }

// An empty SVG of the given size in pixels in the element `id`.
function newSvg(id, width, height, label) {
  byId(id).textContent = "";
  return d3.select(byId(id)).append("svg")
    .attr({viewBox: "0 0 " + width + " " + height, role: "img", "aria-label": label});
}

function legend(id, items) {
  const node = byId(id);
  node.textContent = "";
  for (const [shape, colour, text] of items) {
    const item = add(node, "span", undefined, "item");
    add(item, "i", "", shape + " c-" + colour);
    item.appendChild(document.createTextNode(text));
  }
}
