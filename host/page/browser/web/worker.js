// The designer in a worker: one request after the other.

let begun = null;
let designer = null;
/** The number of the request that is worked on. */
let asked = 0;

onmessage = async ({ data }) => {
  if (data.module) {
    begun = WebAssembly.instantiate(data.module, { page: { hear } });
    return;
  }
  const { number, request, body } = data;
  designer = (await begun).exports;
  asked = number;
  try {
    const status = answer(new TextEncoder().encode(JSON.stringify({ request, body })));
    const bytes = read(designer.answer_at(), designer.answer_length());
    postMessage({ number, status, bytes }, [bytes]);
  } catch (error) {
    const failure = new TextDecoder().decode(read(designer.failure_at(), designer.failure_length()));
    postMessage({ number, failure: failure || error.message });
  }
};

/** Tells the page how far a study is. */
function hear(place, length) {
  postMessage({ number: asked, at: JSON.parse(new TextDecoder().decode(read(place, length))) });
}

/** Hands a request over, and gives the status of its answer. */
function answer(bytes) {
  const place = designer.room(bytes.length);
  new Uint8Array(designer.memory.buffer, place, bytes.length).set(bytes);
  return designer.answer();
}

/** A copy of bytes in the memory of the module, which may move when it grows. */
function read(place, length) {
  return designer.memory.buffer.slice(place, place + length);
}
