// Texts of the page in the language of the reader. WORDS is written by sandbox/story/page_story.py.

let words = WORDS.en, bodyKind = "bead";

// Return the first of several language codes of a browser that the page has texts for.
function languageIn(codes) {
  const known = Object.keys(WORDS), short = (code) => String(code).slice(0, 2).toLowerCase();
  return codes.map(short).find((code) => known.includes(code));
}

function useLanguage(code) {
  words = WORDS[code];
  numberForm.mark = code === "en" ? "." : ",";
  document.documentElement.lang = code;
}

// Use the words of a `kind` for the bodies. Return true if this is a change.
function useBodies(kind) {
  const other = kind !== bodyKind;
  bodyKind = kind;
  return other;
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

// Return a word for the bodies of the page: "one", "many", "the", "those" or "a"; with a capital if `name` has one.
function bodyWord(name) {
  const found = words[`${bodyKind} ${name.toLowerCase()}`] ?? "";
  return name === name.toLowerCase() ? found : capital(found);
}

/** Return a text with its {names} filled in. @param {string} key @param {Record<string, string|number>} [values] */
const say = (key, values = {}) => words[key].replace(/\{(\w+)\}/g, (_, name) => String(values[name] ?? bodyWord(name)));
