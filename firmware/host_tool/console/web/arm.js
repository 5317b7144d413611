// SPDX-License-Identifier: MIT
// The arm in three dimensions, by its drawing at the readings told, and the places where it was measured.
// On a plain canvas: tubes from far to near.
import { colour, reading } from './words.js';

const times = (a, b) => a.map((row) => [0, 1, 2, 3].map((k) => row[0] * b[0][k] + row[1] * b[1][k] + row[2] * b[2][k] + (k === 3 ? row[3] : 0)));
const at = (pose, [x, y, z]) => pose.map((row) => row[0] * x + row[1] * y + row[2] * z + row[3]);
const minus = (a, b) => a.map((value, k) => value - b[k]);
const norm = (a) => Math.hypot(...a);

// Rot(z, theta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha)
function link(joint, q) {
  const theta = joint.theta_rad + (joint.revolute ? q : 0);
  const d = joint.d_m + (joint.revolute ? 0 : q);
  const [c, s, ca, sa] = [Math.cos(theta), Math.sin(theta), Math.cos(joint.alpha_rad), Math.sin(joint.alpha_rad)];
  return { pose: [[c, -s * ca, s * sa, joint.a_m * c], [s, c * ca, -c * sa, joint.a_m * s], [0, sa, ca, d]], d };
}

export class ArmView {
  constructor(canvas) {
    this.canvas = canvas;
    this.yaw = -0.7;
    this.pitch = 0.38;
    this.zoom = 1;
    this.joints = [];
    this.rows = [];
    this.q = null;
    this.offset = null; // of the tool from the last frame
    this.#listen();
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
  }

  setArm(joints) {
    this.joints = joints;
    this.offset = null;
    // Stretched out, with a slide at its far end.
    this.reach = Math.max(0.1, joints.reduce((sum, joint) => sum + Math.hypot(joint.a_m, joint.d_m) + (joint.revolute ? 0 : Math.max(Math.abs(joint.lower), Math.abs(joint.upper))), 0));
    this.size = 0.62 * this.reach;
    this.ground = -0.5 * this.reach;
  }

  // The status tells the tool in the drawing's frame as long as no signature is in use.
  setStatus(status) {
    if (this.joints.length === 0) return;
    const q = this.joints.map((joint, i) => reading(status, i + 1, joint.revolute));
    this.q = q.every(Number.isFinite) ? q : null;
    if (this.q !== null && status.model === 'nominal' && this.offset === null) {
      const last = this.#frames(q).at(-1);
      const tool = minus(['x_mm', 'y_mm', 'z_mm'].map((key) => status[key] / 1e3), last.map((row) => row[3]));
      const own = [0, 1, 2].map((k) => last[0][k] * tool[0] + last[1][k] * tool[1] + last[2][k] * tool[2]);
      if (norm(own) > 1e-3 && norm(own) < this.size) this.offset = own;
    }
    this.draw();
  }

  setRows(rows) {
    this.rows = rows;
    this.draw();
  }

