// A .zip of files as they are (stored, APPNOTE 6.3.9, sections 4.3.7, 4.3.12 and 4.3.16).
"use strict";

const CRC = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});

function crc32(bytes) {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = CRC[(crc ^ byte) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

function fields(...values) {
  const bytes = [];
  for (const [size, value] of values) for (let i = 0; i < size; ++i) bytes.push((value / 2 ** (8 * i)) & 255);
  return new Uint8Array(bytes);
}

/** files: [{name, bytes}]; a Blob. */
function zipped(files) {
  const parts = [], central = [];
  const UTF8 = 0x800, DATE = 0x21; // 1980-01-01: the same files give the same archive
  let offset = 0, size = 0;
  for (const { name, bytes } of files) {
    const path = new TextEncoder().encode(name), crc = crc32(bytes);
    const about = [[2, 20], [2, UTF8], [2, 0], [2, 0], [2, DATE], [4, crc], [4, bytes.length], [4, bytes.length], [2, path.length], [2, 0]];
    parts.push(fields([4, 0x04034b50], ...about), path, bytes);
    const entry = fields([4, 0x02014b50], [2, 20], ...about, [2, 0], [2, 0], [2, 0], [4, 0], [4, offset]);
    central.push(entry, path);
    offset += 30 + path.length + bytes.length;
    size += entry.length + path.length;
  }
  const end = fields([4, 0x06054b50], [2, 0], [2, 0], [2, files.length], [2, files.length], [4, size], [4, offset], [2, 0]);
  return new Blob([...parts, ...central, end], { type: "application/zip" });
}
