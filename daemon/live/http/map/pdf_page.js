// A page of a PDF as a picture: a browser gives a page none, so the server converts it
// (daemon/live/studio/pdf_page.h). The picture is not kept there.
import {ask, answerOf} from './ask.js';

const AGAIN_MS = 200;
const PATIENCE_MS = 60_000;  // for the transfer of the file, and of the picture
const HEADERS = {'X-RayLoc-Control': '1'};
const HEAD_BYTES = 1024;  // readers accept a PDF that begins within these

export const isPdf = async (file) => /\.pdf$/i.test(file.name) || (await file.slice(0, HEAD_BYTES).text()).includes('%PDF-');

// {blob, page, pages, millimetres, remark}; null if isWanted() became false meanwhile.
export async function pageOf(file, page, isWanted) {
  const post = (what, options = {}) => [`api/v1/edit/${what}`, {method: 'POST', headers: HEADERS, ...options}, PATIENCE_MS];
  const {number} = await ask(...post(`pdf?${new URLSearchParams({page})}`, {headers: {...HEADERS, 'Content-Type': 'application/pdf'}, body: file}));
  for (;;) {
    if (!isWanted()) return null;
    const {running, ...about} = await ask(...post(`page?number=${number}`));
    if (!running) return {...about, blob: await (await answerOf(...post(`picture?number=${number}`))).blob()};
    await new Promise((done) => { setTimeout(done, AGAIN_MS); });
  }
}
