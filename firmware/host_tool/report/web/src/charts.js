// SPDX-License-Identifier: MIT
// Residuals against the reading, and the map of the tool error, by uPlot.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { colour, degrees, fixed, length } from './text.js';
import { underPointer } from './values.js';

const kDirections = [
  { index: 2, name: 'radial', flat: 'across' },
  { index: 3, name: 'normal', flat: 'across, other way' },
  { index: 4, name: 'tangential', flat: 'along' },
];

// As many decimals as the steps between ticks have.
function stepDecimals(ticks) {
  if (ticks.length < 2) return 3;
  const step = Math.abs(ticks[1] - ticks[0]);
  for (let decimals = 0; decimals < 9; ++decimals) {
    if (Math.abs(step - Number(step.toFixed(decimals))) < 1e-6 * step) return decimals;
  }
  return 9;
}

export const axis = (label, size, unit = '') => ({
  label, labelSize: 18, size, gap: 6, font: '12px system-ui', labelFont: '12px system-ui', labelGap: 0,
  values: (_, ticks) => ticks.map((tick) => `${fixed(tick, stepDecimals(ticks))}${unit}`),
  stroke: colour('soft'), grid: { stroke: colour('line'), width: 1 }, ticks: { show: false },
});

// Of a joint's reading; millimetres stand in its name, as there is no room for them at each tick.
const readingAxis = ({ joint, revolute }) => axis(`reading of joint ${joint}${revolute ? '' : ', mm'}`, 26, revolute ? '°' : '');

// A finger touches what a mouse points at.
export const kPoint = matchMedia('(pointer: coarse)').matches ? 'Touch' : 'Point at';

const dots = (name, size) => ({ show: true, size, width: 0, fill: colour(name), stroke: colour(name) });

// The row nearest to the one at `index` that `is` true of; null where there is none.
function nearest(rows, index, is) {
  for (let off = 0; off < rows.length; ++off) {
    for (const k of [index - off, index + off]) if (rows[k] && is(rows[k])) return rows[k];
  }
  return null;
}

// Tells what `words` says of the place of the pointer.
export const pointing = (tell, words) => ({ setCursor: [(plot) => tell(plot.cursor.idx === null || plot.cursor.left < 0 ? '' : words(plot.cursor.idx, plot))] });

function widthOf(host) {
  return Math.max(240, host.clientWidth);
}

// Redraws with the width of its place. Returns what to call when colours change.
export function keepDrawn(host, options, data) {
  let plot;
  const draw = () => {
    plot?.destroy();
    plot = new uPlot({ ...options(uPlot), width: widthOf(host) }, data, host);
  };
  draw();
  let width = host.clientWidth;
  new ResizeObserver(() => {
    if (host.clientWidth === width || host.clientWidth === 0) return;
    width = host.clientWidth;
    plot.setSize({ width: widthOf(host), height: plot.height });
  }).observe(host);
  return draw;
}

