// How the site's search orders what it finds: pages that answer a task before pages that look
// something up, and these before pages about the project's own inside.
"use strict";
const WEIGHTS = [
  [/^(tutorials|how-to)\//, 10],
  [/^(install|which-function|faq|viewer|streams|clusters)$/, 9],
  [/^coming-from\//, 8],
  [/^formats$/, 7],
  [/^(changelog|hacking|building|contributing|dependencies|security|readme|exactness|algorithm|decisions.*)$/, -8],
];

var Scorer = {
  score: ([page, title, anchor, description, score]) =>
    WEIGHTS.reduce((sum, [pages, weight]) => sum + (pages.test(page) ? weight : 0), score),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
