// The bounds of the story of a motion, written by `make story` from sandbox/story/. Do not edit.

const STORY = {
  together: 0.1,
  resolution: 0.01,
  slow: 0.1,
  momentum: 0.1,
  energy: 0.01,
  stands: 1e-06,
  equal: 1e-06,
  atRest: 1e-09,
  groups: 6,
  digits: 2,
};
