// Scripts of pages are joined in the order of sandbox/page/document.py and share their names.
import js from "@eslint/js";
import globals from "globals";
import { readFileSync, readdirSync } from "node:fs";

const folder = new URL("assets/page/", import.meta.url);
const files = readdirSync(folder).filter((name) => name.endsWith(".js"));
// Constants that sandbox/story/page_story.py puts before the scripts.
const STORY = { STORY: "readonly", WORDS: "readonly" };
// Names that a script gives to the others: of classes and functions, and of constants, several of which may stand in a line.
const declared = (name) => readFileSync(new URL(name, folder), "utf8").split("\n").flatMap((line) => {
  const first = line.match(/^(?:async )?(class|function|const|let) (\w+)/);
  if (!first) return [];
  const more = first[1] === "const" ? [...line.matchAll(/, ([A-Z_]+) = /g)].map((found) => found[1]) : [];
  return [first[2], ...more].map((shared) => [shared, first[1] === "let" ? "writable" : "readonly"]);
});
const others = (name) => Object.fromEntries(files.filter((file) => file !== name).flatMap(declared));

export default files.map((name) => ({
  files: [`assets/page/${name}`],
  languageOptions: { ecmaVersion: 2023, sourceType: "script", globals: { ...globals.browser, ...STORY, ...others(name) } },
  rules: {
    ...js.configs.recommended.rules,
    "no-unused-vars": ["error", { vars: "local", argsIgnorePattern: "^_" }],
    "no-redeclare": ["error", { builtinGlobals: false }],
    "no-eval": "error", "no-implied-eval": "error", "no-new-func": "error", "no-script-url": "error",
    "no-restricted-properties": ["error", { property: "innerHTML" }, { property: "outerHTML" }, { property: "insertAdjacentHTML" }],
    eqeqeq: "error", "prefer-const": "error", "no-var": "error", "max-len": ["error", { code: 150, ignoreStrings: true }],
  },
}));
