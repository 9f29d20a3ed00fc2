// Texts of the page in the language of the reader. The constant WORDS is written by sandbox/story/page_story.py.

let words = WORDS.en, bodyKind = "bead";

// Return the first of the browser's language codes for which the page has texts.
function languageIn(codes) {
  const known = Object.keys(WORDS), short = (code) => String(code).slice(0, 2).toLowerCase();
  return codes.map(short).find((code) => known.includes(code));
}

function useLanguage(code) {
  words = WORDS[code];
  numberForm.mark = code === "en" ? "." : ",";
  document.documentElement.lang = code;
}

// Use the words for a `kind` of bodies. Return true if the kind has changed.
function useBodies(kind) {
  const other = kind !== bodyKind;
  bodyKind = kind;
  return other;
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

// Return a word for the bodies of the page. `name` is "one", "many", "the", "those" or "a". If `name` has a capital, the word has one as
// well.
function bodyWord(name) {
  const found = words[`${bodyKind} ${name.toLowerCase()}`] ?? "";
  return name === name.toLowerCase() ? found : capital(found);
}

/**
 * Return a text in which each name in braces is replaced by its value.
 * @param {string} key @param {Record<string, string|number>} [values]
 */
const say = (key, values = {}) => words[key].replace(/\{(\w+)\}/g, (_, name) => String(values[name] ?? bodyWord(name)));
