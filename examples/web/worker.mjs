// Runs conic beside the page, so that this goes on answering: a message is {bytes, words, files, wanted}.
import { MemoryDisk, run } from './wasi.mjs';

onmessage = async ({ data: { bytes, words, files, wanted } }) => {
  const disk = new MemoryDisk(files), decoder = new TextDecoder();
  let told = '';
  try {
    const code = await run(await WebAssembly.compile(bytes), ['conic', ...words], disk, (stream, text) => {
      told += decoder.decode(text, { stream: true });
    });
    postMessage({ code, told, written: wanted && disk.bytesOf(wanted) });
  } catch (error) {
    postMessage({ code: 4, told: `${told}${error}` });
  }
};