export function residualChart(host, sweep) {
  const unit = sweep.revolute ? degrees : (metres) => 1e3 * metres;
  const accepted = sweep.points.filter((point) => !point[5]);
  const largest = 1e3 * Math.max(1e-9, ...accepted.flatMap((point) => kDirections.map(({ index }) => Math.abs(point[index]))));
  const edge = 1.35 * largest;
  const clamp = (millimetres) => Math.max(-edge, Math.min(edge, millimetres));

  // One row a point; the curve of a wave has rows of its own.
  const rows = sweep.points.map((point) => ({ x: unit(point[0]), point }));
  if (sweep.wave?.significant) for (const at of sweep.wave.curve) rows.push({ x: unit(at[0]), curve: at });
  rows.sort((a, b) => a.x - b.x);
  const data = [rows.map((row) => row.x)];
  for (const { index } of kDirections) data.push(rows.map(({ point }) => (point && !point[5] ? 1e3 * point[index] : null)));
  data.push(rows.map(({ point }) => {
    if (!point?.[5]) return null;
    const furthest = kDirections.map(({ index }) => point[index]).sort((a, b) => Math.abs(b) - Math.abs(a))[0];
    return clamp(1e3 * furthest);
  }));
  data.push(rows.map(({ curve }) => (curve ? 1e3 * curve[2] : null)));
  data.push(rows.map(({ curve }) => (curve ? 1e3 * curve[1] : null)));

  const value = (_, number) => (number === null || number === undefined ? '' : `${fixed(number, 3)} mm`);
  const scatter = (label, name) => ({ label, value, stroke: colour(name), paths: () => null, points: dots(name, 4.5) });
  const curve = (label, name) => ({ label, value, stroke: colour(name), width: 2, spanGaps: true, points: { show: false } });
  const series = () => [
    { label: 'reading' },
    ...kDirections.map(({ name, flat }) => scatter(sweep.revolute ? name : flat, name)),
    { ...scatter('rejected', 'rejected'), points: { show: true, size: 11, width: 2, stroke: colour('rejected'), fill: 'transparent' } },
    curve('encoder wave, tangential', 'tangential'),
    curve('encoder wave, radial', 'radial'),
  ];
  const tell = underPointer(host, `${kPoint} the chart for the values of a reading.`);
  const names = kDirections.map(({ name, flat }) => (sweep.revolute ? name : flat));
  const words = (index) => {
    const row = nearest(rows, index, ({ point }) => point);
    if (row === null) return '';
    const off = kDirections.map(({ index: at }, k) => `${names[k]} ${fixed(1e3 * row.point[at], 3)}`);
    return `at ${fixed(row.x, 2)}${sweep.revolute ? '°' : ' mm'}: ${off.join(', ')} mm${row.point[5] ? ', rejected' : ''}`;
  };
  const shown = (_, k) => k < 4 || (k === 4 && sweep.rejected > 0) || (k > 4 && sweep.wave?.significant);
  return keepDrawn(host, () => {
    const drawn = series().filter(shown);
    return {
      height: 190,
      legend: { live: false, markers: { width: 2, stroke: (_, k) => drawn[k].stroke, fill: (_, k) => (drawn[k].label === 'rejected' ? 'transparent' : drawn[k].stroke) } },
      cursor: { drag: { x: true, y: false }, y: false },
      hooks: pointing(tell, words),
      scales: { x: { time: false }, y: { range: [-1.45 * largest, 1.45 * largest] } },
      axes: [readingAxis(sweep), axis('residual, mm', 64)],
      series: drawn,
    };
  }, data.filter(shown));
}

// The map of a joint's reading over what was measured, with twice its 1 sigma; beyond that it is marked. On the right
// the same in millimetres at the tool.
export function readingMapChart(host, joint) {
  const unit = joint.revolute ? degrees : (metres) => 1e3 * metres;
  const [from, to] = joint.covered.map(unit);
  const { curve } = joint;
  const measured = (at) => at[3] === 1;
  const data = [
    curve.map((at) => unit(at[0])),
    curve.map((at) => unit(at[1] + 2 * at[2])),
    curve.map((at) => unit(at[1] - 2 * at[2])),
    curve.map((at) => (measured(at) ? unit(at[1]) : null)),
    // Up to where the other curve begins.
    curve.map((at, k) => (measured(at) && measured(curve[k - 1] ?? at) && measured(curve[k + 1] ?? at) ? null : unit(at[1]))),
  ];
  // What is not known beyond the readings measured would leave nothing to see of what is.
  const known = curve.filter(measured);
  const largest = 1.15 * Math.max(1e-9, ...known.map((at) => unit(Math.abs(at[1]) + 2 * at[2])));
  const atTool = (1e3 * joint.tool_m_per_unit) / unit(1);
  const sign = joint.revolute ? '°' : ' mm';
  const tell = underPointer(host, `${kPoint} the chart for the map at a reading.`);
  const words = (index) => {
    const at = curve[index];
    return `at ${fixed(unit(at[0]), 1)}${sign}: ${fixed(unit(at[1]), 4)}${sign} ± ${fixed(unit(at[2]), 4)} (1σ), `
      + `${fixed(atTool * unit(at[1]), 3)} mm at the tool${measured(at) ? '' : ', not measured here'}`;
  };
  const line = (label, name, width) => ({ label, stroke: colour(name), width, points: { show: false }, spanGaps: false });
  return keepDrawn(host, () => ({
    height: 170,
    legend: { show: false },
    cursor: { drag: { x: true, y: false }, y: false },
    hooks: { ...pointing(tell, words), drawClear: [(plot) => markUnmeasured(plot, from, to)] },
    scales: {
      x: { time: false, range: [unit(curve[0][0]), unit(curve.at(-1)[0])] },
      y: { range: [-largest, largest] },
      tool: { range: [-largest * atTool, largest * atTool] },
    },
    bands: [{ series: [1, 2], fill: `${colour('actual')}33` }],
    axes: [
      readingAxis(joint),
      { ...axis(joint.revolute ? 'map, °' : 'map, mm', 72), space: 26 },
      { ...axis('at the tool, mm', 64), scale: 'tool', side: 1, space: 26, grid: { show: false } },
    ],
    series: [{ label: 'reading' }, line('+2σ', 'line', 0), line('-2σ', 'line', 0),
      line('map', 'actual', 2), line('not measured', 'soft', 1)],
  }), data);
}

