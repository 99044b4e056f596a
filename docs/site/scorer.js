// How the site's search orders what it finds: pages that answer a task before pages that look
// something up, and these before pages about the project's own inside.
"use strict";
const FOR_READERS = /^(install|which-function|faq|viewer|streams|clusters|formats|(tutorials|how-to|coming-from)\/.*)$/;
const FOR_DEVELOPERS = /^(changelog|hacking|building|contributing|dependencies|security|readme|exactness|algorithm|decisions.*)$/;

var Scorer = {
  score: ([page, title, anchor, description, score]) =>
    score + (FOR_READERS.test(page) ? 8 : 0) - (FOR_DEVELOPERS.test(page) ? 8 : 0),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
