// SPDX-License-Identifier: MIT
// The calibration certificate, by clause 7.8 of ISO/IEC 17025 (docs/certificate.md). It is laid out in sheets of its own, each
// with the certificate's number, its page and how many there are.
import { bounded, element, fixed, foundFrom } from './text.js';
import { layOut } from './sheets.js';

const by = (id) => document.getElementById(id);
const millimetres = (metres) => `${bounded(1e3 * metres, 3)} mm`;
const scrolled = (label, table) => element('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': label }, table);
const head = (...names) => element('thead', {}, element('tr', {}, ...names.map((name, k) => element('th', k === 0 ? { class: 'text', scope: 'col' } : { scope: 'col' }, name))));
const block = (name, ...children) => element('div', { class: 'block' }, ...(name ? [element('h3', {}, name)] : []), ...children);

const kMethods = {
  paper: 'features by the fit of the 1986 paper', encoder: 'circles that follow the joint reading',
  refined: 'maximum likelihood over everything measured', exact: 'computed, not measured',
};

function form(id, rows) {
  return element('table', { class: 'form', id }, element('tbody', {}, ...rows.map(([name, value]) =>
    element('tr', { class: 'first' }, element('th', { class: 'text', scope: 'row' }, name), element('td', {}, value)))));
}

function identification(about, told) {
  return [
    block('', form('certificate-about', [
      ['Issued by', told.laboratory], ['Customer', told.customer],
      ['Object', `Robot arm, ${about.arm}`], ['Serial number', told.serial],
      ['Calibrated', 'Kinematic parameters of the arm: position of the tool from the joint readings'],
      ['Method', `${kMethods[about.method] ?? about.method}; armsig ${about.version}${about.origin?.options ? `, ${about.origin.options}` : ''}`],
      ['Place of the measurements', told.place], ['Day of the measurements', told.measured_on],
      ['Measured by', told.operator],
    ])),
    block('Conditions', form('certificate-conditions', [
      ['Air', about.air_c === null ? '' : `${fixed(about.air_c, 1)} °C`], ['Load, warm-up and others', told.conditions],
    ])),
    block('Instrument and traceability', form('certificate-instrument', [
      ['Instrument', told.instrument], ['Its serial number', told.instrument_serial],
      ['Its calibration certificate', told.instrument_certificate],
    ]), element('p', { id: 'traceability' }, told.instrument_certificate
      ? 'Lengths are traceable to the metre through the certificate of the instrument that is named here.'
      : 'Without a certificate of the instrument the lengths of this certificate are not traceable.')),
    block('Origin of the data', form('certificate-origin', [
      ['Measurements', foundFrom(about.origin)],
      ...(about.measurements ? [['File of the measurements', `${about.measurements.name}, CRC-32 ${about.measurements.crc32}`]] : []),
      ['Signature', `${about.signature.name}, CRC-32 ${about.signature.crc32}`],
      ['Computed', about.time.replace('T', ' ').replace('Z', ' UTC')],
    ])),
  ];
}

function adjustment({ adjustment: lines }) {
  const value = (metres) => element('td', {}, metres === null ? 'not stated' : millimetres(metres));
  const body = element('tbody', {}, ...lines.map(({ parameters, basis, mean_m: mean, rms_m: rms, largest_m: largest }) => element('tr', { class: 'first' },
    element('td', { class: 'text' }, parameters), element('td', {}, basis), value(rms), value(mean), value(largest))));
  return block('Error of the tool’s position, before and after adjustment',
    scrolled('Before and after adjustment', element('table', { id: 'adjustment' }, head('Parameters', 'Poses', 'Root mean square', 'Mean', 'Largest'), body)),
    element('p', {}, 'Adjusted are parameters, not the arm. Whether a controller uses them is not part of this certificate: poses measured with them in use show it.'));
}

const percent = (share, digits = 0) => `${fixed(100 * share, digits)} %`;

