// SPDX-License-Identifier: MIT
// Fills the page with the report that armsig put into it.
import { ArmView, hasWebGl } from './arm_view.js';
import { certificate } from './certificate.js';
import { residualChart } from './charts.js';
import { circleMagnification, drawCircle } from './circle_view.js';
import { differencesPicture } from './differences_picture.js';
import { showErrorMap } from './error_map.js';
import { showPoses } from './poses.js';
import { showReadingMaps } from './reading_maps.js';
import { aboutTable, differenceTable, gridTable, parameterTable } from './tables.js';
import { bounded, degrees, element, fixed, length, phrase } from './text.js';
import { valueTable } from './values.js';
import './page.css';

const report = JSON.parse(document.getElementById('report').textContent);
const by = (id) => document.getElementById(id);
const redraws = [];

function verdict() {
  const { about } = report;
  document.title = `${about.arm}: arm signature`;
  by('eyebrow').textContent = [about.arm, about.serial && `no. ${about.serial}`, about.time.slice(0, 10)].filter(Boolean).join(', ');
  by('headline').append(...phrase(report.verdict.headline));
  by('sentences').append(...report.verdict.sentences.map((text) => element('p', {}, ...phrase(text))));
  by('next-steps').append(...report.verdict.next_steps.map((text) => element('li', {}, ...phrase(text))));
  const warnings = [about.other_measurements, ...about.warnings].filter(Boolean);
  by('warnings').append(...warnings.map((text) => element('p', { class: 'warning' }, text)));
  by('version').textContent = about.version;
  const { before_after: figures, other_figures: others } = report.verdict;
  const largest = Math.max(...figures.map(({ rms_m: rms }) => rms));
  by('before-after').append(...figures.map(({ name, over, rms_m: rms }) => element('div', { class: 'bar' },
    element('span', {}, name),
    element('div', { class: 'track' }, element('div', { class: 'fill', style: `background:var(--${name.startsWith('Nominal') ? 'nominal' : 'actual'});width:${(100 * rms) / largest}%` })),
    element('span', { class: 'value' }, length(rms)), element('span', { class: 'over' }, `over ${over}`))));
  if (others.length === 0) by('other-figures').remove();
  else {
    by('other-figures-table').append(element('tbody', {}, ...others.map(({ name, over, rms_m: rms }) => element('tr', { class: 'first' },
      element('td', { class: 'text' }, name), element('td', { class: 'text' }, over), element('td', {}, length(rms))))));
  }
}

// Residuals of free poses, magnified on their own: they are far smaller than what the nominal model is wrong by.
function poseControls(view) {
  if (report.poses === null) {
    by('residuals-control').remove();
    by('poses-toggle').remove();
    for (const key of document.querySelectorAll('.key .of-poses')) key.remove();
    return;
  }
  const slider = by('residuals');
  const show = () => {
    const times = 10 ** slider.value;
    by('residuals-value').textContent = `× ${times < 10 ? times.toFixed(1) : Number(times.toPrecision(2))}`;
    slider.setAttribute('aria-valuetext', `${Number(times.toPrecision(2))} times`);
    view.magnifyPoses(times);
  };
  const wanted = Math.log10(view.poses.wanted());
  slider.max = (wanted + 1).toFixed(2);
  slider.value = wanted.toFixed(2);
  slider.addEventListener('input', show);
  by('show-poses').addEventListener('change', (event) => { view.poses.group.visible = event.target.checked; view.render(); });
  show();
}

function armControls(view) {
  const magnify = by('magnify');
  const pose = by('pose');
  pose.max = report.arm.frames.length - 1;
  const largest = view.largestDifference();
  // Beyond half the arm's size a difference is no picture of an arm any more.
  magnify.max = Math.max(1, Math.min(3.5, Math.log10((0.5 * view.size) / Math.max(largest, 1e-9)))).toFixed(2);
  magnify.value = Math.max(0, Math.min(3.3, Math.log10((0.16 * view.size) / Math.max(largest, 1e-9)))).toFixed(2);
  const show = () => {
    const times = 10 ** magnify.value;
    magnify.setAttribute('aria-valuetext', `${Math.round(10 * times) / 10} times`);
    by('magnify-value').textContent = `× ${times < 10 ? times.toFixed(1) : Math.round(times)}`;
    by('pose-value').textContent = pose.value === '0' ? 'signature configuration'
      : report.arm.frames[pose.value].q.map((q, i) => (report.parameters.rows[i].revolute ? `${Math.round(degrees(q))}°` : `${Math.round(1e3 * q)} mm`)).join(' ');
    pose.setAttribute('aria-valuetext', by('pose-value').textContent);
    view.set(Number(pose.value), times);
  };
  magnify.addEventListener('input', show);
  pose.addEventListener('input', show);
  by('show-sweeps').addEventListener('change', (event) => { view.sweeps.visible = event.target.checked; view.render(); });
  by('show-map').addEventListener('change', (event) => { view.map.visible = event.target.checked; view.render(); });
  let moving = false;
  let last = 0;
  // Who wants less motion gets a pose at a time.
  const pause_ms = () => (matchMedia('(prefers-reduced-motion: reduce)').matches ? 1500 : 90);
  const step = (now) => {
    if (!moving) return;
    if (now - last > pause_ms()) {
      last = now;
      pose.value = (Number(pose.value) + 1) % report.arm.frames.length;
      show();
    }
    requestAnimationFrame(step);
  };
  by('play').addEventListener('click', () => {
    moving = !moving;
    by('play').textContent = moving ? 'Stop' : 'Move';
    if (moving) requestAnimationFrame(step);
  });
  if (report.sweeps.length === 0) {
    by('sweeps-toggle').remove();
    for (const key of document.querySelectorAll('.key .of-sweeps')) key.remove();
  }
  show();
  redraws.push(() => view.repaint());
}

