// SPDX-License-Identifier: MIT
// Residuals of free poses: how many of which length, against each joint's reading, and in the order of measurement.
import { axis, keepDrawn, kPoint, pointing } from './charts.js';
import { colour, degrees, fixed, length } from './text.js';
import { underPointer } from './values.js';

const kGroups = 24;     // of readings, a mean each
const kFewest = 8;      // poses in a group that has a mean
const norm = (v) => Math.hypot(...v);
const mm = (metres) => 1e3 * metres;

export function histogramChart(host, { histogram, stated_rms_m: stated }) {
  const { bin_m: bin, counts, expected } = histogram;
  const middles = counts.map((_, k) => mm((k + 0.5) * bin));
  const tell = underPointer(host, `${kPoint} a bar for its count.`);
  const words = (k) => `${k + 1 === counts.length ? `above ${length(k * bin)}` : `${length(k * bin)} to ${length((k + 1) * bin)}`}: ${counts[k]} poses`
    + `${expected.length > 0 ? `, ${fixed(expected[k], 1)} expected` : ''}`;
  const bars = ({ bars: paths }) => paths({ size: [0.86, 60] });
  return keepDrawn(host, (uPlot) => ({
    height: 230,
    legend: { live: false },
    cursor: { y: false, drag: { x: false, y: false } },
    hooks: pointing(tell, words),
    scales: { x: { time: false, range: [0, mm(counts.length * bin)] }, y: { range: [0, 1.08 * Math.max(...counts, ...expected)] } },
    axes: [axis('length of the residual, mm', 26), axis('poses', 64)],
    series: [{ label: 'length' },
      { label: 'measured', stroke: colour('actual'), fill: `${colour('actual')}55`, width: 1, paths: bars(uPlot.paths), points: { show: false } },
      ...(expected.length > 0 ? [{ label: `as stated: ${length(stated)} root mean square, normal`, stroke: colour('nominal'), width: 2, points: { show: false } }] : [])],
  }), [middles, counts, ...(expected.length > 0 ? [expected] : [])]);
}

// Means of groups of equal counts, each with its middle reading and twice its standard error.
function groupMeans(rows) {
  const size = Math.max(kFewest, Math.ceil(rows.length / kGroups));
  const groups = [];
  for (let start = 0; start + kFewest <= rows.length; start += size) {
    const group = rows.slice(start, start + size);
    if (group.length < kFewest) break;
    const mean = group.reduce((sum, { y }) => sum + y, 0) / group.length;
    const squares = group.reduce((sum, { y }) => sum + (y - mean) ** 2, 0);
    groups.push({ x: group.reduce((sum, { x }) => sum + x, 0) / group.length, mean, off: 2 * Math.sqrt(squares / (group.length - 1) / group.length) });
  }
  return groups;
}

// Rows of x, y and outlier as a scatter with the curve of their means.
function scatterChart(host, rows, labels, words) {
  rows.sort((a, b) => a.x - b.x);
  const kept = rows.filter(({ outlier }) => !outlier);
  const means = groupMeans(kept);
  const all = [...rows.map((row) => ({ x: row.x, row })), ...means.map((mean) => ({ x: mean.x, mean }))].sort((a, b) => a.x - b.x);
  const largest = 1.25 * Math.max(1e-6, ...kept.map(({ y }) => Math.abs(y)));
  const lowest = labels.signed ? -largest : 0;
  const clamp = (y) => Math.max(lowest, Math.min(largest, y));
  const tell = underPointer(host, `${kPoint} the chart for the pose nearest.`);
  const nearest = (index) => {
    for (let off = 0; off < all.length; ++off) for (const k of [index - off, index + off]) if (all[k]?.row) return words(all[k].row);
    return '';
  };
  const data = [all.map(({ x }) => x),
    all.map(({ row }) => (row && !row.outlier ? row.y : null)),
    all.map(({ row }) => (row?.outlier ? clamp(row.y) : null)),
    all.map(({ mean }) => mean?.mean ?? null), all.map(({ mean }) => (mean ? mean.mean + mean.off : null)), all.map(({ mean }) => (mean ? mean.mean - mean.off : null))];
  const shown = rows.some(({ outlier }) => outlier) ? [0, 1, 2, 3, 4, 5] : [0, 1, 3, 4, 5];
  const band = (label) => ({ label, stroke: colour('nominal'), width: 1, dash: [3, 3], spanGaps: true, points: { show: false } });
  return keepDrawn(host, () => {
    const series = [{ label: 'x' },
      { label: 'pose', stroke: colour('soft'), paths: () => null, points: { show: true, size: 3.5, width: 0, fill: `${colour('soft')}70`, stroke: colour('soft') } },
      { label: 'outlier', stroke: colour('rejected'), paths: () => null, points: { show: true, size: 10, width: 2, stroke: colour('rejected'), fill: 'transparent' } },
      { label: labels.mean, stroke: colour('nominal'), width: 2, spanGaps: true, points: { show: false } }, band('above'), band('below')];
    return {
      height: labels.height,
      legend: { show: false },
      cursor: { y: false, drag: { x: true, y: false } },
      hooks: pointing(tell, nearest),
      scales: { x: { time: false, range: (_, least, most) => [least, most] }, y: { range: [lowest, largest] } },
      axes: [axis(labels.x, 26, labels.unit), { ...axis(labels.y, 64), space: 24 }],
      series: shown.map((k) => series[k]),
    };
  }, shown.map((k) => data[k]));
}

const pose = ({ line }) => `line ${line}`;

export function readingChart(host, poses, joint, revolute) {
  const unit = revolute ? degrees : mm;
  const rows = poses.filter(({ along_m: along }) => along[joint] !== null)
    .map((at) => ({ x: unit(at.q[joint]), y: mm(at.along_m[joint]), outlier: at.outlier === 1, at }));
  if (rows.length < kFewest) return null;
  return scatterChart(host, rows, { x: `reading of joint ${joint + 1}${revolute ? '' : ', mm'}`, unit: revolute ? '°' : '', y: 'along its motion, mm', mean: 'mean', signed: true, height: 170 },
    ({ x, y, at }) => `${pose(at)}, at ${fixed(x, 2)}${revolute ? '°' : ' mm'}: ${fixed(y, 3)} mm`);
}

export function orderChart(host, poses) {
  const rows = poses.map((at) => ({ x: at.line, y: mm(norm(at.e)), outlier: at.outlier === 1, at }));
  return scatterChart(host, rows, { x: 'line of the file', unit: '', y: 'length of the residual, mm', mean: 'mean', signed: false, height: 200 },
    ({ y, at }) => `${pose(at)}: ${fixed(y, 3)} mm`);
}
