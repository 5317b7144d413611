// SPDX-License-Identifier: MIT
// The tables: parameters, the grid task, what was measured.
import { bounded, decimalsFor, degrees, element, fixed, foundFrom, length, phrase } from './text.js';

const cell = (text, kind = '') => element('td', kind ? { class: kind } : {}, text);
const head = (...names) => element('thead', {}, element('tr', {}, ...names.map((name, k) => element('th', k < 2 ? { class: 'text' } : {}, name))));

const kParameters = [
  { key: 'theta_rad', name: 'θ', more: ' offset', unit: '°', scale: degrees, least: 3, most: 4 },
  { key: 'd_m', name: 'd', unit: 'mm', scale: (m) => 1e3 * m, least: 2, most: 4 },
  { key: 'a_m', name: 'a', unit: 'mm', scale: (m) => 1e3 * m, least: 2, most: 4 },
  { key: 'alpha_rad', name: 'α', unit: '°', scale: degrees, least: 3, most: 4 },
];

// Degrees or millimetres; a parameter known no better tells nothing.
const kTelling = 0.5;

const turn = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

export function parameterTable(report) {
  const table = document.getElementById('parameters');
  const body = element('tbody');
  const last = report.parameters.rows.length;
  let far = false;
  for (const row of report.parameters.rows) {
    kParameters.forEach(({ key, name, more, unit, scale, least, most }, k) => {
      const sigma = row.sigma === null ? null : scale(row.sigma[key]);
      const decimals = decimalsFor(sigma, sigma !== null && sigma > 1 ? 0 : least, most);
      // θ and d of the first row and all of the last depend on where their outer frames are put; d and a on both
      // sides of a slide on where its line is, which has a direction alone.
      const slides = !row.revolute || report.parameters.rows[row.joint]?.revolute === false;
      const outer = (row.joint === 1 && k < 2) || row.joint === last;
      // Beside a far common normal these mean nothing by themselves.
      const large = !outer && Math.abs(row.actual.d_m) > 2 && (key === 'd_m' || (k < 3 && !(sigma < kTelling)));
      const free = outer || (slides && !large && (key === 'd_m' || key === 'a_m'));
      far ||= large;
      let difference = row.actual[key] - row.nominal[key];
      if (unit === '°') difference = turn(difference);
      const tr = element('tr', k === 0 ? { class: 'first' } : {},
        k === 0 ? element('td', { class: 'text' }, String(row.joint), element('span', { class: 'type' }, row.revolute ? ' revolute' : ' prismatic')) : cell('', 'text'),
        element('td', { class: 'text' }, name, ...(more ? [element('span', { class: 'type' }, more)] : []), `, ${unit}${free ? ' †' : ''}${large ? ' *' : ''}`),
        cell(fixed(scale(row.nominal[key]), least)),
        cell(fixed(scale(row.actual[key]), decimals), 'actual'),
        cell(sigma === null || sigma === 0 ? '' : `± ${fixed(sigma, decimals)}`, 'sigma'),
        cell(free || large ? '' : fixed(scale(difference), decimals)));
      tr.dataset.joint = row.joint;
      tr.dataset.parameter = key;
      body.append(tr);
    });
  }
  table.append(head('Joint', 'Parameter', 'Nominal', 'Signature', '1σ', 'Difference'), body);
  const notes = document.getElementById('parameter-notes');
  const line = report.parameters.rows.some(({ revolute }) => !revolute) ? ', or of where the line of a slide is put' : '';
  notes.append(element('p', {}, `† depends on the choice of the first or last frame${line}, which is free.`));
  if (far) notes.append(element('p', { id: 'near-parallel' }, `* ${report.parameters.near_parallel.replace(/\s+/g, ' ').trim()}`));
  if (report.parameters.rows[0].sigma === null) notes.append(element('p', {}, 'The signature says nothing of its own uncertainty: no 1σ.'));
}

const kUnits = {
  rad: { unit: '°', scale: degrees },
  m: { unit: '\u00a0mm', scale: (m) => 1e3 * m },
  '': { unit: '\u00a0%', scale: (share) => 100 * share },
};

// Not one number: told is the largest change from the signature configuration within the joint limits.
const kVarying = ['map', 'gravity'];

