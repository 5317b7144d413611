// SPDX-License-Identifier: MIT
// One dial a joint: the points of its sweep at their readings, off the circle by their magnified residuals, and how
// its axis gets known.
import { element, rough, shape, twoDigits } from './words.js';

const kRadius = 62;
const kLeast = 8;       // points before residuals mean anything
const kLargest = 16;    // of a residual as it is drawn

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((value) => value / (Math.hypot(...a) || 1));

// Solves the 3 x 3 equations m x = b by Cramer's rule; null where they do not tell.
function solve(m, b) {
  const det = dot(m[0], cross(m[1], m[2]));
  if (Math.abs(det) < 1e-18) return null;
  const column = (k) => m.map((row, i) => row.map((value, j) => (j === k ? b[i] : value)));
  return [0, 1, 2].map((k) => { const c = column(k); return dot(c[0], cross(c[1], c[2])) / det; });
}

// The circle through points in space: plane by least squares, circle in it by Kasa's equations. The distance of each
// point from it in the plane, and its radius.
function circleThrough(points) {
  const mean = [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
  const off = points.map((p) => p.map((value, k) => value - mean[k]));
  // The normal is the smallest direction of the scatter: power iteration on trace - scatter.
  const scatter = [0, 1, 2].map((i) => [0, 1, 2].map((j) => off.reduce((sum, p) => sum + p[i] * p[j], 0)));
  const trace = scatter[0][0] + scatter[1][1] + scatter[2][2];
  let normal = unit([0.31, 0.53, 0.79]);
  for (let pass = 0; pass < 200; ++pass) {
    normal = unit(normal.map((value, i) => trace * value - dot(scatter[i], normal)));
  }
  const x = unit(cross(normal, Math.abs(normal[0]) < 0.7 ? [1, 0, 0] : [0, 1, 0]));
  const y = cross(normal, x);
  const flat = off.map((p) => [dot(p, x), dot(p, y)]);
  const rows = flat.map(([u, v]) => [u, v, 1]);
  const m = [0, 1, 2].map((i) => [0, 1, 2].map((j) => rows.reduce((sum, row) => sum + row[i] * row[j], 0)));
  const b = [0, 1, 2].map((i) => rows.reduce((sum, row) => sum + row[i] * (row[0] ** 2 + row[1] ** 2), 0));
  const solution = solve(m, b);
  if (solution === null) return null;
  const [u, v] = [solution[0] / 2, solution[1] / 2];
  const radius = Math.sqrt(Math.max(0, solution[2] + u * u + v * v));
  return { radius, residuals: flat.map((p) => Math.hypot(p[0] - u, p[1] - v) - radius) };
}

export class Dials {
  constructor(host) {
    this.host = host;
  }

  setArm(joints) {
    this.joints = joints;
    this.radii = joints.map(() => NaN);
    this.figures = joints.map((_, i) => {
      const picture = shape('svg', { viewBox: '-95 -95 190 215', role: 'img' });
      const words = element('figcaption');
      const figure = element('figure', { class: 'dial', 'data-joint': i + 1 }, picture, words);
      return { figure, picture, words };
    });
    this.host.replaceChildren(...this.figures.map(({ figure }) => figure));
    this.show([], {}, 0);
  }

  // `rows`: of the run; `sigmas`: by joint, [points, degrees]; `sweep`: the joint under way, 0: none.
  show(rows, sigmas, sweep) {
    this.joints?.forEach((joint, i) => this.#draw(joint, i, rows.filter((row) => row.sweep === i + 1), sigmas[i + 1] ?? [], sweep === i + 1));
  }

  // What the axes known so far leave open at the target, in mm: by joint, NaN where it is not known yet.
  shares(sigmas) {
    return (this.joints ?? []).map((_, i) => {
      const last = sigmas[i + 1]?.at(-1);
      return last ? 1e3 * this.radii[i] * Math.tan((last[1] * Math.PI) / 180) : NaN;
    });
  }

  #draw(joint, i, rows, history, isUnderWay) {
    const { figure, picture, words } = this.figures[i];
    const key = `${rows.length} ${history.length} ${history.at(-1)?.[1]} ${isUnderWay}`;
    if (figure.dataset.key === key) return;
    figure.dataset.key = key;
    figure.classList.toggle('under-way', isUnderWay);
    const circle = joint.revolute && rows.length >= kLeast ? circleThrough(rows.map((row) => row.p)) : null;
    this.radii[i] = circle?.radius ?? NaN;
    const largest = circle ? Math.max(...circle.residuals.map(Math.abs), 1e-9) : 1;
    const place = (angle, radius) => [radius * Math.sin(angle), -radius * Math.cos(angle)];
    // A slide is laid along the dial as well, over three quarters of it.
    const span = joint.upper - joint.lower || 1;
    const angle = (q) => (joint.revolute ? q : ((q - joint.lower) / span - 0.5) * 1.5 * Math.PI);
    const [low, high] = [angle(joint.lower), angle(joint.upper)];
    const parts = [shape('circle', { class: 'ring', r: kRadius })];
    if (high - low < 2 * Math.PI) {
      const [a, b] = [place(low, kRadius), place(high, kRadius)];
      parts.push(shape('path', { class: 'range', d: `M${a} A${kRadius} ${kRadius} 0 ${high - low > Math.PI ? 1 : 0} 1 ${b}` }));
    }
    rows.forEach((row, k) => {
      const off = circle ? (kLargest * circle.residuals[k]) / largest : 0;
      const [x, y] = place(angle(row.q[i]), kRadius + off);
      const newest = isUnderWay && k === rows.length - 1;
      parts.push(shape('circle', { class: newest ? 'point newest' : 'point', cx: x.toFixed(1), cy: y.toFixed(1), r: newest ? 5 : 3 }));
    });
    parts.push(shape('text', { y: rows.length > 0 ? -2 : 6 }, `Joint ${i + 1}`));
    if (rows.length > 0) parts.push(shape('text', { class: 'small', y: 15 }, `${rows.length} point${rows.length === 1 ? '' : 's'}`));
    if (circle) parts.push(shape('text', { class: 'small', y: 31 }, `\u00d7 ${twoDigits((kLargest / kRadius) * circle.radius / largest)}`));
    parts.push(...this.#spark(history));
    picture.replaceChildren(...parts);
    const sigma = history.at(-1)?.[1];
    const atTool = sigma === undefined ? NaN : this.shares({ [i + 1]: history })[i];
    words.replaceChildren(sigma === undefined ? element('span', {}, rows.length > 0 ? 'axis not known yet' : 'not swept yet') : `axis \u00b1 ${rough(sigma)}\u00b0`);
    if (Number.isFinite(atTool)) words.append(element('br'), element('span', {}, `\u00b1 ${rough(atTool)} mm at the target`));
    picture.setAttribute('aria-label', `Joint ${i + 1}: ${rows.length} points` + (sigma === undefined ? '' : `, axis known to ${rough(sigma)} degrees`));
  }

  // The axis' sigma against the points, on a logarithmic scale, below the dial.
  #spark(history) {
    const [left, right, top, bottom] = [-60, 60, 96, 116];
    if (history.length < 2) return [];
    const values = history.map(([, sigma]) => Math.log10(sigma));
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const points = values.map((value, k) => {
      const x = left + ((right - left) * k) / (values.length - 1);
      return `${x.toFixed(1)},${(bottom - 2 - ((bottom - 2 - top) * (value - low)) / (high - low || 1)).toFixed(1)}`;
    });
    return [shape('line', { class: 'under', x1: left, x2: right, y1: bottom, y2: bottom }), shape('polyline', { class: 'spark', points: points.join(' ') })];
  }
}
