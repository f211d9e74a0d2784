// The other sites of this raylocd, if it has several: links from map to map.
import {ask} from './ask.js';
import {byId, html} from './draw.js';

const AGAIN_MS = 10_000;

// isQuiet(): returns true while raylocd does not answer; no request is sent then.
export function offerSites(isQuiet) {
  const choice = byId('site-choice');
  const here = new URL('.', document.baseURI).pathname;
  let shown = '';
  choice.addEventListener('change', () => location.assign(choice.value));
  const look = async () => {
    try {
      const sites = isQuiet() || document.hidden ? null : await ask('api/v1/sites');
      if (sites && JSON.stringify(sites.map((site) => site.name)) !== shown) {
        shown = JSON.stringify(sites.map((site) => site.name));
        choice.replaceChildren(...sites.map((site) => html('option', {value: site.path}, [site.name])));
        choice.value = sites.find((site) => new URL(site.path, document.baseURI).pathname === here)?.path ?? '';
        byId('sites').hidden = sites.length < 2;
      }
      if (sites) {
        const mine = sites.find((site) => new URL(site.path, document.baseURI).pathname === here) ?? sites[0];
        byId('edit').hidden = !mine?.editable;
      }
    } catch {
      // The map itself reports that raylocd does not answer.
    }
    setTimeout(look, AGAIN_MS);
  };
  look();
}
