// SPDX-License-Identifier: MIT
// What is different, joint by joint, as a picture: a panel for each kind, a line for each joint, a dot at the
// value and a bar of one standard deviation on both sides of it. The table beside it has the figures.
import { decimalsFor, degrees, element, fixed } from './text.js';

const kNames = { tilt: 'Tilt', shift: 'Shift', zero: 'Zero of the reading', map: 'Joint error map, largest', gravity: 'Gravity, largest' };
const kSizes = ['map', 'gravity'];
const kUnits = {
  value_rad: { sigma: 'sigma_rad', unit: '°', scale: degrees },
  value_m: { sigma: 'sigma_m', unit: ' mm', scale: (m) => 1e3 * m },
  value: { sigma: 'sigma', unit: ' %', scale: (share) => 100 * share },
};
const kWidth = 300;
const kLeft = 58;      // of the line of zero's left end
const kRight = 290;
const kLine = 11;      // height of one difference
const kGap = 9;        // between joints

const shape = (tag, attributes, ...children) => {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
};

function told(line) {
  const key = Object.keys(kUnits).find((name) => name in line);
  const { sigma, unit, scale } = kUnits[key];
  const known = line[sigma] !== null;
  return { joint: line.joint, what: line.what, panel: line.kind + unit, kind: line.kind, unit,
    value: scale(line[key]), sigma: known ? scale(line[sigma]) : null };
}

function words({ joint, what, value, sigma, unit }) {
  const decimals = decimalsFor(sigma, 3, 4);
  return `Joint ${joint}, ${what}: ${fixed(value, decimals)}${unit}${sigma === null ? '' : ` ± ${fixed(sigma, decimals)}`}`;
}

function panel(lines) {
  const { unit, kind } = lines[0];
  const largest = 1.04 * Math.max(1e-9, ...lines.map(({ value, sigma }) => Math.abs(value) + (sigma ?? 0)));
  // Sizes have no sign: their line of zero is at the left.
  const sizes = kSizes.includes(kind);
  const zero = sizes ? kLeft : (kLeft + kRight) / 2;
  const at = (value) => zero + ((kRight - zero) * value) / largest;
  const parts = [];
  let y = 6;
  for (const joint of new Set(lines.map((line) => line.joint))) {
    const own = lines.filter((line) => line.joint === joint);
    const height = kLine * own.length + kGap;
    const middle = y + height / 2;
    parts.push(shape('line', { class: 'rule', x1: 0, x2: kRight, y1: y, y2: y }), shape('text', { x: 0, y: middle + 4 }, `joint ${joint}`));
    own.forEach((line, k) => {
      const height_of = middle + kLine * (k - (own.length - 1) / 2);
      const group = shape('g', { class: 'difference' }, shape('title', {}, words(line)),
        shape('rect', { class: 'reach', x: kLeft, y: height_of - kLine / 2, width: kRight - kLeft, height: kLine }),
        shape('line', { class: 'stem', x1: zero, x2: at(line.value), y1: height_of, y2: height_of }));
      if (line.sigma !== null) {
        group.append(shape('line', { class: 'sigma', x1: at(line.value - line.sigma), x2: at(line.value + line.sigma), y1: height_of, y2: height_of }));
      }
      group.append(shape('circle', { class: line.sigma === null ? 'unsure' : 'value', cx: at(line.value), cy: height_of, r: 3.4 }));
      parts.push(group);
    });
    y += height;
  }
  const digits = Math.max(0, Math.min(4, 1 - Math.floor(Math.log10(largest))));
  const label = (x, anchor, text) => shape('text', { class: 'scale', x, y: y + 16, 'text-anchor': anchor }, text);
  parts.push(shape('line', { class: 'zero', x1: zero, x2: zero, y1: 6, y2: y }),
    ...(sizes ? [] : [label(kLeft, 'start', `${fixed(-largest, digits)}${unit}`)]), label(zero, 'middle', '0'), label(kRight, 'end', `${fixed(largest, digits)}${unit}`));
  const furthest = lines.reduce((a, b) => (Math.abs(b.value) > Math.abs(a.value) ? b : a));
  // A slide's zero is a length, and has a panel of its own.
  const name = `${kNames[kind] ?? kind}${kind === 'zero' && unit === ' mm' ? ' of a slide' : ''}`;
  return element('figure', {}, element('figcaption', {}, name),
    shape('svg', { viewBox: `0 0 ${kWidth} ${y + 22}`, role: 'img', 'aria-label': `${name} by joint, in the table below; largest: ${words(furthest)}` }, ...parts));
}

export function differencesPicture({ differences }) {
  const host = document.getElementById('differences-picture');
  const lines = (differences?.joints ?? []).map(told);
  if (lines.length === 0) {
    host?.remove();
    return;
  }
  const order = Object.keys(kNames);
  const rank = ({ kind }) => (order.includes(kind) ? order.indexOf(kind) : order.length);
  const panels = [...new Set(lines.toSorted((a, b) => rank(a) - rank(b)).map((line) => line.panel))];
  host.append(...panels.map((name) => panel(lines.filter((line) => line.panel === name))));
}
