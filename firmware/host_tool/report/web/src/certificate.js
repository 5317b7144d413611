// SPDX-License-Identifier: MIT
// The page to sign: who, what, with what; the budget of uncertainty; what was not measured.
import { bounded, element, fixed, foundFrom } from './text.js';

const by = (id) => document.getElementById(id);
const millimetres = (metres) => `${bounded(1e3 * metres, 3)} mm`;

export function certificate({ about, certificate: told }) {
  if (told === null) {
    by('certificate-section').replaceChildren(element('h2', {}, 'No page to sign'), element('p', { class: 'warning' }, about.other_measurements));
    return;
  }
  const rows = [
    ['Arm', about.arm], ['Serial number', told.serial],
    ['Identified', about.time.replace('T', ' ').replace('Z', ' UTC')],
    ['Operator', told.operator],
    ['Instrument', told.instrument], ['Its serial number', told.instrument_serial],
    ['Air', about.air_c === null ? '' : `${fixed(about.air_c, 1)} °C`],
    ['Signature', `${about.signature.name}, CRC-32 ${about.signature.crc32}`],
  ];
  rows.push(['Found from', foundFrom(about.origin)]);
  if (about.measurements) rows.push(['Measurements', `${about.measurements.name}, CRC-32 ${about.measurements.crc32}`]);
  by('certificate-about').append(element('tbody', {}, ...rows.map(([name, value]) =>
    element('tr', { class: 'first' }, element('th', { class: 'text' }, name), element('td', {}, value)))));
  by('certificate-lead').textContent = 'What was found, how sure it is, and what nobody has looked at. A line left empty is for the pen.';
  by('budget-lead').textContent = told.combined_m === null
    ? `The combined uncertainty${told.over ? ` over ${told.over}` : ''} is not known.`
    : `One standard deviation, all three directions together, root mean square over ${told.over}, in the frame of the instrument (GUM, JCGM 100).`;
  const line = (source, basis, sigma, kind = 'first') => element('tr', { class: kind },
    element('td', { class: 'text' }, source), element('td', {}, basis), element('td', {}, sigma));
  const body = element('tbody', {}, ...told.sources.map(({ source, basis, sigma_m: sigma }) => line(source, basis, sigma === null ? 'not in this' : sigma === 0 ? 'none seen' : millimetres(sigma))));
  if (told.combined_m !== null) {
    body.append(line('Combined standard uncertainty', 'root of the sum of squares of what is known', millimetres(told.combined_m), 'first sum'),
      line('Expanded uncertainty', 'coverage factor k = 2', millimetres(2 * told.combined_m), 'first sum'));
  }
  by('budget').append(element('thead', {}, element('tr', {}, ...['Source', 'How it is known', '1σ at the tool'].map((name) => element('th', {}, name)))), body);
  by('accuracy').append(...told.accuracy.map((text) => element('p', {}, text)));
  by('not-measured').append(...told.not_measured.map((text) => element('li', {}, text)));
}
