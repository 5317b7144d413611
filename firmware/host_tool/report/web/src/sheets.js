// SPDX-License-Identifier: MIT
// Blocks of a document laid on sheets of paper: A4 and Letter have room for one. Each sheet says which document it is
// of, its page and how many there are.
import { element } from './text.js';

const kPixels = 96 / 25.4;         // a millimetre, as browsers have it
const kHeight = 247;               // mm: Letter less its margins
const kEdges = 24;                 // mm: head and foot of a sheet
const kRoom = (kHeight - kEdges) * kPixels;

// Heights as on paper, whatever the screen.
function heights(host, blocks) {
  const paper = element('div', { class: 'sheet paper' }, ...blocks);
  host.append(paper);
  const found = blocks.map((block) => block.getBoundingClientRect().height);
  paper.remove();
  return found;
}

function packed(host, blocks) {
  const pages = [];
  let used = Infinity;
  heights(host, blocks).forEach((height, k) => {
    if (used + height > kRoom) {
      pages.push([]);
      used = 0;
    }
    used += height;
    pages.at(-1).push(blocks[k]);
  });
  return pages;
}

export function layOut(host, [title, object], blocks) {
  const pages = packed(host, blocks);
  host.append(...pages.map((page, k) => element('div', { class: 'sheet' },
    element('div', { class: 'sheet-head' }, element(k === 0 ? 'h3' : 'p', { class: 'title' }, title), element('p', {}, object)),
    ...page,
    element('p', { class: 'sheet-foot' }, `${title}, ${object}`, element('span', {}, `page ${k + 1} of ${pages.length}`)))));
}
