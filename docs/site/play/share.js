// Links that carry what plays: a named scene, or the whole text, with its parameters.

const LONGEST = 8000; // characters; some programs cut longer links

const base64 = (bytes) => btoa(String.fromCharCode(...bytes)).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
const unbase64 = (text) => text.replaceAll("-", "+").replaceAll("_", "/");

/** The part of the link after "#"; null: too long. */
async function linkOf({ name, text, parameters }) {
  const numbers = new URLSearchParams(Object.entries(parameters).map(([k, v]) => [k, String(v)])).toString();
  if (name)
    return `s=${name}${numbers ? `&${numbers}` : ""}`;
  const packed = `z=${base64(await deflate(JSON.stringify({ text, parameters })))}`;
  return packed.length <= LONGEST ? packed : null;
}

/** What a link asks for: {name, parameters}, {text, parameters}, or null. */
async function readLink(hash) {
  const query = new URLSearchParams(hash.replace(/^#/, ""));
  if (query.has("z")) {
    const { text, parameters } = JSON.parse(new TextDecoder().decode(await inflate(unbase64(query.get("z")))));
    return typeof text === "string" ? { text, parameters: parameters ?? {} } : null;
  }
  if (!query.has("s"))
    return null;
  const parameters = {};
  for (const [key, value] of query)
    if (key !== "s" && value.trim() !== "" && Number.isFinite(Number(value)))
      parameters[key] = Number(value);
  return { name: query.get("s"), parameters };
}
