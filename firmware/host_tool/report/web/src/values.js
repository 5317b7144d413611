// SPDX-License-Identifier: MIT
// What a chart shows, in words: under the pointer, and as a table for whoever wants all of it.
import { element } from './text.js';

// A line below `host` that tells what the pointer is at. Returns what to call with the words; '' where it is nowhere.
export function underPointer(host, hint) {
  const line = element('p', { class: 'under-pointer', 'aria-hidden': 'true' }, hint);
  host.after(line);
  return (words) => { line.textContent = words || hint; };
}

// A table that is made when it is opened: `rows` gives its cells, texts.
export function valueTable(host, name, columns, rows) {
  const details = element('details', { class: 'values' }, element('summary', {}, name));
  details.addEventListener('toggle', () => {
    if (!details.open || details.querySelector('table')) return;
    details.append(element('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': name }, element('table', {},
      element('thead', {}, element('tr', {}, ...columns.map((column) => element('th', { scope: 'col' }, column)))),
      element('tbody', {}, ...rows().map((row) => element('tr', {}, ...row.map((cell) => element('td', {}, cell))))))));
  });
  host.append(details);
}
