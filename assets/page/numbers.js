// Numbers as text, as in the window and in films. They have a true minus sign, and powers of ten have superscripts.

const raised = (text) => text.replace(/[-0-9]/g, (sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]);
const lowered = (text) => text.replace(/[-0-9]/g, (sign) => "₋₀₁₂₃₄₅₆₇₈₉"["-0123456789".indexOf(sign)]);

const numberForm = { mark: "." }; // Decimal mark in the language of the reader.

function fixed(value, decimals) {
  const text = value.toFixed(decimals);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−").replace(".", numberForm.mark);
}

// Return `value` as a number with `digits` decimals times a power of ten. Values from 0.01 to 1000 are written without the power.
function scientific(value, digits = 1) {
  if (value === 0 || !Number.isFinite(value)) return value === 0 ? "0" : "?";
  const size = Math.abs(value);
  if (size >= 0.01 && size < 1000) return fixed(value, Math.max(0, digits - Math.floor(Math.log10(size))));
  const [mantissa, power] = value.toExponential(digits).split("e");
  return `${mantissa.replace("-", "−").replace(".", numberForm.mark)}·10${raised(String(Number(power)))}`;
}

function factorText(value) {
  if (value >= 0.01 && value < 100) return `×${plain(value, 3)}`;
  if (value >= 100 && value < 1e5) return `×${Math.round(value)}`;
  return `×${scientific(value, 0).replace(/^1·/, "")}`;
}

// Return `value` with `digits` significant digits and no trailing zeros. Tiny values are written with a power of ten, as in
// sandbox/story/numbers.py.
const plain = (value, digits) => (value !== 0 && Math.abs(value) < 1e-4 ? scientific(value, digits - 1)
  : String(Number(value.toPrecision(digits))).replace("-", "−").replace(".", numberForm.mark));

// Write a length [m] with a unit that needs few digits: m, cm, mm, µm or nm. Smaller lengths are written with a power of ten.
function lengthText(value, digits) {
  const [size, unit] = [[1, "m"], [1e-2, "cm"], [1e-4, "mm"], [1e-7, "µm"], [1e-10, "nm"]].find(([least]) => value >= least) ?? [0, ""];
  if (!size) return value > 0 ? `${scientific(value, digits - 1)}\u00a0m` : "0";
  const scaled = value / { m: 1, cm: 1e-2, mm: 1e-3, "µm": 1e-6, nm: 1e-9 }[unit];
  return `${plain(scaled, Math.max(digits, Math.floor(Math.log10(scaled)) + 1))}\u00a0${unit}`;
}

// Simple fractions such as 3/4. A sentence that explains a force uses the nearest one.
const FRACTIONS = [[1, 1], [4, 5], [3, 4], [2, 3], [3, 5], [1, 2], [2, 5],
  ...[3, 4, 5, 6, 7, 8, 9, 10, 12, 15, 20, 25, 30, 40, 50].map((under) => [1, under])];
const LEAST_SHARE = 0.01; // Smallest share that is not written as 0.

// Write a share (0 to 1) as the nearest simple fraction.
function shareText(share) {
  if (share < LEAST_SHARE) return "0";
  const off = (one) => Math.abs(Math.log(share * one[1] / one[0]));
  const [over, under] = FRACTIONS.reduce((best, one) => (off(one) < off(best) ? one : best));
  return under === 1 ? String(over) : `${over}/${under}`;
}

// Join words to a list such as "1, 2 and 3" in the language of the reader.
function listed(words) {
  const { lang } = document.documentElement;
  return new Intl.ListFormat(lang === "en" ? "en-GB" : lang).format(words);
}

// Write a small exponent as the nearest unit fraction.
const alphaText = (alpha) => (alpha < 0.7 ? `1/${plain(1 / alpha, 3)}` : plain(alpha, 3));

// Write an energy [J] in J, kJ or MJ.
function joules(value) {
  const [size, unit] = Math.abs(value) >= 1e7 ? [1e6, "MJ"] : Math.abs(value) >= 1e4 ? [1e3, "kJ"] : [1, "J"];
  return `${plain(value / size, 4)} ${unit}`;
}

const contactName = (k) => lowered(k + 1 > 9 ? `${k}-${k + 1}` : `${k}${k + 1}`);

// Return the largest round number that is at most `value`. Round numbers are 1, 2 or 5 times a power of ten.
function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [10, 5, 2, 1, 0.5].map((k) => k * power).find((round) => round <= value * (1 + 1e-9));
}

// Return round values between `low` and `high` with different labels. They divide the range into at most `most` steps. Tiny and huge values
// have powers of ten.
function ticksOf(low, high, most) {
  const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough * (1 - 1e-9)) ?? 10 * power;
  const place = Math.floor(Math.log10(step) + 1e-9), last = Math.floor(high / step + 1e-9), found = [];
  const plainly = place >= -4 && place < 4, digits = (value) => Math.floor(Math.log10(Math.abs(value)) + 1e-9) - place;
  for (let k = Math.ceil(low / step - 1e-9); k <= last; k++) {
    const value = k * step;
    found.push({ value, text: plainly ? fixed(value, Math.max(0, -place)) : scientific(value, digits(value)) });
  }
  return found;
}
