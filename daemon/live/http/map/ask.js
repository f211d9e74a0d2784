// Requests to raylocd. Paths are relative to the page, which may be located below a path of another
// server. A request without an answer in time fails, so that no caller waits for ever.
const PATIENCE_MS = 5000;

// Returns the answer; throws an Error with the reason, as text for people.
export async function answerOf(path, options = {}, patience = PATIENCE_MS) {
  const answer = await fetch(path, {...options, signal: AbortSignal.timeout(patience)}).catch((error) => {
    throw new Error(error.name === 'TimeoutError' ? `no answer within ${patience / 1000} s` : 'raylocd does not answer');
  });
  if (answer.ok) return answer;
  const {error} = await answer.json().catch(() => ({error: `an answer that is no JSON (${answer.status})`}));
  throw new Error(error || `${path}: ${answer.status}`);
}

// The same as JSON, which may state an error itself.
export async function ask(path, options, patience) {
  const answer = await answerOf(path, options, patience);
  const body = await answer.json().catch(() => ({error: `an answer that is no JSON (${answer.status})`}));
  if (body.error) throw new Error(body.error);
  return body;
}