// How the expanded uncertainty came about, so that a reader can do it again.
function coverage({ expanded }) {
  if (expanded === null) return [];
  const freedom = expanded.freedom > 0 ? ` The noise was found with ${fixed(expanded.freedom, 0)} degrees of freedom, by Student’s law in three directions.` : '';
  return [element('p', { id: 'coverage' }, `The expanded uncertainty is the length that the error stays below with a coverage probability of ${percent(expanded.probability)}, over the same poses. `
    + `It is the combined standard uncertainty of the length times k = ${fixed(expanded.factor, 2)}, from the principal axes of the error at each pose. `
    + `Of the standard uncertainty of one direction, a third of the variance, that is ${fixed(expanded.factor_per_axis, 2)} times: twice it would cover ${percent(expanded.probability_at_2)}.${freedom}`)];
}

function uncertainty(told) {
  const line = (source, basis, sigma, kind = 'first') => element('tr', { class: kind },
    element('td', { class: 'text' }, source), element('td', {}, basis), element('td', {}, sigma));
  const body = element('tbody', {}, ...told.sources.map(({ source, basis, sigma_m: sigma }) => line(source, basis, sigma === null ? 'not in this' : sigma === 0 ? 'none seen' : millimetres(sigma))));
  if (told.combined_m !== null) body.append(line('Combined standard uncertainty', 'root of the sum of squares of what is known', millimetres(told.combined_m), 'first sum'));
  if (told.expanded !== null) {
    body.append(line('Expanded uncertainty', `coverage factor k = ${fixed(told.expanded.factor, 2)}, coverage probability ${percent(told.expanded.probability)}`,
      millimetres(told.expanded.length_m), 'first sum'));
  }
  return block('Uncertainty of the tool’s position', element('p', { id: 'budget-lead' }, told.combined_m === null
    ? `The combined uncertainty${told.over ? ` over ${told.over}` : ''} is not known.`
    : `Predicted one standard deviation of the length, root mean square over ${told.over}, in the frame of the instrument (GUM, JCGM 100).`),
  scrolled('Uncertainty budget', element('table', { id: 'budget' }, head('Source', 'How it is known', '1σ at the tool'), body)), ...coverage(told));
}

const kStatements = [
  'The results are of the arm named here, as it was when it was measured, and of no other.',
  'No statement of conformity with a specification is made, and no decision rule is applied.',
  'No opinion and no interval of recalibration is part of this certificate.',
  'What the laboratory did not find itself (names, place, conditions, instrument) is as it was stated to the program.',
  'The program claims no accreditation. Parts of the certificate are not to be copied without the approval of who issues it.',
];

function results(told) {
  return [
    adjustment(told), uncertainty(told),
    block('Accuracy and repeatability', element('div', { id: 'accuracy' }, ...told.accuracy.map((text) => element('p', {}, text)))),
    block('Not measured', element('ul', { id: 'not-measured' }, ...told.not_measured.map((text) => element('li', {}, text)))),
    // A signature stands below something.
    block('Statements', element('ul', { id: 'statements' }, ...kStatements.map((text) => element('li', {}, text))), element('div', { class: 'signatures' }, ...['Measured by', 'Authorised by (name, signature)', 'Date of issue'].map((text) => element('p', {}, text))),
      element('p', { class: 'end' }, 'End of the certificate')),
  ];
}

export function certificate({ about, certificate: told }) {
  if (told === null) {
    by('certificate-section').replaceChildren(element('h2', {}, 'No certificate'), element('p', { class: 'warning' }, about.other_measurements));
    return;
  }
  by('certificate-lead').textContent = 'What was found, how sure it is, and what nobody has looked at. A line left empty is for the pen.';
  const title = [`Calibration certificate ${told.number}`, [about.arm, told.serial && `no. ${told.serial}`].filter(Boolean).join(', ')];
  layOut(by('sheets'), title, [...identification(about, told), ...results(told)]);
  by('print-certificate').addEventListener('click', () => {
    document.body.classList.add('certificate-alone');
    print();
  });
  if (location.hash === '#certificate-alone') document.body.classList.add('certificate-alone');
  else addEventListener('afterprint', () => document.body.classList.remove('certificate-alone'));
}