function sweepFacts(sweep) {
  const facts = [];
  if (sweep.revolute) {
    facts.push(`${fixed(degrees(sweep.highest - sweep.lowest), 1)}° of arc`, `radius ${length(sweep.radius_m)}`);
  } else {
    facts.push(`${length(sweep.highest - sweep.lowest)} of travel`);
  }
  facts.push(`${sweep.used} points`, sweep.rejected === 0 ? 'none rejected' : `${sweep.rejected} rejected`);
  return facts.join(', ');
}

function sweepRms(sweep) {
  const rms = (name, metres) => `${name} ${bounded(1e3 * metres, 3)}`;
  return `RMS, mm: ${sweep.revolute
    ? [rms('radial', sweep.rms_radial_m), rms('normal', sweep.rms_normal_m), rms('tangential', sweep.rms_tangential_m)].join(', ')
    : [rms('across', sweep.rms_normal_m), rms('along', sweep.rms_tangential_m)].join(', ')}`;
}

function sweeps(webGl) {
  if (report.sweeps.length === 0 && report.about.rows !== undefined) {
    by('sweeps-section').remove();
    return;
  }
  if (report.sweeps.length === 0) {
    by('sweeps').append(element('p', {}, 'With --measurements the page shows sweeps and free poses too.'));
    return;
  }
  for (const sweep of report.sweeps) {
    const chart = element('div', { class: 'chart', role: 'img', 'aria-label': `Residuals of joint ${sweep.joint}. ${sweepRms(sweep)}` });
    const canvas = element('canvas');
    const figure = element('figure', {}, canvas, element('figcaption'));
    const block = element('div', { class: 'sweep' },
      element('header', {}, element('h3', {}, `Joint ${sweep.joint}`), element('span', { class: 'facts' }, sweepFacts(sweep)),
        element('span', { class: 'facts' }, sweepRms(sweep))),
      figure, chart,
      element('p', { class: sweep.wave?.significant ? 'words found' : 'words muted' }, sweep.words));
    by('sweeps').append(block);
    redraws.push(residualChart(chart, sweep));
    const unit = sweep.revolute ? degrees : (metres) => 1e3 * metres;
    valueTable(block, `Values of joint ${sweep.joint}`,
      [sweep.revolute ? 'reading, °' : 'reading, mm', ...(sweep.revolute ? ['radial', 'normal', 'tangential'] : ['across', 'other way', 'along']).map((name) => `${name}, mm`), ''],
      () => sweep.points.map((point) => [fixed(unit(point[0]), 3), ...[2, 3, 4].map((k) => fixed(1e3 * point[k], 4)), point[5] ? 'rejected' : '']));
    if (!webGl || !sweep.revolute) {
      figure.remove();
      chart.style.gridColumn = '1 / -1';
      continue;
    }
    figure.querySelector('figcaption').textContent = `residuals × ${circleMagnification(sweep)}`;
    drawCircle(canvas, sweep);
    redraws.push(() => drawCircle(canvas, sweep));
  }
}

const webGl = hasWebGl();
let view = null;
verdict();
if (webGl) {
  view = new ArmView(by('arm'), report);
  armControls(view);
  poseControls(view);
} else {
  by('arm-section').querySelector('.stage').replaceChildren(element('p', { style: 'padding:16px' }, 'This browser has no WebGL: the arm can’t be shown in three dimensions.'));
  by('arm-section').querySelector('.controls').remove();
}
sweeps(webGl);
redraws.push(showPoses(report));
redraws.push(showReadingMaps(report));
differenceTable(report);
differencesPicture(report);
parameterTable(report);
redraws.push(showErrorMap(report, view));
gridTable(report);
aboutTable(report.about);
by('download').href = URL.createObjectURL(new Blob([JSON.stringify(report, null, 1)], { type: 'application/json' }));
certificate(report);

const redrawAll = () => { for (const redraw of redraws) redraw(); };
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redrawAll);
// Paper is white, and as wide as a sheet: charts are drawn anew for it.
function forPaper(on) {
  if (on) document.documentElement.dataset.theme = 'light';
  else delete document.documentElement.dataset.theme;
  document.documentElement.classList.toggle('on-paper', on);
  view?.resize();
  redrawAll();
}
addEventListener('beforeprint', () => forPaper(true));
addEventListener('afterprint', () => forPaper(false));
