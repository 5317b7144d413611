// SPDX-License-Identifier: MIT
// Free poses: what the signature misses each of them by.
import { histogramChart, orderChart, readingChart } from './pose_charts.js';
import { degrees, element, fixed, length, phrase } from './text.js';
import { valueTable } from './values.js';

const kWorst = 10;
const by = (id) => document.getElementById(id);
const sizeOf = ({ e }) => Math.hypot(...e);

function lead({ fitted, signature, outliers, nominal, stated_rms_m: stated, shown_every: every, poses }, validation) {
  const of = fitted ? `The signature was fitted to these ${signature.rows} poses: what is left of each is its residual`
    : `These ${signature.rows} poses are not those that the signature was fitted to. What it misses them by is their residual`;
  const parts = [`${of}, ${length(signature.rms_m)} root mean square and ${length(signature.largest_m)} at most.`];
  if (fitted && validation) parts.push(`Residuals of a fit are smaller than errors elsewhere. The figure to state is that of the validation poses: ${length(validation.rms_m)}.`);
  if (stated > 0) parts.push(`The signature states ${length(stated)} root mean square for such poses, the sensor included.`);
  if (nominal !== null) parts.push(`The nominal model misses them by ${length(nominal.rms_m)}, its base and tool fitted.`);
  parts.push(outliers === 0 ? 'No pose is an outlier.' : `${outliers === 1 ? 'One pose is an outlier' : `${outliers} poses are outliers`}${fitted ? ', and had no weight in the fit' : ''}.`);
  if (every > 1) parts.push(`Of them ${poses.length} are drawn: every ${every}th, the worst and the outliers.`);
  return parts.join(' ');
}

function worstTable({ poses }, joints) {
  const sorted = poses.toSorted((a, b) => sizeOf(b) - sizeOf(a));
  const rows = sorted.filter((at, k) => k < kWorst || at.outlier === 1);
  const reading = (at) => at.q.map((q, i) => (joints[i].revolute ? `${fixed(degrees(q), 1)}°` : length(q))).join(' ');
  const cell = (text, kind) => element('td', kind ? { class: kind } : {}, text);
  const body = element('tbody', {}, ...rows.map((at) => {
    const row = element('tr', { class: 'first' }, cell(String(at.line), 'text'), cell(fixed(1e3 * sizeOf(at), 3), 'actual'),
      ...at.e.map((value) => cell(fixed(1e3 * value, 3))), cell(at.stated_m > 0 ? fixed(sizeOf(at) / at.stated_m, 1) : ''),
      cell(at.outlier === 1 ? 'outlier' : '', 'text'), cell(reading(at), 'text readings'));
    row.dataset.line = at.line;
    return row;
  }));
  by('worst').append(element('thead', {}, element('tr', {}, ...['Line', 'Length, mm', 'x, mm', 'y, mm', 'z, mm', '÷ stated 1σ', '', 'Joint readings']
    .map((name, k) => element('th', [0, 6, 7].includes(k) ? { class: 'text', scope: 'col' } : { scope: 'col' }, name)))), body);
}

// Returns what to call when colours change.
export function showPoses(report) {
  const { poses } = report;
  if (poses === null) {
    by('poses-section').remove();
    return () => {};
  }
  const joints = report.parameters.rows;
  const validation = report.verdict.validation;
  by('poses-lead').append(...phrase(lead(poses, validation)));
  const redraws = [];
  const largest = Math.max(...poses.poses.map(sizeOf));
  by('histogram').setAttribute('aria-label', `Histogram of the lengths of the residuals, ${length(poses.signature.mean_m)} on the mean, ${length(largest)} at most.`);
  redraws.push(histogramChart(by('histogram'), poses));
  worstTable(poses, joints);
  joints.forEach(({ revolute }, joint) => {
    const chart = element('div', { class: 'chart', role: 'img', 'aria-label': `Residuals against the reading of joint ${joint + 1}; the values are in a table below.` });
    const block = element('div', { class: 'by-reading' }, element('h4', {}, `Joint ${joint + 1}`), chart);
    by('by-reading').append(block);
    const redraw = readingChart(chart, poses.poses, joint, revolute);
    if (redraw === null) chart.replaceWith(element('p', { class: 'muted' }, 'This joint does not move the target, or too few poses tell.'));
    else redraws.push(redraw);
  });
  by('by-order').setAttribute('aria-label', 'Lengths of the residuals in the order of the file; the values are in a table below.');
  redraws.push(orderChart(by('by-order'), poses.poses));
  valueTable(by('poses-section'), 'Values of all poses drawn',
    ['line', 'target', ...joints.map(({ revolute }, i) => `q${i + 1}, ${revolute ? '°' : 'mm'}`), 'x, m', 'y, m', 'z, m', 'residual x, mm', 'y, mm', 'z, mm', 'length, mm', ''],
    () => poses.poses.map((at) => [String(at.line), String(at.target), ...at.q.map((q, i) => fixed(joints[i].revolute ? degrees(q) : 1e3 * q, 3)),
      ...at.p.map((value) => fixed(value, 6)), ...at.e.map((value) => fixed(1e3 * value, 4)), fixed(1e3 * sizeOf(at), 4), at.outlier === 1 ? 'outlier' : '']));
  return () => { for (const redraw of redraws) redraw(); };
}