// Hatches what lies outside of the readings that were measured.
function markUnmeasured({ ctx, bbox, valToPos }, from, to) {
  const edges = [[bbox.left, valToPos(from, 'x', true)], [valToPos(to, 'x', true), bbox.left + bbox.width]];
  ctx.save();
  for (const [left, right] of edges) {
    if (right - left < 1) continue;
    ctx.beginPath();
    ctx.rect(left, bbox.top, right - left, bbox.height);
    ctx.save();
    ctx.clip();
    ctx.beginPath();
    for (let x = left - bbox.height; x < right; x += 7 * devicePixelRatio) {
      ctx.moveTo(x, bbox.top + bbox.height);
      ctx.lineTo(x + bbox.height, bbox.top);
    }
    ctx.strokeStyle = colour('line');
    ctx.lineWidth = devicePixelRatio;
    ctx.stroke();
    ctx.restore();
  }
  ctx.restore();
}

// Points (r, z) in classes with a colour each; `error_m` is told of the one nearest to the pointer.
export function mapChart(host, points, classes) {
  const sorted = points.slice().sort((a, b) => a.r - b.r);
  const data = [sorted.map((point) => point.r)];
  const kinds = classes.flatMap((each, k) => [{ ...each, k, measured: true }, { ...each, k, measured: false }])
    .filter(({ k, measured }) => points.some((point) => point.class === k && point.measured === measured));
  for (const { k, measured } of kinds) data.push(sorted.map((point) => (point.class === k && point.measured === measured ? point.z : null)));
  const zs = points.map((point) => point.z);
  const tell = underPointer(host, `${kPoint} a dot for its error.`);
  const words = (_, plot) => {
    const away = (point) => Math.hypot(plot.valToPos(point.r, 'x') - plot.cursor.left, plot.valToPos(point.z, 'y') - plot.cursor.top);
    const point = sorted.reduce((a, b) => (away(b) < away(a) ? b : a));
    return away(point) > 24 ? '' : `${length(point.error_m)}, at ${fixed(point.r, 3)} m from the first axis, ${fixed(point.z, 3)} m along it${point.measured ? '' : ', beyond the readings measured'}`;
  };
  const margin = 0.06 * (Math.max(...zs) - Math.min(...zs));
  return keepDrawn(host, () => ({
    height: 380,
    legend: { show: false },
    cursor: { x: false, y: false, points: { show: false }, drag: { x: false, y: false } },
    hooks: pointing(tell, words),
    scales: { x: { time: false }, y: { range: [Math.min(...zs) - margin, Math.max(...zs) + margin] } },
    axes: [axis('distance from the first axis, m', 46), axis('height along it, m', 64)],
    series: [{}, ...kinds.map(({ colour: fill, measured }) => ({
      stroke: fill, paths: () => null, points: { show: true, size: 8, width: measured ? 0 : 1.5, fill: measured ? fill : 'transparent', stroke: fill },
    }))],
  }), data);
}
