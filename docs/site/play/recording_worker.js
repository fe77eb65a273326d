// The laboratory in a worker of its own: the page stops it by ending it.

let lab = null;

const tell = (fraction, stage) => postMessage({ kind: "progress", fraction, stage });

onmessage = async ({ data: { kind, id, request, bytes } }) => {
  try {
    if (kind === "start") {
      lab = supercircle.loadLab(bytes, tell);
      await lab;
      return;
    }
    postMessage({ kind: "answer", id, answer: (await lab)[kind](request) });
  } catch (error) {
    postMessage({ kind: "answer", id, error: error.message });
  }
};
