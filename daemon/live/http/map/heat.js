// The places of targets in the last hours, on the floor: the daemon's sums, without identities.
import {ask} from './ask.js';
import {byId, setText, svg} from './draw.js';
import {stayText} from './words.js';

const ASK_MS = 5000;
export const SHADES = 5;  // map.css
const LEAST = 1;  // [s], shortest stay that is shown

// A stay longer by a factor is darker by a step, as a sitting person would outweigh all who pass.
export function shadeOf(stay, longest) {
  if (longest <= LEAST) return SHADES - 1;
  const share = Math.log(Math.max(stay, LEAST) / LEAST) / Math.log(longest / LEAST);
  return Math.min(SHADES - 1, Math.floor(share * SHADES));
}

export class Heat {
  constructor(changed) {
    this.changed = changed;
    this.shown = false;
    byId('heat-look').addEventListener('click', () => this.toggle());
  }

  toggle() {
    this.shown = !this.shown;
    byId('heat-look').setAttribute('aria-pressed', String(this.shown));
    byId('heat-text').hidden = !this.shown;
    byId('heat').replaceChildren();
    setText(byId('heat-text'), '');
    this.look();
  }

  // Called while the panel is visible.
  async look() {
    clearTimeout(this.next);
    if (!this.shown) return;
    try {
      const presence = await ask('api/v1/presence');
      if (!this.shown) return;
      this.show(presence);
    } catch (error) {
      if (!this.shown) return;
      setText(byId('heat-text'), `The presence map cannot be read: ${error.message}.`);
    }
    this.changed();
    this.next = setTimeout(() => this.look(), ASK_MS);
  }

  show({cells, cell_m: side, kept_s: kept}) {
    const stays = cells.filter(([, , stay]) => stay >= LEAST);
    const longest = Math.max(0, ...stays.map(([, , stay]) => stay));
    byId('heat').replaceChildren(...stays.map(([x, y, stay]) => svg('rect', {
      class: `heat-${shadeOf(stay, longest)}`, x: x - side / 2, y: y - side / 2, width: side, height: side,
    }, [svg('title', {}, [stayText(stay)])])));
    const of = kept >= 7200 ? `${Math.round(kept / 3600)} h` : stayText(kept);
    setText(byId('heat-text'), stays.length === 0 ? `No target was located in the last ${of}.`
      : `Presence in the last ${of}: the darker, the longer; ${stayText(longest)} at the darkest place.`);
  }

  place(view) {
    byId('heat').setAttribute('transform', view.matrix());
  }
}
