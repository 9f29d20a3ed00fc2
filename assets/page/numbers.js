// Numbers as text, as in the window and in films: a true minus sign, powers of ten with superscripts.

const raised = (text) => text.replace(/[-0-9]/g, (sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]);
const lowered = (text) => text.replace(/[-0-9]/g, (sign) => "₋₀₁₂₃₄₅₆₇₈₉"["-0123456789".indexOf(sign)]);

const numberForm = { mark: "." }; // Decimal mark of the reader's language.

function fixed(value, decimals) {
  const text = value.toFixed(decimals);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "−").replace(".", numberForm.mark);
}

// Return `value` with `digits` decimals times a power of ten; between 0.01 and 1000 without the power.
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

// Return `value` with that many significant digits and no trailing zeros. Tiny values get a power of ten, as in sandbox/story/numbers.py.
const plain = (value, digits) => (value !== 0 && Math.abs(value) < 1e-4 ? scientific(value, digits - 1)
  : String(Number(value.toPrecision(digits))).replace("-", "−").replace(".", numberForm.mark));

// Write a small exponent as the nearest unit fraction.
const alphaText = (alpha) => (alpha < 0.7 ? `1/${plain(1 / alpha, 3)}` : plain(alpha, 3));

// Write an energy [J] in J, kJ or MJ.
function joules(value) {
  const [size, unit] = Math.abs(value) >= 1e7 ? [1e6, "MJ"] : Math.abs(value) >= 1e4 ? [1e3, "kJ"] : [1, "J"];
  return `${plain(value / size, 4)} ${unit}`;
}

const contactName = (k) => lowered(k + 1 > 9 ? `${k}-${k + 1}` : `${k}${k + 1}`);

// Return the largest of 1, 2, 5 times a power of ten that is at most `value`.
function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [10, 5, 2, 1, 0.5].map((k) => k * power).find((round) => round <= value * (1 + 1e-9));
}

// Return round values between `low` and `high`, in at most `most` steps, with distinct labels. Tiny and huge values get powers of ten.
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
