// QR codes (ISO/IEC 18004) of texts. They use the byte mode, the error correction level M, and the versions 1 to 20.

// Two numbers for each version from 1 to 20 (table 9 of the standard): the error correction codewords of a block, and the blocks.
const QR_CHECKS = [10, 16, 26, 18, 24, 16, 18, 22, 22, 26, 30, 22, 22, 24, 24, 28, 28, 26, 26, 26];
const QR_BLOCKS = [1, 1, 1, 2, 2, 4, 4, 4, 5, 5, 5, 8, 9, 9, 10, 10, 11, 13, 14, 16];
const QR_MASKS = [(x, y) => (x + y) % 2, (_, y) => y % 2, (x) => x % 3, (x, y) => (x + y) % 3, (x, y) => (Math.floor(x / 3) + Math.floor(y / 2)) % 2,
  (x, y) => x * y % 2 + x * y % 3, (x, y) => (x * y % 2 + x * y % 3) % 2, (x, y) => ((x + y) % 2 + x * y % 3) % 2];

// Return the total number of codewords of a version, for data and for error correction.
function qrCapacity(version) {
  const aligned = version > 1 ? Math.floor(version / 7) + 2 : 0;
  const bits = (16 * version + 128) * version + 64 - (aligned ? (25 * aligned - 10) * aligned - 55 : 0) - (version > 6 ? 36 : 0);
  return bits >> 3;
}

// Return the product of two elements of GF(256) with the polynomial 0x11d.
function qrProduct(x, y) {
  let z = 0;
  for (let k = 7; k >= 0; k--) z = (z << 1) ^ ((z >> 7) * 0x11d) ^ ((y >> k & 1) * x);
  return z;
}

// Return the error correction codewords of a block. They are the remainder of its division by the generator polynomial.
function qrChecks(data, count) {
  const generator = Array(count).fill(0);
  generator[count - 1] = 1;
  for (let k = 0, root = 1; k < count; k++, root = qrProduct(root, 2)) {
    for (let j = 0; j < count; j++) generator[j] = qrProduct(generator[j], root) ^ (generator[j + 1] ?? 0);
  }
  const rest = Array(count).fill(0);
  for (const byte of data) {
    const factor = byte ^ rest.shift();
    rest.push(0);
    generator.forEach((one, k) => { rest[k] ^= qrProduct(one, factor); });
  }
  return rest;
}

// Return all codewords of a text. The blocks of data are interleaved, followed by the interleaved blocks of error correction.
function qrCodewords(bytes, version) {
  const blocks = QR_BLOCKS[version - 1], checks = QR_CHECKS[version - 1], whole = qrCapacity(version), room = whole - blocks * checks;
  let bits = `0100${bytes.length.toString(2).padStart(version < 10 ? 8 : 16, "0")}`;
  for (const byte of bytes) bits += byte.toString(2).padStart(8, "0");
  bits += "0".repeat(Math.min(4, 8 * room - bits.length));
  bits += "0".repeat(-bits.length & 7);
  const data = bits.match(/.{8}/g).map((one) => parseInt(one, 2));
  for (let k = 0; data.length < room; k++) data.push(k % 2 ? 0x11 : 0xec);
  // The last blocks contain one more codeword than the others.
  const least = Math.floor(room / blocks), short = blocks - room % blocks;
  const begin = (k) => k * least + Math.max(0, k - short), parts = Array.from({ length: blocks }, (_, k) => data.slice(begin(k), begin(k + 1)));
  const mixed = (lists) => lists.at(-1).flatMap((_, k) => lists.flatMap((list) => list[k] ?? []));
  return [...mixed(parts), ...mixed(parts.map((part) => qrChecks(part, checks)))];
}

// Return a code word of `bits` information bits, followed by its remainder for a generator polynomial.
function qrCoded(word, length, generator) {
  let rest = word;
  for (let k = 0; k < length; k++) rest = (rest << 1) ^ ((rest >> (length - 1)) * generator);
  return word << length | rest & ((1 << length) - 1);
}

// Return the positions of the alignment patterns of a version.
function qrAligned(version) {
  if (version === 1) return [];
  const count = Math.floor(version / 7) + 2, step = Math.ceil((version * 4 + 4) / (count * 2 - 2)) * 2, last = 4 * version + 10;
  return [6, ...Array.from({ length: count - 1 }, (_, k) => last - (count - 2 - k) * step)];
}

