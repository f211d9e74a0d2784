// The messages that raylocd publishes. EventSource reconnects after a broken connection; after an
// answer that is no stream (503: too many viewers) it stops, and this code reconnects.
const AGAIN_MS = 5000;

export class Feed {
  // `told`: {snapshot(body), update(body), state('open' | 'lost' | 'refused')}
  constructor(url, told) {
    this.url = url;
    this.told = told;
    this.open();
  }

  // A connection that was lost without notice, as when a machine slept or went out of reach, is
  // indistinguishable from a silent one.
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
