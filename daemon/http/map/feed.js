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

  open() {
    const source = new EventSource(this.url);
    source.addEventListener('open', () => this.told.state('open'));
    for (const kind of ['snapshot', 'update']) {
      source.addEventListener(kind, (event) => this.told[kind](JSON.parse(event.data)));
    }
    source.addEventListener('error', () => {
      if (source.readyState === EventSource.CLOSED) {
        this.told.state('refused');
        source.close();
        setTimeout(() => this.open(), AGAIN_MS);
      } else {
        this.told.state('lost');
      }
    });
  }
}
