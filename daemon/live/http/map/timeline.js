// The moment that the map shows: the present, or a past one that this page has received, paused or
// advancing at some speed.
import {byId, clock, setText} from './draw.js';

export class Timeline {
  constructor(model) {
    this.model = model;
    this.moment = null;  // null: the present
    this.running = false;
    this.slider = byId('scrubber');
    this.slider.addEventListener('input', () => this.review(this.momentOf(Number(this.slider.value))));
    byId('play').addEventListener('click', () => this.toggle());
    byId('live').addEventListener('click', () => this.present());
  }

  get isPresent() {
    return this.moment === null;
  }

  present() {
    this.moment = null;
    this.running = false;
  }

  review(moment) {
    this.moment = moment;
    this.running = false;
  }

  toggle() {
    if (this.moment === null) this.review(this.model.now());
    else this.running = !this.running;
  }

  // A disabled button loses the focus, and a keyboard user the position on the page.
  enableLive(enabled) {
    const button = byId('live');
    if (!enabled && document.activeElement === button) byId('play').focus();
    button.disabled = !enabled;
  }

  momentOf(value) {
    const first = this.model.first ?? this.model.now();
    return first + (value / 1000) * (this.model.now() - first);
  }

  // The moment to show; `elapsed`: real time since the last call [ms].
  step(elapsed) {
    const now = this.model.now();
    if (this.moment !== null && this.running) {
      this.moment += elapsed * parseFloat(byId('speed').value);
      if (this.moment >= now) this.present();
    }
    const shown = this.moment ?? now;
    const first = this.model.first ?? now;
    const live = this.isPresent;
    const ago = Math.round((now - shown) / 1000);
    if (document.activeElement !== this.slider || live || this.running) {
      this.slider.value = live ? 1000 : Math.round((1000 * (shown - first)) / Math.max(1, now - first));
    }
    const text = live ? 'live' : `${clock(shown)}, ${ago} s ago`;
    setText(byId('time-shown'), text);
    this.slider.setAttribute('aria-valuetext', text);
    setText(byId('play'), live || this.running ? 'Pause' : 'Play');
    this.enableLive(!live);
    return shown;
  }
}
