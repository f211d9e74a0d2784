// The survey in progress: the person taps the current position; raylocd counts the frames.
import {ask} from './ask.js';
import {byId, html, number, setText, svg} from './draw.js';

const AGAIN_MS = 1000;
const ENOUGH = 20;  // frames of each access point, as in rayloc survey

export class Survey {
  constructor(view, say) {
    this.view = view;
    this.say = say;
    this.told = null;
    byId('survey-keep').addEventListener('click', () => this.ask('do=keep'));
    byId('survey-leave').addEventListener('click', () => this.ask('do=leave'));
  }

  // Only if a survey is in progress.
  async begin() {
    try {
      this.show(await ask('api/v1/survey'));
    } catch (error) {
      this.say(`The survey cannot be read: ${error.message}`, 'bad');
    }
  }

  stand([x, y], z) {
    return this.ask(new URLSearchParams({do: 'stand', x, y, z}));
  }

  async ask(what) {
    try {
      this.show(await ask(`api/v1/survey?${what}`, {method: 'POST', headers: {'X-RayLoc-Control': '1'}}));
    } catch (error) {
      this.say(error.message, 'bad');
    }
  }

  show(told) {
    this.told = told;
    const there = told.file !== '';
    byId('survey').hidden = !there;
    byId('survey-tool').hidden = !there;
    byId('live-map').hidden = !there;
    if (!there) return;
    const {standing, points} = told;
    byId('survey-keep').disabled = byId('survey-leave').disabled = !standing;
    const enough = standing && Object.values(standing.frames).every((count) => count >= ENOUGH);
    setText(byId('survey-text'), standing
      ? `At ${standing.position.map((v) => number(v)).join(', ')} for ${Math.round(standing.seconds)} s${enough ? ': enough' : ''}`
      : `${points.length} points in ${told.file}. Choose “I am here” and tap your place.`);
    byId('survey-rows').replaceChildren(...Object.entries(standing?.frames ?? {}).map(([name, count]) => html('tr', {}, [
      html('th', {scope: 'row'}, [name]), html('td', {class: count >= ENOUGH ? 'good' : ''}, [`${count} of ${ENOUGH} frames`])])));
    this.place();
    clearTimeout(this.again);
    if (standing) this.again = setTimeout(() => this.begin(), AGAIN_MS);
  }

  place() {
    if (!this.told) return;
    const dot = ([x, y], kind) => svg('g', {transform: this.view.mark(x, y)}, [svg('circle', {class: kind, r: 6})]);
    byId('survey-points').replaceChildren(
      ...this.told.points.map((at) => dot(at, 'surveyed')),
      ...(this.told.standing ? [dot(this.told.standing.position, 'standing')] : []));
  }
}
