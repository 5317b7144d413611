// SPDX-License-Identifier: MIT
// What the arm does beyond its geometry: the map of each reading with its band, gravity's share.
import { readingMapChart } from './charts.js';
import { degrees, element, fixed, length } from './text.js';

const range = (joint) => joint.covered
  .map((reading) => (joint.revolute ? `${fixed(degrees(reading), 0)}°` : length(reading))).join(' to ');

function facts(joint) {
  const largest = joint.revolute ? `${fixed(degrees(joint.largest), 4)}°` : length(joint.largest);
  return [`measured from ${range(joint)}`, `at most ${largest}`, `${length(joint.tool_rms_m)} RMS at the tool`].join(', ');
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
  document.getElementById('maps-lead').textContent = `Transmissions and encoders read a little wrong, each in a way of its own that repeats: `
    + `that is worth ${length(maps.maps_rms_m)} RMS at the tool over the readings that were measured. ${gravity}`;
  const redraws = maps.joints.map((joint) => {
    const chart = element('div', { class: 'chart', style: 'grid-column: 1 / -1' });
    document.getElementById('maps').append(element('div', { class: 'sweep' },
      element('header', {}, element('h3', {}, `Joint ${joint.joint}`), element('span', { class: 'facts' }, facts(joint))), chart));
    return readingMapChart(chart, joint);
  });
  return () => { for (const redraw of redraws) redraw(); };
}
