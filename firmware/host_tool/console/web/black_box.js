// SPDX-License-Identifier: MIT
// The seconds before a fault: what a joint was commanded, where it was, and the difference.
import { colour, element, fixed } from './words.js';

const kLeastMargin = 0.01;  // degrees or mm: a joint that stands is a line, not its last digit
const kMostColumns = 900;  // drawn; more ticks than that are drawn by their extremes

function parse(text) {
  const lines = text.split('\n').filter((line) => line !== '' && !line.startsWith('#'));
  const names = (lines.shift() ?? '').split(',');
  return { names, rows: lines.map((line) => line.split(',')) };
}

// The least of 1, 2 and 5 times a power of ten that is not below `size`.
function roundStep(size) {
  const decade = 10 ** Math.floor(Math.log10(size));
  return decade * [1, 2, 5, 10].find((step) => step * decade >= size * 0.999);
}

export class BlackBox {
  constructor(section, tell) {
    this.section = section;
    this.tell = tell;
    this.file = '';
    this.select = document.getElementById('black-box-joint');
    this.charts = document.getElementById('black-box-charts');
    this.select.addEventListener('change', () => this.#draw());
    new ResizeObserver(() => this.#draw()).observe(this.charts);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.#draw());
  }

  // `file`: as the status names it; `joint`: that of the fault, if it has one.
  async show(file, joint) {
    if (file === this.file) return;
    this.file = file;
    this.section.hidden = file === '';
    if (file === '') return;
    const name = file.split('/').pop();
    document.getElementById('black-box-file').download = name;
    const answer = await fetch('black-box.csv').catch(() => null);
    if (!answer?.ok) {
      this.tell('black-box-lead', answer ? await answer.text() : 'The black box could not be had.');
      this.data = null;
      return;
    }
    this.data = parse(await answer.text());
    const joints = this.data.names.map((column) => /^q(\d+)_commanded_/.exec(column)?.[1]).filter(Boolean);
    this.select.replaceChildren(...joints.map((number) => element('option', { value: number }, number)));
    this.select.value = joint && joints.includes(String(joint)) ? joint : this.#furthest(joints);
    this.tell('black-box-lead', `${this.data.rows.length} ticks, from ${name}: commanded and actual reading, and by how much the joint was off.`);
    this.#draw();
  }

  // The joint that went furthest, where the fault has none of its own.
  #furthest(joints) {
    const { names, rows } = this.data;
    const went = (joint) => {
      const k = ['deg', 'mm'].map((unit) => names.indexOf(`q${joint}_${unit}`)).find((at) => at >= 0);
      const [low, high] = rows.map((row) => parseFloat(row[k])).filter(Number.isFinite)
        .reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
      return high > low ? high - low : 0;
    };
    return joints.reduce((a, b) => (went(b) > went(a) ? b : a), joints[0]);
  }

  #draw() {
    if (!this.data || this.charts.clientWidth === 0) return;
    const { names, rows } = this.data;
    const joint = this.select.value;
    const unit = names.includes(`q${joint}_deg`) ? 'deg' : 'mm';
    const sign = unit === 'deg' ? '\u00b0' : ' mm';
    const column = (name) => { const k = names.indexOf(name); return rows.map((row) => parseFloat(row[k])); };
    const mode = names.indexOf('mode');
    const fault = rows.findIndex((row) => row[mode] === 'faulted');
    const t = column('t_s');
    const seconds = t.map((value) => value - t[fault < 0 ? t.length - 1 : fault]);
    const [actual, commanded] = [column(`q${joint}_${unit}`), column(`q${joint}_commanded_${unit}`)];
    const off = actual.map((value, k) => value - commanded[k]);
    this.charts.replaceChildren(
      this.#chart(seconds, [[commanded, 'nominal'], [actual, 'actual']], sign, `Joint ${joint}: commanded (orange), actual (green)`),
      this.#chart(seconds, [[off, 'rejected']], sign, `Joint ${joint}: actual less commanded`));
  }

  #chart(x, lines, sign, words) {
    const [width, height, bottom, top] = [this.charts.clientWidth, 200, 26, 32];
    const ratio = Math.min(devicePixelRatio, 2);
    const canvas = element('canvas', { class: 'chart', role: 'img', 'aria-label': words });
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const pen = canvas.getContext('2d');
    pen.scale(ratio, ratio);
    pen.font = '12px system-ui';
    const known = lines.flatMap(([y]) => y).filter(Number.isFinite);
    let [low, high] = known.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
    const margin = Math.max((high - low) * 0.08, kLeastMargin);
    low -= margin;
    high += margin;
    const step = roundStep((high - low) / 4);
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const steps = [];
    for (let k = Math.ceil(low / step); k * step <= high; ++k) steps.push({ value: k * step, text: fixed(k * step, digits) + sign });
    const left = 8 + Math.ceil(Math.max(48, ...steps.map(({ text }) => pen.measureText(text).width)));
    const at = (value) => left + ((width - left - 8) * (value - x[0])) / (x.at(-1) - x[0] || 1);
    const up = (value) => top + ((height - top - bottom) * (high - value)) / (high - low);
    pen.fillStyle = colour('soft');
    pen.fillText(words, 8, 13);
    pen.strokeStyle = colour('line');
    for (const { value, text } of steps) {
      pen.beginPath();
      pen.moveTo(left, up(value));
      pen.lineTo(width - 8, up(value));
      pen.stroke();
      pen.textAlign = 'right';
      pen.fillText(text, left - 8, up(value) + 4);
    }
    pen.textAlign = 'center';
    const second = Math.max(1, Math.round((x.at(-1) - x[0]) / 6));
    for (let s = second * Math.ceil(x[0] / second); s <= x.at(-1); s += second) pen.fillText(s === 0 ? 'fault' : `${fixed(s, 0)} s`, at(s), height - 6);
    pen.strokeStyle = colour('soft');
    pen.setLineDash([3, 3]);
    pen.beginPath();
    pen.moveTo(at(0), top);
    pen.lineTo(at(0), height - bottom);
    pen.stroke();
    pen.setLineDash([]);
    for (const [y, name] of lines) {
      pen.strokeStyle = colour(name);
      pen.lineWidth = 1.6;
      pen.beginPath();
      const ticks = Math.max(1, Math.floor(y.length / kMostColumns));
      for (let k = 0; k < y.length; k += ticks) {
        const piece = y.slice(k, k + ticks);
        for (const value of ticks > 1 ? [Math.min(...piece), Math.max(...piece)] : piece) {
          if (Number.isFinite(value)) pen.lineTo(at(x[k]), up(value));
        }
      }
      pen.stroke();
    }
    return canvas;
  }
}