  #tool() {
    return this.offset ?? [0.05 * this.size, 0, 0.03 * this.size];
  }

  #frames(q) {
    const frames = [[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]];
    this.joints.forEach((joint, i) => frames.push(times(frames[i], link(joint, q[i]).pose)));
    return frames;
  }

  #place(q) {
    return at(this.#frames(q).at(-1), this.#tool());
  }

  #listen() {
    const turn = (dx, dy) => {
      this.yaw -= dx;
      this.pitch = Math.max(-0.3, Math.min(1.4, this.pitch + dy));
      this.draw();
    };
    let from = null;
    this.canvas.addEventListener('pointerdown', (event) => {
      from = [event.clientX, event.clientY];
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener('pointermove', (event) => {
      if (from === null) return;
      turn((event.clientX - from[0]) / 160, event.pointerType === 'touch' ? 0 : (event.clientY - from[1]) / 200);
      from = [event.clientX, event.clientY];
    });
    for (const end of ['pointerup', 'pointercancel']) this.canvas.addEventListener(end, () => { from = null; });
    const keys = { ArrowLeft: [0.12, 0], ArrowRight: [-0.12, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    this.canvas.addEventListener('keydown', (event) => {
      if (event.key === '+' || event.key === '-') {
        this.zoom = Math.max(0.5, Math.min(3, this.zoom * (event.key === '+' ? 1.12 : 1 / 1.12)));
        this.draw();
      }
      if (!(event.key in keys)) return;
      event.preventDefault();
      turn(...keys[event.key]);
    });
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0) return;
    const ratio = Math.min(devicePixelRatio, 2);
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const pen = this.canvas.getContext('2d');
    pen.scale(ratio, ratio);
    this.pen = pen;
    if (this.q === null) return;  // the canvas is empty: where the arm is is not known
    this.#aim(width, height);
    this.#floor();
    this.#arcs();
    this.#arm();
    this.#dots();
  }

  #aim(width, height) {
    const [c, s, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
    const away = 4.2 * this.size;
    const scale = (0.74 * this.zoom * Math.min(width, height) * away) / (this.reach - this.ground);
    const middle = 0.5 * (this.reach + this.ground);
    this.project = ([x, y, z]) => {
      const across = c * x + s * y;
      const depth = -s * x + c * y;
      const up = z - middle;
      const distance = away + cp * depth - sp * up;
      const near = scale / distance;
      return { x: width / 2 + near * across, y: height * 0.5 - near * (cp * up + sp * depth), depth: distance, scale: near };
    };
  }

  #stroke(points, name, lineWidth, alpha = 1) {
    const { pen } = this;
    pen.globalAlpha = alpha;
    pen.strokeStyle = colour(name);
    pen.lineWidth = lineWidth;
    pen.lineCap = pen.lineJoin = 'round';
    pen.beginPath();
    points.forEach((p, k) => (k === 0 ? pen.moveTo(p.x, p.y) : pen.lineTo(p.x, p.y)));
    pen.stroke();
    pen.globalAlpha = 1;
  }

  // The plane on which the arm stands.
  #floor() {
    const extent = 1.3 * this.size;
    const lines = 12;
    for (let k = 0; k <= lines; ++k) {
      const x = -extent + (2 * extent * k) / lines;
      this.#stroke([this.project([x, -extent, this.ground]), this.project([x, extent, this.ground])], 'floor', 1);
      this.#stroke([this.project([-extent, x, this.ground]), this.project([extent, x, this.ground])], 'floor', 1);
    }
  }

  // The way of the target in each sweep, as far as the joint's limits go.
  #arcs() {
    const firsts = new Map();
    for (const row of this.rows) if (row.sweep > 0 && !firsts.has(row.sweep)) firsts.set(row.sweep, row.q);
    for (const [sweep, q] of firsts) {
      const { lower, upper } = this.joints[sweep - 1];
      const arc = Array.from({ length: 73 }, (_, k) => {
        const moved = q.slice();
        moved[sweep - 1] = lower + ((upper - lower) * k) / 72;
        return this.project(this.#place(moved));
      });
      this.#stroke(arc, 'soft', 1.2, 0.45);
    }
  }

  #dots() {
    const newest = this.rows.at(-1)?.sweep;
    for (const row of this.rows) {
      const p = this.project(this.#place(row.q));
      this.pen.fillStyle = colour(row.sweep === newest ? 'actual' : 'soft');
      this.pen.beginPath();
      this.pen.arc(p.x, p.y, row.sweep === newest ? 3.2 : 2.4, 0, 7);
      this.pen.fill();
    }
  }

  #arm() {
    const frames = this.#frames(this.q);
    const tubes = [];
    const add = (from, to, radius, name) => {
      if (norm(minus(from, to)) < 1e-4) return;
      tubes.push({ from: this.project(from), to: this.project(to), radius, name });
    };
    const n = this.joints.length;
    add([0, 0, this.ground], [0, 0, 0], 0.05 * this.size, 'base');
    this.joints.forEach((joint, i) => {
      const radius = this.size * (0.042 - (0.026 * i) / n);
      const origin = frames[i].map((row) => row[3]);
      const bend = at(frames[i], [0, 0, link(joint, this.q[i]).d]);
      add(origin, bend, radius, 'body');
      add(bend, frames[i + 1].map((row) => row[3]), radius * 0.9, 'body');
      const half = this.size * (0.055 - (0.03 * i) / n);
      add(at(frames[i], [0, 0, -half]), at(frames[i], [0, 0, half]), radius * 1.32, 'joint');
    });
    add(frames[n].map((row) => row[3]), at(frames[n], this.#tool()), 0.011 * this.size, 'tool');
    tubes.sort((a, b) => b.from.depth + b.to.depth - a.from.depth - a.to.depth);
    for (const tube of tubes) this.#tube(tube);
    const tip = this.project(at(frames[n], this.#tool()));
    this.pen.fillStyle = colour('nominal');
    this.pen.beginPath();
    this.pen.arc(tip.x, tip.y, Math.max(3.5, 0.018 * this.size * tip.scale), 0, 7);
    this.pen.fill();
  }

  // Lit from above and the left: dark edge, body, light line.
  #tube({ from, to, radius, name }) {
    const width = radius * (from.scale + to.scale);
    const main = { base: 'soft', body: 'actual', joint: 'actual', tool: 'soft' }[name];
    const lift = ([x, y]) => [from, to].map((p) => ({ x: p.x + x * width, y: p.y + y * width }));
    this.#stroke([from, to], main, width);
    this.#stroke([from, to], 'shade', width, name === 'joint' ? 0.42 : 0.22);
    this.#stroke(lift([-0.07, -0.09]), main, width * 0.72, name === 'joint' ? 0.6 : 1);
    this.#stroke(lift([-0.16, -0.2]), 'light', width * 0.2, 0.28);
  }
}