// Draw the patterns of a version that do not depend on the text. The other modules remain undefined.
function qrFrame(version, mask) {
  const size = 4 * version + 17, cells = Array.from({ length: size }, () => Array(size));
  const set = (x, y, dark) => { if (Math.min(x, y) >= 0 && Math.max(x, y) < size) cells[y][x] = dark ? 1 : 0; };
  for (let k = 0; k < size; k++) { set(6, k, k % 2 === 0); set(k, 6, k % 2 === 0); }
  const ring = (x, y, reach, light) => {
    for (let j = -reach; j <= reach; j++) {
      for (let i = -reach; i <= reach; i++) set(x + i, y + j, !light.includes(Math.max(Math.abs(i), Math.abs(j))));
    }
  };
  for (const [x, y] of [[3, 3], [size - 4, 3], [3, size - 4]]) ring(x, y, 4, [2, 4]);
  const places = qrAligned(version), last = places.at(-1);
  for (const x of places) for (const y of places) if (!((x === 6 && (y === 6 || y === last)) || (x === last && y === 6))) ring(x, y, 2, [1]);
  const format = qrCoded(mask, 10, 0x537) ^ 0x5412, bit = (word, k) => word >> k & 1; // The error correction level M has the code 0.
  for (let k = 0; k < 15; k++) {
    set(8, k < 6 ? k : k < 8 ? k + 1 : size - 15 + k, bit(format, k));
    set(k < 8 ? size - 1 - k : k < 9 ? 15 - k : 14 - k, 8, bit(format, k));
  }
  set(8, size - 8, 1);
  if (version > 6) {
    const word = qrCoded(version, 12, 0x1f25);
    for (let k = 0; k < 18; k++) { const a = size - 11 + k % 3, b = Math.floor(k / 3); set(a, b, bit(word, k)); set(b, a, bit(word, k)); }
  }
  return cells;
}

// Return the penalty of a QR code. Penalties are given for long runs, for patterns that resemble finder patterns, for blocks of 2 by 2
// modules, and for unequal shares of dark and light.
function qrPenalty(cells) {
  const lines = [...cells, ...cells.map((_, x) => cells.map((row) => row[x]))].map((row) => row.join(""));
  let sum = 0;
  for (const line of lines) {
    for (const run of line.match(/0{5,}|1{5,}/g) ?? []) sum += run.length - 2;
    sum += 40 * (line.match(/(?=10111010000|00001011101)/g) ?? []).length;
  }
  cells.slice(1).forEach((row, y) => row.slice(1).forEach((one, x) => {
    if (one === cells[y][x] && one === cells[y][x + 1] && one === row[x]) sum += 3;
  }));
  const dark = cells.flat().reduce((total, one) => total + one, 0) / cells.length ** 2;
  return sum + 10 * Math.floor(20 * Math.abs(dark - 0.5));
}

/**
 * Return the modules of the QR code of a text as rows of 1 (dark) and 0. Return null if the text is too long. The mask with the lowest
 * penalty is used, unless `masks` are given.
 * @param {string} text @param {number[]} [masks] @returns {number[][]|null}
 */
function qrCode(text, masks = [0, 1, 2, 3, 4, 5, 6, 7]) {
  const bytes = [...new TextEncoder().encode(text)];
  const fits = (_, k) => bytes.length + (k < 9 ? 2 : 3) <= qrCapacity(k + 1) - QR_BLOCKS[k] * QR_CHECKS[k];
  const version = QR_BLOCKS.findIndex(fits) + 1;
  if (!version) return null;
  const words = qrCodewords(bytes, version);
  const found = masks.map((mask) => {
    const cells = qrFrame(version, mask), size = cells.length;
    let k = 0;
    // Visit pairs of columns from the right. Column 6 contains a pattern and is skipped.
    for (let right = size - 1; right > 0; right -= right === 8 ? 3 : 2) {
      const up = (right + (right < 6 ? 1 : 0)) % 4 === (size - 1) % 4;
      for (let j = 0; j < size; j++) {
        for (const x of [right, right - 1]) {
          const y = up ? size - 1 - j : j;
          if (cells[y][x] !== undefined) continue;
          cells[y][x] = (words[k >> 3] >> (7 - k % 8) & 1) ^ (QR_MASKS[mask](x, y) === 0 ? 1 : 0);
          k += 1;
        }
      }
    }
    return cells;
  });
  return found.reduce((best, one) => (qrPenalty(one) < qrPenalty(best) ? one : best));
}
