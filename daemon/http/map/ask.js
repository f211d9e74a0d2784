// Questions to raylocd. Paths are relative to the page, which may stand below a path of another server.
// One that is not answered in time fails, so that nothing waits for ever.
const PATIENCE_MS = 5000;

// What is answered, as JSON; else an Error that says why, in words for people.
export async function ask(path, options = {}, patience = PATIENCE_MS) {
  const answer = await fetch(path, {...options, signal: AbortSignal.timeout(patience)}).catch((error) => {
    throw new Error(error.name === 'TimeoutError' ? `no answer within ${patience / 1000} s` : 'raylocd does not answer');
  });
  const body = await answer.json().catch(() => ({error: `an answer that is no JSON (${answer.status})`}));
  if (!answer.ok || body.error) throw new Error(body.error || `${path}: ${answer.status}`);
  return body;
}
