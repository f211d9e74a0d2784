// What raylocd publishes, as it comes. EventSource comes back by itself after a broken connection;
// after an answer that is no stream (503: too many viewers) it gives up, and we begin again.
const AGAIN_MS = 5000;

export class Feed {
  // told: {snapshot(body), update(body), state('open' | 'lost' | 'refused')}
  constructor(url, told) {
    this.url = url;
    this.told = told;
    this.open();
  }

  // A connection that was lost without a word, as when a machine slept or went out of reach, looks
  // like one on which nothing is said.
  reopen() {
    this.close();
    this.told.state('lost');
    this.open();
  }

  close() {
    this.source.close();
    clearTimeout(this.again);
    this.closed = true;
  }

  open() {
    this.closed = false;
    this.opened = performance.now();
    const source = new EventSource(this.url);
    this.source = source;
    source.addEventListener('open', () => this.told.state('open'));
    for (const kind of ['snapshot', 'update']) {
      source.addEventListener(kind, (event) => this.told[kind](JSON.parse(event.data)));
    }
    source.addEventListener('error', () => {
      if (source.readyState === EventSource.CLOSED) {
        this.told.state('refused');
        source.close();
        this.again = setTimeout(() => this.open(), AGAIN_MS);
      } else {
        this.told.state('lost');
      }
    });
  }
}
