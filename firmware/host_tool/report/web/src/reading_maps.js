// SPDX-License-Identifier: MIT
// What the arm does beyond its geometry: the map of each reading with its band, gravity's share.
import { readingMapChart } from './charts.js';
import { degrees, element, fixed, length, phrase } from './text.js';
import { valueTable } from './values.js';

// A map this small, rad or m, is none.
const kNothing_m = 1e-8;

const range = (joint) => joint.covered
  .map((reading) => (joint.revolute ? `${fixed(degrees(reading), 0)}°` : length(reading))).join(' to ');

function facts(joint) {
  const largest = joint.revolute ? `${fixed(degrees(joint.largest), 4)}°` : length(joint.largest);
  return [`measured from ${range(joint)}`, `at most ${largest}`, `${length(joint.tool_rms_m)} RMS at the tool`].join(', ');
}

// The chart as a table; every reading that the curve is drawn by.
function tableOf(card, joint) {
  const unit = joint.revolute ? degrees : (metres) => 1e3 * metres;
  const sign = joint.revolute ? '°' : 'mm';
  valueTable(card, `Values of the map of joint ${joint.joint}`,
    [`reading, ${sign}`, `map, ${sign}`, `1σ, ${sign}`, 'at the tool, mm', 'measured'],
    () => joint.curve.map(([reading, map, sigma, measured]) => [fixed(unit(reading), 1), fixed(unit(map), 4), fixed(unit(sigma), 4),
      fixed(1e3 * joint.tool_m_per_unit * map, 3), measured === 1 ? 'yes' : 'no']));
}

// Returns what to call when colours change.
export function showReadingMaps({ reading_maps: maps }) {
  const section = document.getElementById('maps-section');
  if (maps === null) {
    section.remove();
    return () => {};
  }
  const gravity = maps.gravity_terms === 0 ? 'Gravity has no share that was found.'
    : `Gravity moves the tool by ${length(maps.gravity_rms_m)} RMS, ${length(maps.gravity_largest_m)} at most.`;
  document.getElementById('maps-lead').append(...phrase(`Transmissions and encoders read a little wrong, each in a way of its own that repeats: `
    + `that is worth ${length(maps.maps_rms_m)} RMS at the tool over the readings that were measured. ${gravity}`));
  const redraws = maps.joints.map((joint) => {
    if (joint.tool_rms_m < kNothing_m && joint.largest < kNothing_m) {
      document.getElementById('maps').append(element('div', { class: 'sweep' }, element('header', {}, element('h3', {}, `Joint ${joint.joint}`),
        element('span', { class: 'facts' }, `measured from ${range(joint)}`)), element('p', { class: 'words muted' }, 'No map: the measurements show none, or do not determine it.')));
      return () => {};
    }
    const chart = element('div', { class: 'chart', style: 'grid-column: 1 / -1' });
    const card = element('div', { class: 'sweep' },
      element('header', {}, element('h3', {}, `Joint ${joint.joint}`), element('span', { class: 'facts' }, facts(joint))), chart);
    document.getElementById('maps').append(card);
    tableOf(card, joint);
    return readingMapChart(chart, joint);
  });
  return () => { for (const redraw of redraws) redraw(); };
}
