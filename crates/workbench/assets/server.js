// The server: its state, its events, what is asked of it.
async function answer(response) {
  const json = await response.json().catch(() => ({}));
  if (!response.ok) throw new Error(json.error ?? `the server answered ${response.status}`);
  return json;
}

export const state = async () => answer(await fetch("/api/state"));
export const overlay = async step => answer(await fetch(`/api/overlay/${step}`));
export const ask = async action => answer(await fetch("/api/do", { method: "POST", body: JSON.stringify(action) }));
export const upload = async file =>
  (await answer(await fetch(`/api/upload?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file }))).file;
export const link = path => `/files/${path.split("/").map(encodeURIComponent).join("/")}`;

// Listens; `lost` is told whether the server is away.
export function listen(hear, lost) {
  const source = new EventSource("/api/events");
  for (const event of ["begun", "ended", "failed", "state", "note", "iterate"]) {
    source.addEventListener(event, message => hear(event, JSON.parse(message.data)));
  }
  source.addEventListener("open", () => lost(false));
  source.addEventListener("error", () => lost(true));
}