export function differenceTable(report) {
  const { differences } = report;
  if (differences === null) {
    document.getElementById('differences-section').remove();
    return;
  }
  document.getElementById('differences-lead').append(...phrase(
    `The nominal model, its base and tool fitted, is ${length(differences.total_rms_m)} (root mean square over the joint limits) from this arm. From where that comes:`));
  const millimetres = (metres) => fixed(1e3 * metres, 3);
  const body = element('tbody');
  let joint = 0;
  for (const line of differences.joints) {
    const key = ['rad', 'm', ''].find((name) => `value${name && `_${name}`}` in line);
    const { unit, scale } = kUnits[key];
    const suffix = key && `_${key}`;
    const known = line[`sigma${suffix}`] !== null;
    const sigma = known ? scale(line[`sigma${suffix}`]) : null;
    const decimals = decimalsFor(sigma, 3, 4);
    const tr = element('tr', line.joint === joint ? {} : { class: 'first' },
      cell(line.joint === joint ? '' : line.joint, 'text'), cell(line.what.replace(/ (\d)/g, '\u00a0$1'), 'text'),
      cell(`${kVarying.includes(line.kind) ? 'up to ' : ''}${fixed(scale(line[`value${suffix}`]), decimals)}${unit}`, 'actual'),
      cell(known ? `± ${fixed(sigma, decimals)}` : '', 'sigma'),
      cell(millimetres(line.effect_rms_m)), cell(millimetres(line.adds_m)));
    tr.dataset.kind = line.kind;
    body.append(tr);
    joint = line.joint;
  }
  body.append(element('tr', { class: 'first' }, cell('all', 'text'), cell('base and tool fitted', 'text'), cell(''), cell(''),
    cell(millimetres(differences.total_rms_m)), cell(millimetres(differences.total_rms_m))));
  if (!differences.joints.some(({ kind }) => kVarying.includes(kind))) document.getElementById('varying-note').remove();
  document.getElementById('differences').append(head('Joint', 'What', 'Difference', '1σ', 'Effect, mm', 'Adds, mm'), body);
}

export function gridTable(report) {
  const { grid } = report;
  if (grid === null) {
    document.getElementById('grid-section').remove();
    return;
  }
  const size = grid.grid_m.map((metres) => Math.round(100 * metres)).join(' × ');
  document.getElementById('grid-lead').textContent =
    `A tool sent to every point of a grid of ${size} cm, by the nominal model and by the signature. ` +
    (grid.drawn_arms === 0
      ? 'The true arm is known, as it is simulated.'
      : `The true arm is not known: medians over ${grid.drawn_arms} arms that the measurements allow` +
        `${report.reading_maps ? ', all with gravity and the joint error maps as they were found: how uncertain those are is not in this table' : ''}.`);
  // The measuring machine of the task rounds (core/evaluation/indices.hpp): nought is below half of its step.
  const rounded = (words, half) => (value) => (value === 0 ? `< ${words(half)}` : words(value));
  const angle = rounded((radians) => `${bounded(degrees(radians), 3)}°`, (0.005 * Math.PI) / 180);
  const distance = rounded(length, 12.7e-6);
  const rows = [
    ['normal_deviation_m', 'Largest deviation from a straight line', distance],
    ['perpendicular_deviation_rad', 'Largest deviation from a right angle', angle],
    ['radial_deviation_m', 'Largest distance of a point from its place', distance],
    ['orientation_deviation_rad', 'Largest turn of the tool', angle],
  ];
  const body = element('tbody');
  rows.forEach(([key, name, words], k) => {
    body.append(element('tr', { class: 'first' }, cell(name, 'text'), cell(words(grid.ideal[key])),
      cell(words(grid.with_signature[key]), 'actual'), cell(`${fixed(grid.improvement[k], 1)} ×`)));
  });
  document.getElementById('grid').append(
    element('thead', {}, element('tr', {}, element('th', { class: 'text' }, 'What'), ...['Nominal', 'Signature', 'Better by'].map((name) => element('th', {}, name)))), body);
}

export function aboutTable(about) {
  const rows = [
    ['Arm', about.serial ? `${about.arm}, serial number ${about.serial}` : about.arm],
    ['Method', { paper: 'features by the fit of the 1986 paper', encoder: 'circles that follow the joint reading', refined: 'maximum likelihood over everything measured', exact: 'computed, not measured' }[about.method] ?? about.method],
    ['Identified', about.time.replace('T', ' ').replace('Z', ' UTC')],
    ['Air', about.air_c === null ? 'temperature not stated' : `${fixed(about.air_c, 1)} °C`],
    ['Program', `armsig ${about.version}`],
    ['Units', 'lengths in millimetres, angles in degrees; ± is one standard deviation (1σ)'],
    ['Signature', `${about.signature.name}, CRC-32 ${about.signature.crc32}`],
  ];
  rows.push(['Found from', foundFrom(about.origin)]);
  if (about.measurements) rows.push([about.other_measurements ? 'Other measurements' : 'Measurements', `${about.measurements.name}, CRC-32 ${about.measurements.crc32}`]);
  if (about.rows !== undefined) {
    const parts = [`${about.rows} rows`];
    if (about.rows_not_located > 0) parts.push(`${about.rows_not_located} without a usable position`);
    if (about.rows_mixed > 0) parts.push(`${about.rows_mixed} poses outside the sweeps`);
    rows.push(['Rows', parts.join(', ')]);
  }
  // Next to nothing stands for a sigma that nobody stated.
  if (about.noise_m !== null) rows.push(['Noise and model error, 1σ', `${length(about.noise_m)} per axis, as the fit found it`]);
  document.getElementById('about').append(element('tbody', {}, ...rows.map(([name, value]) => element('tr', { class: 'first' }, element('th', { class: 'text' }, name), element('td', {}, value)))));
}
